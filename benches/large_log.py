"""`make bench-large`: what a message of a long log costs, and the memory that reading it takes.

Logs of the size asked for, a tenth and a hundredth of it are written by `mavwire.traffic` into a
temporary folder. Each is read in a process of its own, in CPU time, through `recv_msg()` of what
`mavlink_connection` opens (which indexes the log first) and through `open_log`. A reader that does
not see every message makes the run fail.
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

# What share of the bytes asked for each log has.
SHARES = (0.01, 0.1, 1)
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


def measure(reader: str, log: Path, written: traffic.Written, runs: int) -> dict[str, float]:
    """Medians over processes, in microseconds a message and MiB."""
    answers = []
    for _ in range(runs):
        command = [sys.executable, __file__, "--read", reader, str(log)]
        output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
        answers.append(json.loads(output))
    for answer in answers:
        if answer["messages"] != written.messages:
            raise SystemExit(f"{reader} saw {answer['messages']} of {written.messages} messages")
    seconds = {
        name: median(answer.get(name, 0.0) for answer in answers) for name in ("open", "read")
    }
    per_message = {name: value / written.messages * 1e6 for name, value in seconds.items()}
    return per_message | {"rss": median(answer["rss"] for answer in answers) / 2**20}


def row(folder: Path, size: float, record: float, runs: int) -> list[str]:
    """Writes a log of about `size` bytes and reads it."""
    log = folder / "log.tlog"
    written = traffic.generate(log, max(int(size / record), 1))
    link, plain = (measure(reader, log, written, runs) for reader in READERS)
    return [
        f"{written.bytes / 1e6:,.1f} MB", f"{written.messages:,}", f"{link['open']:.3f}",
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
        folder = Path(name)
        record = traffic.generate(folder / "sample.tlog", SAMPLE).bytes / SAMPLE
        for share in SHARES:
            print(
                f"| {' | '.join(row(folder, args.bytes * share, record, args.runs))} |", flush=True
            )


if __name__ == "__main__":
    main()
