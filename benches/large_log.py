"""`make bench-large`: what a message of a long log costs, and the memory that reading it takes.

Logs of the size asked for, a tenth and a hundredth of it are written into a temporary folder: one
flight of `mavwire.traffic`, over and over. Each is read in processes of their own, in CPU time,
through `recv_msg()` of what `mavlink_connection` opens (which indexes the log first) and through
`open_log`. A reader that does not see every message makes the run fail.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import mavwire
from mavwire import mavutil, traffic

# How often the flight is repeated in each log.
FLIGHTS = (1, 10, 100)
# Messages that tell how long a record is on average.
SAMPLE = 10_000
HEADINGS = (
    "log", "messages", "open and index, us/message", "recv_msg(), us/message", "peak MiB",
    "open_log(), us/message", "peak MiB",
)  # fmt: skip


def read_link(path: str) -> dict[str, Any]:
    """Every message by `recv_msg()`."""
    start = process_time()
    log: Any = mavutil.mavlink_connection(path)
    opened = process_time()
    messages = 0
    while log.recv_msg() is not None:
        messages += 1
    done = process_time()
    return {"messages": messages, "open": opened - start, "read": done - opened}


def read_open_log(path: str) -> dict[str, Any]:
    """Every message by `open_log`."""
    start = process_time()
    messages = sum(1 for _ in mavwire.open_log(path))
    return {"messages": messages, "read": process_time() - start}


READERS = {"recv_msg": read_link, "open_log": read_open_log}


def peak_rss() -> int:
    """Bytes of memory that this process held at most."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage counts what the parent held when it started this process
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return int(line.split()[1]) * 1024
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def measure(reader: str, log: Path, messages: int, runs: int) -> dict[str, float]:
    """Medians over processes, in microseconds a message and MiB."""
    answers = []
    for _ in range(runs):
        command = [sys.executable, __file__, "--read", reader, str(log)]
        output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
        answers.append(json.loads(output))
        if answers[-1]["messages"] != messages:
            raise SystemExit(f"{reader} saw {answers[-1]['messages']} of {messages} messages")
    seconds = {
        name: median(answer.get(name, 0.0) for answer in answers) for name in ("open", "read")
    }
    per_message = {name: value / messages * 1e6 for name, value in seconds.items()}
    return per_message | {"rss": median(answer["rss"] for answer in answers) / 2**20}


def row(log: Path, messages: int, runs: int) -> list[str]:
    """What reading the log costs."""
    link, plain = (measure(reader, log, messages, runs) for reader in READERS)
    return [
        f"{log.stat().st_size / 1e6:,.1f} MB", f"{messages:,}", f"{link['open']:.3f}",
        f"{link['read']:.3f}", f"{link['rss']:.0f}", f"{plain['read']:.3f}", f"{plain['rss']:.0f}",
    ]  # fmt: skip


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bytes", type=float, default=1e9, help="of the longest log (1e9)")
    parser.add_argument("--runs", type=int, default=3, help="processes for each figure (3)")
    parser.add_argument("--read", nargs=2, metavar=("READER", "LOG"), help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.read:
        reader, log = args.read
        print(json.dumps(READERS[reader](log) | {"rss": peak_rss()}))
        return
    print(f"| {' | '.join(HEADINGS)} |\n|{' --- |' * len(HEADINGS)}")
    with TemporaryDirectory() as name:
        flight, log = Path(name) / "flight.tlog", Path(name) / "log.tlog"
        record = traffic.generate(flight, SAMPLE).bytes / SAMPLE
        written = traffic.generate(flight, max(int(args.bytes / FLIGHTS[-1] / record), 1))
        content = flight.read_bytes()
        for flights in FLIGHTS:
            with log.open("wb") as file:
                file.writelines(content for _ in range(flights))
            cells = row(log, flights * written.messages, args.runs)
            print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
