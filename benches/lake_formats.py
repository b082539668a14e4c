"""`make bench-lake BENCH_FLAGS=--formats`: what it costs to add a file to each of 37 tables, by table format.

The file is there already. Delta Lake by deltalake, Iceberg by pyiceberg with a catalog in SQLite, and a manifest of
our own: the list of all files as JSON, which is written anew. Medians over commits of CPU time, for all tables.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

TABLES = 37
COMMITS = 10
ROWS = 1000


def delta(folder: Path) -> Callable[[int, int, Path], object]:
    """Add a file to the Delta Lake table of a number."""
    from mavwire.lake.delta import apply, opened

    columns = [{"name": "x", "type": "long", "nullable": True, "metadata": {}}]
    stats = json.dumps({"numRecords": ROWS})

    def add(table: int, commit: int, file: Path) -> object:
        one = {
            "path": file.name, "size": file.stat().st_size, "partition_values": {},
            "modification_time": 0, "stats": stats,
        }  # fmt: skip
        change = {"columns": columns, "partition": [], "add": [one], "remove": [], "data": True}
        place = str(folder / str(table))
        return apply(opened(place), place, commit, change)

    return add


def iceberg(folder: Path) -> Callable[[int, int, Path], object]:
    """The same with Iceberg."""
    import pyarrow as pa
    from pyiceberg.catalog.sql import SqlCatalog

    catalog = SqlCatalog("lake", uri=f"sqlite:///{folder}/catalog.db", warehouse=f"file://{folder}")
    catalog.create_namespace("lake")
    schema = pa.schema([("x", pa.int64())])
    tables: dict[int, Any] = {}

    def add(table: int, commit: int, file: Path) -> object:
        if table not in tables:
            tables[table] = catalog.create_table(f"lake.t{table}", schema)
        catalog.load_table(f"lake.t{table}").add_files([str(file)])
        return None

    return add


def manifest(folder: Path) -> Callable[[int, int, Path], object]:
    """The same with a list of files."""
    from mavwire.logs.store import write_file

    files: dict[int, list[str]] = {}

    def add(table: int, commit: int, file: Path) -> object:
        files.setdefault(table, []).append(file.name)
        if table == TABLES - 1:
            write_file(os.fspath(folder / "manifest.json"), json.dumps(files).encode())
        return None

    return add


FORMATS = {
    "Delta Lake, deltalake": delta,
    "Iceberg, pyiceberg": iceberg,
    "folders and a manifest": manifest,
}
HEADINGS = ("format", "CPU ms", "wall ms", "files besides data")


def measured(make: Callable[[Path], Callable[[int, int, Path], object]]) -> list[str]:
    """The cells of a format."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    with TemporaryDirectory() as name:
        folder, times = Path(name), []
        add = make(folder)
        for commit in range(1, COMMITS + 1):
            files = [folder / str(table) / f"{commit}.parquet" for table in range(TABLES)]
            for file in files:
                file.parent.mkdir(exist_ok=True)
                pq.write_table(pa.table({"x": range(ROWS)}), file)
            began, start = perf_counter(), process_time()
            for table, file in enumerate(files):
                add(table, commit, file)
            times.append((process_time() - start, perf_counter() - began))
        cpu, wall = (median(one) * 1e3 for one in zip(*times[1:], strict=True))
        every = sum(one.is_file() for one in folder.rglob("*"))
        return [f"{cpu:.0f}", f"{wall:.0f}", f"{every - TABLES * COMMITS:,}"]


def rows() -> list[list[str]]:
    """The table, with a row for each format whose library is installed."""
    found = [list(HEADINGS)]
    for name, make in FORMATS.items():
        try:
            found.append([name, *measured(make)])
        except ImportError as error:
            print(f"{name} is left out: {error}")
    return found
