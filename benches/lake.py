"""`make bench-lake`: what it costs to make tables of many logs, as files of each log and as a lake.

Each row is a process of its own; its CPU time is that of its children and of its cluster too. Every lake must
have the rows of the converted files, value by value: DuckDB sums a hash of each row. `--files` is the number of
logs, each of 20,000 messages, `--among` how many small logs there are already where one more is added.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

import duckdb
import psutil
from mavwire import lake, traffic

sys.path.append(str(Path(__file__).parent / "python"))

import document
import lake_formats

HEADINGS = ("", "logs", "messages", "CPU s", "wall s", "files", "MB")
DOCUMENT = Path(__file__).parents[1] / "docs" / "benchmarks.md"
SMALL = 200
"""Messages of a small log."""

READ = """
import sys, polars
table, log = sys.argv[1:]
def read(): return int(open("/proc/self/io").readline().split()[1])
before = read()
print(polars.scan_delta(table).filter(polars.col("log") == log).collect().height)
print(read() - before)
"""
"""Reads the rows of a log, and prints how many there are and the bytes read."""

Sums = dict[str, tuple[int, int]]
"""Rows and a hash, by message type."""


def busy() -> float:
    """CPU seconds of this process and of those that it has: of a cluster, its scheduler and workers."""
    own = psutil.Process()
    times = [one.cpu_times() for one in (own, *own.children(recursive=True))]
    return sum(one.user + one.system for one in times)


def spent(words: list[str]) -> tuple[float, float]:
    """CPU and wall time of a command, and of a cluster that it uses."""
    before, began = busy(), perf_counter()
    process = subprocess.Popen([sys.executable, "-m", "mavwire", *words, "--quiet"])
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{' '.join(words[:1])} ended with {process.returncode}")
    return usage.ru_utime + usage.ru_stime + busy() - before, perf_counter() - began


def sums_of_lake(root: Path) -> Sums:
    """Row counts and checksums of a lake."""
    import deltalake

    found = {}
    for name, (path, version) in lake.tables(root).items():
        files = deltalake.DeltaTable(path, version=version).file_uris()
        if files:
            found[name] = sums(files)
    return found


def sums_of_files(out: Path) -> Sums:
    """Row counts and checksums of a folder of converted logs."""
    folders = [one for one in out.iterdir() if one.is_dir()]
    return {one.name: sums([str(one / "*.parquet")]) for one in folders}


SIGNED = {"UTINYINT": "SMALLINT", "USMALLINT": "INTEGER", "UINTEGER": "BIGINT", "UBIGINT": "BIGINT"}


def sums(files: list[str]) -> tuple[int, int]:
    """Rows, and a sum of the hashes of their values."""
    table = f"read_parquet({files!r}, hive_partitioning = false)"
    columns = []
    for name, kind, *_ in duckdb.execute(f"describe select * from {table}").fetchall():
        if name in ("log", "digest"):
            continue
        base, is_list, _ = kind.partition("[")
        columns.append(f'"{name}"::{SIGNED.get(base, base)}{is_list and "[]"}')
    row = f"sum((hash({', '.join(columns)}) % 4294967296)::HUGEINT)"
    rows, total = duckdb.execute(f"select count(*), {row} from {table}").fetchall()[0]
    return int(rows), int(total)


def files_in(folder: Path) -> tuple[int, int]:
    """Files and bytes."""
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    return len(sizes), sum(sizes)


class Bench:
    """The table, and what every row must be equal to."""

    def __init__(self, folder: Path, runs: int) -> None:
        self._folder = folder
        self._runs = runs
        self.rows: list[list[str]] = []
        self.expected: Sums = {}

    def row(
        self, name: str, logs: int, words: list[str], out: str, sums: Callable[[Path], Sums] | None,
        again: bool = False, before: Callable[[], object] = lambda: None,
    ) -> None:  # fmt: skip
        """Measure a command that writes to `out`, which is removed before each run unless it goes on."""
        place = self._folder / out
        times = []
        for _ in range(self._runs):
            if not again:
                shutil.rmtree(place, ignore_errors=True)
            before()
            times.append(spent([*words, "-o", str(place)]))
        cpu, wall = (median(one) for one in zip(*times, strict=True))
        messages = 0
        if sums is not None:
            found = sums(place)
            self.expected = self.expected or found
            messages = sum(rows for rows, _ in found.values())
            if found != self.expected:
                raise SystemExit(f"{name}: other rows than the first one has")
        files, size = files_in(place)
        count = f"{messages:,}" if messages else ""
        cells = [name, f"{logs:,}", count, f"{cpu:.2f}", f"{wall:.2f}"]
        self._add([*cells, f"{files:,}", f"{size / 1e6:.1f}"])

    def read(self, lake: str, log: Path) -> None:
        """Measure how a type of one log is read, and the bytes that takes."""
        words = [sys.executable, "-c", READ, str(self._folder / lake / "ATTITUDE"), str(log)]
        times = []
        for _ in range(self._runs):
            began, before = perf_counter(), os.times()
            made = subprocess.run(words, capture_output=True, text=True, check=True)
            used = os.times()
            cpu = sum(used[2:4]) - sum(before[2:4])  # of children that ended
            times.append((cpu, perf_counter() - began))
        cpu, wall = (median(one) for one in zip(*times, strict=True))
        rows, size = map(int, made.stdout.split())
        name = "`ATTITUDE` of one of these in polars, and MB read"
        self._add([name, "1", f"{rows:,}", f"{cpu:.2f}", f"{wall:.2f}", "", f"{size / 1e6:.1f}"])

    def _add(self, cells: list[str]) -> None:
        self.rows.append(cells)
        print(f"| {' | '.join(cells)} |", flush=True)


def run(folder: Path, logs: int, among: int, runs: int) -> list[list[str]]:
    """The rows of the table."""
    every = folder / "logs"
    every.mkdir()
    for number in range(logs):
        traffic.generate(every / f"{number:04}.tlog", 20_000, seed=number % 10)
    paths = sorted(map(str, every.iterdir()))
    one = folder / "one.tlog"
    with one.open("wb") as out:
        for path in paths:
            out.write(Path(path).read_bytes())
    bench = Bench(folder, runs)
    print(f"| {' | '.join(HEADINGS)} |\n|{' --- |' * len(HEADINGS)}")
    bench.row("`convert`", logs, ["convert", *paths], "files", sums_of_files)
    bench.row("`convert` of the same as one log", 1, ["convert", str(one)], "one", None)
    bench.row("`ingest`", logs, ["ingest", *paths], "lake", sums_of_lake)
    bench.row("`ingest` again", logs, ["ingest", *paths], "lake", sums_of_lake, again=True)
    bench.row(
        "`ingest --workers 1`", logs, ["ingest", *paths, "--workers", "1"], "pool", sums_of_lake
    )
    bench.row(
        "`convert --workers 1`, Dask",
        logs,
        ["convert", *paths, "--workers", "1"],
        "dask",
        sums_of_files,
    )
    with Cluster() as address:
        words = ["ingest", *paths, "--scheduler", address]
        bench.row("`ingest --scheduler`, Dask", logs, words, "scheduled", sums_of_lake)
    small = folder / "small-logs"
    small.mkdir()
    content = [_small(folder, seed) for seed in range(10)]
    for number in range(among):
        (small / f"{number:06}.tlog").write_bytes(content[number % 10])
    bench.expected = {}
    bench.row(
        f"`ingest` of logs of {SMALL} messages",
        among,
        ["ingest", f"{small}/*.tlog"],
        "small",
        sums_of_lake,
    )
    more = iter(range(among, among + runs))
    bench.row(
        "one more among these", among + 1, ["ingest", f"{small}/*.tlog"], "small", None, again=True,
        before=lambda: (small / f"{next(more):06}.tlog").write_bytes(content[3]),
    )  # fmt: skip
    bench.read("small", small / f"{among // 2:06}.tlog")
    bench.row("`ingest --compact`", 0, ["ingest", "--compact"], "small", None, again=True)
    return [list(HEADINGS), *bench.rows]


def _small(folder: Path, seed: int) -> bytes:
    path = folder / "small.tlog"
    traffic.generate(path, SMALL, seed=seed)
    return path.read_bytes()


class Cluster:
    """A Dask cluster of one process, which is warm: it has imported what a part needs."""

    def __enter__(self) -> str:
        from distributed import Client, LocalCluster

        self._cluster = LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0")
        with Client(self._cluster) as client:
            client.submit(__import__, "mavwire.lake").result()
        return str(self._cluster.scheduler_address)

    def __exit__(self, *_: object) -> None:
        self._cluster.close()


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--files", type=int, default=200)
    parser.add_argument("--among", type=int, default=10_000)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--formats", action="store_true", help="only commits, by table format")
    parser.add_argument("--document", action="store_true", help="write docs/benchmarks.md")
    args = parser.parse_args()
    if args.formats:
        print(document.markdown(lake_formats.rows()))
        return
    with TemporaryDirectory() as name:
        rows = run(Path(name), args.files, args.among, args.runs)
    if args.document:
        text = f"Medians of {args.runs} processes.\n\n{document.markdown(rows)}"
        document.write(DOCUMENT, "lakes", text)


if __name__ == "__main__":
    main()
