"""`convert`: logs to files of other programs, a folder for each message type.

    OUT/manifest.json
    OUT/ATTITUDE/flight.parquet
    OUT/GPS_RAW_INT/flight.parquet

A log's files appear when all of them are complete; the manifest says what was done, so that a run
that was interrupted goes on where it stopped. A log that cannot be read is a row in the manifest.
"""

from __future__ import annotations

import contextlib
import json
import os
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from mavwire._native import Converter

from .query import Query
from .reading import check_readable, native_dialect
from .telemetry import LogFormatError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from datetime import datetime
    from types import ModuleType

FORMATS = {"parquet": ".parquet", "csv": ".csv", "jsonl": ".jsonl", "arrow": ".arrow"}
COMPRESSIONS = {
    "parquet": ("zstd", "snappy", "none"),
    "csv": ("none", "gzip", "zstd"),
    "jsonl": ("none", "gzip", "zstd"),
    "arrow": ("none",),
}
"""What each format may be compressed with, the default first."""
TEXT_SUFFIXES = {"zstd": ".zst", "gzip": ".gz"}
MANIFEST = "manifest.json"
VERSION = 1
BATCH_ROWS = 65_536
BATCH_BYTES = 48 << 20
"""Rows of a Parquet row group, and bytes that wait to become one."""


@dataclass
class Converted:
    """One log in the manifest."""

    path: str
    """Absolute path of the log."""
    size: int = 0
    mtime_ns: int = 0
    """As it was when it was converted."""
    rows: int = 0
    bad_bytes: int = 0
    """Bytes that belong to no record, which no file has."""
    files: dict[str, int] = field(default_factory=dict)
    """`{path below OUT: rows}`."""
    error: str | None = None
    """Why there are no files, or what is wrong with a compressed log."""
    skipped: bool = False
    """It had been converted before, by an earlier run."""


def convert(
    paths: Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    format: str = "parquet",
    compression: str | None = None,
    types: str | type | Iterable[str | type] | None = None,
    systems: int | Iterable[int] | None = None,
    start: float | datetime | None = None,
    end: float | datetime | None = None,
    dialect: str | ModuleType = "all",
    progress: Callable[[str, float], object] | None = None,
) -> list[Converted]:
    """Convert telemetry logs to `out/MESSAGE/LOG.parquet` (or .csv, .jsonl, .arrow).

    Returns a row for each log, in the order given, and writes them to `out/manifest.json`. Logs
    that the manifest has with the same size, time and options, and whose files are all there, are
    not converted again. Memory does not depend on the size of a log. `progress` is told the path
    and percents. ValueError for an argument that makes no sense; a log that cannot be read is a row
    with an `error`.
    """
    if format not in FORMATS:
        raise ValueError(f"format must be one of {', '.join(FORMATS)}, not {format!r}")
    compression = compression or COMPRESSIONS[format][0]
    if compression not in COMPRESSIONS[format]:
        choices = ", ".join(COMPRESSIONS[format])
        raise ValueError(f"{format} is compressed with one of {choices}, not {compression!r}")
    module, native = native_dialect(dialect)
    query = Query.of(module, types, systems, None, start, end)
    query.batch_rows, query.batch_bytes = BATCH_ROWS, BATCH_BYTES
    out = os.fspath(out)
    os.makedirs(out, exist_ok=True)
    how = {"format": format, "compression": compression, **asdict(query)}
    how["dialect"] = getattr(module, "DIALECT", str(dialect))
    manifest = _Manifest(out, how)
    job = _Job(out, native, query, format, compression, progress)
    names = _names([os.path.abspath(os.fspath(path)) for path in paths])
    rows = []
    for path, name in names.items():
        row = manifest.done(path)
        if row is None:
            row = job.run(path, name)
            manifest.add(row)
        rows.append(row)
    return rows


@dataclass
class _Job:
    out: str
    native: Any
    query: Query
    format: str
    compression: str
    progress: Callable[[str, float], object] | None

    def run(self, path: str, name: str) -> Converted:
        row = Converted(path)
        try:
            check_readable(path)
            status = os.stat(path)
            row.size, row.mtime_ns = status.st_size, status.st_mtime_ns
            self._convert(path, name, row)
        except (OSError, ValueError) as error:
            row.error = f"{type(error).__name__}: {error}"
        return row

    def _convert(self, path: str, name: str, row: Converted) -> None:
        suffix = FORMATS[self.format]
        if self.format in ("csv", "jsonl"):
            suffix += TEXT_SUFFIXES.get(self.compression, "")
        converter = Converter(
            path, self.native, self.query, self.out, name + suffix, self.format, self.compression
        )
        try:
            while converter.step():
                position = converter.progress()[0]
                if self.progress is not None and row.size:
                    self.progress(path, min(100.0, 100.0 * position / row.size))
            position, row.bad_bytes, row.error = converter.progress()
            if position and row.bad_bytes == position:
                raise LogFormatError(f"no telemetry log, there is no record in it: {path!r}")
            for written, rows in converter.commit():
                row.files[os.path.relpath(written, self.out)] = rows
                row.rows += rows
        finally:
            converter.abandon()


class _Manifest:
    """What was converted into a folder, and how."""

    def __init__(self, out: str, how: dict[str, Any]) -> None:
        self.out = out
        self.path = os.path.join(out, MANIFEST)
        self.how = json.loads(json.dumps(how))
        self.rows: dict[str, dict[str, Any]] = {}
        with contextlib.suppress(OSError, ValueError):
            with open(self.path, encoding="utf-8") as file:
                stored = json.load(file)
            if stored["version"] == VERSION and stored["options"] == self.how:
                self.rows = {row["path"]: row for row in stored["logs"]}

    def done(self, path: str) -> Converted | None:
        """The row of a log that need not be converted again."""
        row = self.rows.get(path)
        if row is None or row["error"] is not None:
            return None
        try:
            status = os.stat(path)
        except OSError:
            return None
        there = all(os.path.exists(os.path.join(self.out, name)) for name in row["files"])
        if not there or (status.st_size, status.st_mtime_ns) != (row["size"], row["mtime_ns"]):
            return None
        return Converted(**{**row, "skipped": True})

    def add(self, row: Converted) -> None:
        """Note a log and store the manifest, which is never seen half written."""
        stored = asdict(row)
        del stored["skipped"]
        self.rows[row.path] = stored
        content = {"version": VERSION, "options": self.how, "logs": list(self.rows.values())}
        draft = self.path + ".part"
        with open(draft, "w", encoding="utf-8") as file:
            json.dump(content, file, indent=1)
            file.flush()
            os.fsync(file.fileno())
        os.replace(draft, self.path)


def _names(paths: list[str]) -> dict[str, str]:
    """A name for the files of each log, unique among them: the log's own, numbered where two are
    called the same.
    """
    names: dict[str, str] = {}
    taken: set[str] = set()
    for path in paths:
        if path in names:
            continue
        stem = os.path.basename(path)
        for suffix in (".gz", ".zst", ".tlog"):
            stem = stem.removesuffix(suffix)
        name, number = stem or "log", 1
        while name in taken:
            number += 1
            name = f"{stem}-{number}"
        taken.add(name)
        names[path] = name
    return names
