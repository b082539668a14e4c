"""`make bench-large`: what a message of a long log costs, and the memory that reading it takes.

Logs of the size asked for, a tenth and a hundredth of it are written into a temporary folder: one
flight of `mavwire.traffic`, over and over. Each is read in processes of their own, in CPU time,
through `recv_msg()` of what `mavlink_connection` opens (which indexes the log first) and through
`open_log`; then telemetry logs and dataflash logs are converted to Parquet. A reader that does not
see every message makes the run fail.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
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

CONVERTED = (
    "log", "messages", "to Parquet, us/message", "wall time, us/message", "bytes/message",
    "peak MiB",
)  # fmt: skip
"""Headings of the second table."""


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


def to_parquet(path: str) -> dict[str, Any]:
    """A file of zstd Parquet for each type."""
    from mavwire.logs.conversion import convert

    with TemporaryDirectory() as folder:
        start, began = process_time(), perf_counter()
        (row,) = convert([path], folder)
        wall, spent = perf_counter() - began, process_time() - start
        size = sum(file.stat().st_size for file in Path(folder).rglob("*.parquet"))
    return {"messages": row.rows, "read": spent, "wall": wall, "bytes": size}


READERS = {"recv_msg": read_link, "open_log": read_open_log, "parquet": to_parquet}


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
        name: median(answer.get(name, 0.0) for answer in answers)
        for name in ("open", "read", "wall")
    }
    per_message = {name: value / messages * 1e6 for name, value in seconds.items()}
    size = median(answer.get("bytes", 0) for answer in answers)
    rss = median(answer["rss"] for answer in answers) / 2**20
    return per_message | {"bytes": size / messages, "rss": rss}


def row(log: Path, messages: int, runs: int) -> list[str]:
    """What reading the log costs."""
    link, plain = (measure(reader, log, messages, runs) for reader in ("recv_msg", "open_log"))
    return [
        f"{log.stat().st_size / 1e6:,.1f} MB", f"{messages:,}", f"{link['open']:.3f}",
        f"{link['read']:.3f}", f"{link['rss']:.0f}", f"{plain['read']:.3f}", f"{plain['rss']:.0f}",
    ]  # fmt: skip


def converted_row(log: Path, messages: int, runs: int) -> list[str]:
    """What converting the log costs."""
    cost = measure("parquet", log, messages, runs)
    return [
        f"{log.stat().st_size / 1e6:,.1f} MB {log.suffix}", f"{messages:,}", f"{cost['read']:.3f}",
        f"{cost['wall']:.3f}", f"{cost['bytes']:.1f}", f"{cost['rss']:.0f}",
    ]  # fmt: skip


def flights_of(folder: Path, size: float) -> dict[str, tuple[Path, int]]:
    """A flight of so many bytes of each kind of log, and how many records it has."""
    sys.path.append(str(Path(__file__).parent / "python"))
    import dataflash_log

    telemetry, dataflash = folder / "flight.tlog", folder / "flight.BIN"
    record = traffic.generate(telemetry, SAMPLE).bytes / SAMPLE
    written = traffic.generate(telemetry, max(int(size / record), 1))
    dataflash_log.write(dataflash, SAMPLE)
    records = max(int(size / (dataflash.stat().st_size / SAMPLE)), 1)
    dataflash_log.write(dataflash, records)
    described = len(dataflash_log.TYPES) + 1
    return {".tlog": (telemetry, written.messages), ".BIN": (dataflash, records + described)}


def repeat(flight: Path, flights: int, log: Path) -> None:
    """Write a flight over and over."""
    content = flight.read_bytes()
    with log.open("wb") as file:
        file.writelines(content for _ in range(flights))


def main() -> None:
    """Print two tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bytes", type=float, default=1e9, help="of the longest log (1e9)")
    parser.add_argument("--runs", type=int, default=3, help="processes for each figure (3)")
    parser.add_argument("--only-convert", action="store_true", help="only the conversions")
    parser.add_argument("--read", nargs=2, metavar=("READER", "LOG"), help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.read:
        reader, log = args.read
        print(json.dumps(READERS[reader](log) | {"rss": peak_rss()}))
        return
    with TemporaryDirectory() as name:
        folder = Path(name)
        flights = flights_of(folder, args.bytes / FLIGHTS[-1])
        tables = [(HEADINGS, row, (".tlog",)), (CONVERTED, converted_row, (".tlog", ".BIN"))]
        for headings, make_row, suffixes in tables[args.only_convert :]:
            print(f"| {' | '.join(headings)} |\n|{' --- |' * len(headings)}")
            for suffix in suffixes:
                flight, messages = flights[suffix]
                log = folder / f"log{suffix}"
                for times in FLIGHTS:
                    repeat(flight, times, log)
                    cells = make_row(log, times * messages, args.runs)
                    print(f"| {' | '.join(cells)} |", flush=True)
                log.unlink()
            print()


if __name__ == "__main__":
    main()
