"""A tour without hardware: fly a simulated copter, look at the log of the flight, and see how fast
logs are read.

    python examples/demo.py [LOG] [--record TLOG] [--messages N]

With LOG only that log is read. Where pymavlink is installed it reads the same log in a process of
its own, and the two speeds are put side by side.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

COMPARE_UP_TO = 3_000_000  # bytes of a log that pymavlink reads within a few seconds
SPEED = 4
# Ends the vehicle even where this program is killed.
VEHICLE_LIFETIME = "5m"


# -- the flight


@contextmanager
def simulated_vehicle(port: int, folder: Path) -> Iterator[None]:
    """`mavwire sim` in a process of its own, as a user would start it."""
    # A busy machine may take long between arming and taking off: it must not disarm meanwhile.
    options = [
        *("--out", f"udpout:127.0.0.1:{port}", "--speed", str(SPEED)),
        *("--param", "DISARM_DELAY=127", "--duration", VEHICLE_LIFETIME, "--quiet"),
    ]
    print(f"$ mavwire sim {' '.join(options)}\n", flush=True)
    said = folder / "vehicle.txt"
    with said.open("w") as file:
        command = [sys.executable, "-m", "mavwire", "sim", *options]
        vehicle = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=file)
        try:
            yield
        except TimeoutError as error:
            error.add_note(f"the vehicle said: {said.read_text().strip()}")
            raise
        finally:
            vehicle.kill()
            vehicle.wait()


def fly(record: Path, folder: Path) -> None:
    """Fly it, and keep what it sends in `record`."""
    from fly import View
    from fly import fly as session
    from mavwire import mavutil

    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link:
        link.setup_logfile(str(record))
        port = link.port.getsockname()[1]
        print(f"A simulated copter, {SPEED} times as fast as real time:")
        with simulated_vehicle(port, folder):
            session(link, View())


# -- the logs


def read(package: str, path: Path) -> tuple[int, float]:
    """Read a log with a plain loop, as a script would; messages and seconds, opening included."""
    import time

    mavutil = importlib.import_module(f"{package}.mavutil")
    began = time.perf_counter()
    log = mavutil.mavlink_connection(str(path))
    count = 0
    while log.recv_match() is not None:
        count += 1
    return count, time.perf_counter() - began


def read_apart(package: str, path: Path) -> tuple[int, float]:
    """The same in a fresh process."""
    command = [sys.executable, __file__, str(path), "--read-with", package]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    count, seconds = json.loads(done.stdout)
    return count, seconds


def compare(path: Path, folder: Path) -> None:
    """Print the speed of both packages; a long log is cut for pymavlink, into `folder`."""
    count, seconds = read_apart("mavwire", path)
    ours = count / seconds
    print(f"\nmavwire    {count:,} messages through recv_match() in {seconds:.3f} s: {ours:,.0f}/s")
    if importlib.util.find_spec("pymavlink") is None:
        print("pymavlink  is not installed here, so there is nothing to compare with")
        return
    if path.stat().st_size > COMPARE_UP_TO:
        part = folder / "part.tlog"
        with path.open("rb") as file:
            part.write_bytes(file.read(COMPARE_UP_TO))
        path = part
    count, seconds = read_apart("pymavlink", path)
    theirs = count / seconds
    print(f"pymavlink  {count:,} messages through recv_match() in {seconds:.3f} s: {theirs:,.0f}/s")
    print(f"mavwire reads {ours / theirs:,.0f} times as fast")


def show(path: Path) -> int:
    """Say what is in a log, as `mavwire info` does."""
    from mavwire import cli

    print(f"\n$ mavwire info {path}\n", flush=True)
    return cli.main(["info", "--", str(path)])


def tour(record: Path | None, messages: int, folder: Path) -> int:
    """Everything, one after the other."""
    from mavwire import traffic

    flight = record or folder / "flight.tlog"
    flight.parent.mkdir(parents=True, exist_ok=True)
    fly(flight, folder)
    status = show(flight)
    long = folder / "traffic.tlog"
    print(f"\nHow fast? A longer log, {messages:,} messages of a copter's telemetry:")
    traffic.generate(long, messages, seed=1, loss=0.002, corruption=0.001)
    compare(long, folder)
    return status


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("log", nargs="?", type=Path, help="read this log instead of flying")
    parser.add_argument("--record", type=Path, metavar="TLOG", help="keep the log of the flight")
    parser.add_argument("--messages", type=int, default=200_000, help="length of the longer log")
    parser.add_argument("--read-with", metavar="PACKAGE", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.read_with:
        print(json.dumps(read(args.read_with, args.log)))
        return 0
    with tempfile.TemporaryDirectory(prefix="mavwire-demo-") as name:
        folder = Path(name)
        if args.log is None:
            return tour(args.record, args.messages, folder)
        status = show(args.log)
        if status == 0:
            compare(args.log, folder)
        return status


if __name__ == "__main__":
    try:
        raise SystemExit(main())
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    except BrokenPipeError:  # the reader (head, less) has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
