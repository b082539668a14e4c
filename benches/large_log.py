"""`make bench-large`: what a message of a long log costs, and the memory that reading it takes.

Logs of the size asked for, a tenth and a hundredth of it are written into a temporary folder: one
flight of `mavwire.traffic`, over and over. Each is read in processes of their own, in CPU time,
through `recv_msg()` of what `mavlink_connection` opens (which indexes the log first) and through
`open_log`; then telemetry logs and dataflash logs are converted to Parquet, or to what `--format`
says. With `--every-type` only telemetry logs of all types there are, with random values and times
that go on. A reader that does not see every message makes the run fail.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Callable
from functools import partial
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
    "log", "messages", "CPU time, us/message", "wall time, us/message", "bytes/message", "peak MiB",
)  # fmt: skip
"""Headings of the second table."""
DOCUMENT = Path(__file__).parents[1] / "docs" / "benchmarks.md"


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


def converted(path: str, form: str = "parquet") -> dict[str, Any]:
    """The cost and the output of `mavwire convert`: of Parquet a file for each type."""
    from mavwire.logs.conversion import convert
    from mavwire.logs.formats import FORMATS

    with TemporaryDirectory() as folder:
        start, began = process_time(), perf_counter()
        (row,) = convert([path], folder, format=form)
        wall, spent = perf_counter() - began, process_time() - start
        size = sum(file.stat().st_size for file in Path(folder).rglob(f"*{FORMATS[form]}"))
    return {"messages": row.rows, "read": spent, "wall": wall, "bytes": size}


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
        name: median(answer.get(name, 0.0) for answer in answers)
        for name in ("open", "read", "wall")
    }
    per_message = {name: value / messages * 1e6 for name, value in seconds.items()}
    size = median(answer.get("bytes", 0) for answer in answers)
    rss = median(answer["rss"] for answer in answers) / 2**20
    return per_message | {"bytes": size / messages, "rss": rss}


def row(log: Path, messages: int, runs: int) -> list[str]:
    """The cost of reading the log."""
    link, plain = (measure(reader, log, messages, runs) for reader in ("recv_msg", "open_log"))
    return [
        f"{log.stat().st_size / 1e6:,.1f} MB", f"{messages:,}", f"{link['open']:.3f}",
        f"{link['read']:.3f}", f"{link['rss']:.0f}", f"{plain['read']:.3f}", f"{plain['rss']:.0f}",
    ]  # fmt: skip


def converted_row(form: str, log: Path, messages: int, runs: int) -> list[str]:
    """The cost of converting the log."""
    cost = measure(form, log, messages, runs)
    return [
        f"{log.stat().st_size / 1e6:,.1f} MB {log.suffix}", f"{messages:,}", f"{cost['read']:.3f}",
        f"{cost['wall']:.3f}", f"{cost['bytes']:.1f}", f"{cost['rss']:.0f}",
    ]  # fmt: skip


Writer = Callable[[Path, int], int]
"""Writes a log so many times as long as the shortest; how many messages it has."""


def flights_of(folder: Path, size: float) -> dict[str, Writer]:
    """For each kind of log what repeats a flight of so many bytes."""
    import dataflash_log

    telemetry, dataflash = folder / "flight.tlog", folder / "flight.BIN"
    record = traffic.generate(telemetry, SAMPLE).bytes / SAMPLE
    written = traffic.generate(telemetry, max(int(size / record), 1))
    dataflash_log.write(dataflash, SAMPLE)
    records = max(int(size / (dataflash.stat().st_size / SAMPLE)), 1)
    dataflash_log.write(dataflash, records)
    described = len(dataflash_log.TYPES) + 1
    return {
        ".tlog": partial(repeat, telemetry, written.messages),
        ".BIN": partial(repeat, dataflash, records + described),
    }


def repeat(flight: Path, messages: int, log: Path, flights: int) -> int:
    """Write a flight of so many messages over and over."""
    content = flight.read_bytes()
    with log.open("wb") as file:
        file.writelines(content for _ in range(flights))
    return messages * flights


def of_every_type(size: float) -> dict[str, Writer]:
    """Writers of logs of all types, the shortest of so many bytes."""
    import every_type_log

    return {".tlog": lambda log, times: every_type_log.write(log, int(size * times))}


def measured(
    headings: tuple[str, ...], make_row: Callable[[Path, int, int], list[str]],
    writers: dict[str, Writer], folder: Path, runs: int,
) -> str:  # fmt: skip
    """A table in Markdown, a row for each log of each kind, which is printed as it comes."""
    lines = [f"| {' | '.join(headings)} |", f"|{' --- |' * len(headings)}"]
    print(*lines, sep="\n")
    for suffix, write in writers.items():
        log = folder / f"log{suffix}"
        for times in FLIGHTS:
            lines.append(f"| {' | '.join(make_row(log, write(log, times), runs))} |")
            print(lines[-1], flush=True)
        log.unlink()
    print()
    return "\n".join([f"Medians of {runs} processes.", "", *lines])


def main() -> None:
    """Print two tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bytes", type=float, default=1e9, help="of the longest log (1e9)")
    parser.add_argument("--runs", type=int, default=3, help="processes for each figure (3)")
    parser.add_argument("--only-convert", action="store_true", help="only the conversions")
    parser.add_argument("--format", default="parquet", help="convert to this (parquet)")
    parser.add_argument("--every-type", action="store_true", help="logs of all types there are")
    parser.add_argument("--document", action="store_true", help=f"write it into {DOCUMENT.name}")
    parser.add_argument("--read", nargs=2, metavar=("READER", "LOG"), help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.read:
        reader, log = args.read
        read = READERS.get(reader) or partial(converted, form=reader)
        print(json.dumps(read(log) | {"rss": peak_rss()}))
        return
    from mavwire.logs.formats import FORMATS  # not above: readers are measured with what they load

    if args.format not in FORMATS:
        parser.error(f"--format is one of {', '.join(FORMATS)}, not {args.format!r}")
    if args.document and (args.every_type or args.format != "parquet"):
        parser.error("the document has the usual logs as Parquet: no --every-type, no --format")
    sys.path.append(str(Path(__file__).parent / "python"))
    import document

    tables = {}
    with TemporaryDirectory() as name:
        folder, size = Path(name), args.bytes / FLIGHTS[-1]
        writers = of_every_type(size) if args.every_type else flights_of(folder, size)
        if not args.only_convert:
            read_writers = {".tlog": writers[".tlog"]}
            tables["long-logs"] = measured(HEADINGS, row, read_writers, folder, args.runs)
        make_row = partial(converted_row, args.format)
        tables["conversions"] = measured(CONVERTED, make_row, writers, folder, args.runs)
    for name, table in tables.items() if args.document else ():
        document.write(DOCUMENT, name, table)


if __name__ == "__main__":
    main()
