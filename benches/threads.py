"""`make bench-threads`: how much faster a log becomes tables on two threads than on one.

A process for each figure, with one thread, with two, and two processes with one thread each at the same time, in turns. The
last says what the machine allows: two processors that share their cache and their clock do not give twice the work of one.
Wall time; the processes make the tables over and over and answer with the median. Every process must find the same rows.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import mavwire
from mavwire import traffic

sys.path.append(str(Path(__file__).parent / "python"))

import dataflash_log
from large_log import converted

HEADINGS = ("", "rows", "1 thread, ms", "2 threads, ms", "as fast", "the machine allows")


def tables(path: str) -> tuple[int, float]:
    """Rows of all tables of a log, and the seconds that they took."""
    start = perf_counter()
    found = mavwire.read(path, dialect="ardupilotmega")
    return sum(len(table) for table in found.values()), perf_counter() - start


def parquet(path: str) -> tuple[int, float]:
    """Rows that are converted to Parquet, and the seconds that it took without removing the files."""
    answer = converted(path)
    return answer["messages"], answer["wall"]


WORK: dict[str, Callable[[str], tuple[int, float]]] = {"columns": tables, "Parquet": parquet}


def answer(work: str, path: str, repetitions: int) -> dict[str, Any]:
    """Rows and median of the seconds, after a first time that does not count."""
    WORK[work](path)
    rows, seconds = zip(*(WORK[work](path) for _ in range(repetitions)), strict=True)
    return {"rows": sorted(set(rows)), "seconds": median(seconds)}


def measure(
    work: str, log: Path, repetitions: int, threads: int, processes: int
) -> tuple[int, float]:
    """Rows, and the mean of what processes that run at the same time answer."""
    command = [
        sys.executable,
        __file__,
        "--work",
        work,
        str(log),
        "--repetitions",
        str(repetitions),
    ]
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    started = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
        for _ in range(processes)
    ]
    answers = [json.loads(process.communicate()[0]) for process in started]
    rows = {number for one in answers for number in one["rows"]}
    if len(rows) != 1:
        raise SystemExit(f"{log.name}: {work} found {sorted(rows)} rows")
    return rows.pop(), sum(one["seconds"] for one in answers) / processes


def row(work: str, log: Path, rounds: int, repetitions: int) -> list[str]:
    """Cells of the table: medians of the rounds."""
    seconds: dict[tuple[int, int], list[float]] = {(1, 1): [], (2, 1): [], (1, 2): []}
    rows = set()
    for _ in range(rounds):
        for (threads, processes), kept in seconds.items():
            found, taken = measure(work, log, repetitions, threads, processes)
            rows.add(found)
            kept.append(taken)
    if len(rows) != 1:
        raise SystemExit(f"{log.name}: {work} found {sorted(rows)} rows")
    one, two, beside = (median(kept) for kept in seconds.values())
    return [
        f"{log.suffix} to {work}", f"{rows.pop():,}", f"{one * 1e3:.1f}", f"{two * 1e3:.1f}",
        f"{one / two:.2f}x", f"{2 * one / beside:.2f}x",
    ]  # fmt: skip


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--messages", type=int, default=1_000_000, help="of each log (1,000,000)")
    parser.add_argument("--rounds", type=int, default=5, help="processes for each figure (5)")
    parser.add_argument("--repetitions", type=int, default=9, help="in each process (9)")
    parser.add_argument("--work", nargs=2, metavar=("WORK", "LOG"), help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.work:
        print(json.dumps(answer(args.work[0], args.work[1], args.repetitions)))
        return
    with TemporaryDirectory() as name:
        telemetry, dataflash = Path(name, "flight.tlog"), Path(name, "flight.BIN")
        traffic.generate(telemetry, args.messages)
        dataflash_log.write(dataflash, args.messages)
        print(f"| {' | '.join(HEADINGS)} |\n|{' --- |' * len(HEADINGS)}")
        for log in (telemetry, dataflash):
            for work in WORK:
                print(
                    f"| {' | '.join(row(work, log, args.rounds, args.repetitions))} |", flush=True
                )


if __name__ == "__main__":
    main()
