"""`convert`: logs to files of other programs, a folder for each message type.

    OUT/manifest.json
    OUT/ATTITUDE/flight.parquet
    OUT/GPS_RAW_INT/flight.parquet

A log's files appear when all of them are complete; the manifest says what was done, so that a run
that was interrupted goes on where it stopped. A log that cannot be read is a row in the manifest.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from mavwire.links.recognise import read_head

from .query import Query, check_fields
from .reading import check_readable, native_dialect
from .sources import open_converter
from .store import Files, Store
from .telemetry import HEAD_SIZE, not_telemetry

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
    name: str
    """What its files are called, without suffix."""
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
    """Convert logs of any kind to `out/MESSAGE/LOG.parquet` (or .csv, .jsonl, .arrow).

    Returns a row for each log, in the order given, and writes them to `out/manifest.json`. Logs
    that the manifest has with the same size, time and options, and whose files are all there, are
    not converted again. Logs of one name are numbered, and keep their numbers in later runs. With
    other options the manifest begins anew, and files of earlier runs stay until one of the same
    name replaces them: use a folder for each set of options. Memory does not depend on the size of
    a log. `progress` is told the path and percents. ValueError for an argument that makes no sense,
    and where `out/manifest.json` is not one of these; a log that cannot be read is a row with an
    `error`.
    """
    compression, native, query, how = prepare(
        format, compression, types, systems, None, start, end, dialect
    )
    out = os.fspath(out)
    manifest = Manifest(Store(out), how)
    job = Job(out, native, query, format, compression, progress)
    names = manifest.names([os.path.abspath(os.fspath(path)) for path in paths])
    rows = []
    for path, name in names.items():
        row = manifest.done(path)
        if row is None:
            row = job.run(path, name)
            manifest.add(row)
            manifest.store()
        rows.append(row)
    return rows


def prepare(
    format: str,
    compression: str | None,
    types: str | type | Iterable[str | type] | None,
    systems: int | Iterable[int] | None,
    fields: str | Iterable[str] | None,
    start: float | datetime | None,
    end: float | datetime | None,
    dialect: str | ModuleType,
) -> tuple[str, Any, Query, dict[str, Any]]:
    """The compression, the native dialect, what to read, and the options that a manifest keeps.

    ValueError for an argument that makes no sense.
    """
    if format not in FORMATS:
        raise ValueError(f"format must be one of {', '.join(FORMATS)}, not {format!r}")
    compression = compression or COMPRESSIONS[format][0]
    if compression not in COMPRESSIONS[format]:
        choices = ", ".join(COMPRESSIONS[format])
        raise ValueError(f"{format} is compressed with one of {choices}, not {compression!r}")
    module, native = native_dialect(dialect)
    query = Query.of(module, types, systems, fields, start, end)
    if query.foreign is None:  # else the fields are those of dataflash logs
        check_fields(module, query, fields)
    query.batch_rows, query.batch_bytes = BATCH_ROWS, BATCH_BYTES
    how = {"format": format, "compression": compression, **asdict(query)}
    how["dialect"] = getattr(module, "DIALECT", str(dialect))
    return compression, native, query, how


@dataclass
class Job:
    """How logs become files below `out`."""

    out: str
    native: Any
    query: Query
    format: str
    compression: str
    progress: Callable[[str, float], object] | None

    def run(self, path: str, name: str) -> Converted:
        """Convert a log to `out/MESSAGE/name`; what went wrong is in the row."""
        row = Converted(path, name)
        try:
            check_readable(path)
            row.size, row.mtime_ns = file_status(path)
            self._convert(path, name, row)
        except (OSError, ValueError) as error:
            row.error = f"{type(error).__name__}: {error}"
        return row

    def _convert(self, path: str, name: str, row: Converted) -> None:
        suffix = FORMATS[self.format]
        if self.format in ("csv", "jsonl"):
            suffix += TEXT_SUFFIXES.get(self.compression, "")
        converter = open_converter(
            path, self.native, self.query, self.out, name + suffix, self.format, self.compression
        )
        try:
            while converter.step():
                position = converter.progress()[0]
                if self.progress is not None and row.size:
                    self.progress(path, min(100.0, 100.0 * position / row.size))
            position, row.bad_bytes, row.error = converter.progress()
            if position and row.bad_bytes == position:
                raise not_telemetry(path, read_head(path, HEAD_SIZE))
            for written, rows in converter.commit():
                row.files[os.path.relpath(written, self.out)] = rows
                row.rows += rows
        finally:
            converter.abandon()


class Manifest:
    """What was converted into a folder, and how. `status` gives size and time of a log, or raises
    OSError.
    """

    def __init__(
        self,
        store: Files,
        how: dict[str, Any],
        status: Callable[[str], tuple[int, int]] | None = None,
    ) -> None:
        self._store = store
        self._status = status or file_status
        self.how = json.loads(json.dumps(how))
        self.rows: dict[str, Converted] = {}
        content = store.read(MANIFEST)
        if content is not None:
            stored = _stored(content, store.place(MANIFEST))
            if stored["options"] == self.how:
                self.rows = {row["path"]: Converted(**row) for row in stored["logs"]}

    def done(self, path: str) -> Converted | None:
        """The row of a log that need not be converted again."""
        row = self.rows.get(path)
        if row is None or row.error is not None:
            return None
        try:
            status = self._status(path)
        except OSError:
            return None
        there = all(self._store.exists(name) for name in row.files)
        if not there or status != (row.size, row.mtime_ns):
            return None
        return replace(row, skipped=True)

    def add(self, row: Converted) -> None:
        """Note a log."""
        self.rows[row.path] = row

    def store(self) -> None:
        """Write the manifest, which is never seen half written."""
        logs = [{key: getattr(one, key) for key in _ROW} for one in self.rows.values()]
        content = {"version": VERSION, "options": self.how, "logs": logs}
        self._store.write(MANIFEST, json.dumps(content, indent=1).encode())

    def names(self, paths: list[str]) -> dict[str, str]:
        """A name for the files of each log."""
        earlier = {row.path: row.name for row in self.rows.values()}
        return _names(paths, earlier, self.taken())

    def taken(self) -> set[str]:
        """What files of logs are called, without folder and suffix."""
        suffix = FORMATS[self.how["format"]]
        files = {
            os.path.basename(name).rpartition(suffix)[0]
            for row in self.rows.values()
            for name in row.files
        }
        return files | {row.name for row in self.rows.values()}


def file_status(path: str) -> tuple[int, int]:
    """Bytes of a file, and when it was changed in nanoseconds since 1970."""
    status = os.stat(path)
    return status.st_size, status.st_mtime_ns


_ROW = {
    "path": str,
    "name": str,
    "size": int,
    "mtime_ns": int,
    "rows": int,
    "bad_bytes": int,
    "files": dict,
    "error": str | None,
}
"""What the manifest holds of `Converted`."""


def _stored(content: bytes, path: str) -> dict[str, Any]:
    """The content of a manifest; ValueError for a file of something else, which is not ours to
    replace.
    """
    try:
        stored = json.loads(content)
        if _is_manifest(stored):
            return dict(stored)
    except (ValueError, RecursionError):
        pass
    raise ValueError(
        f"{path} is no manifest of this version of mavwire: convert to another folder or remove it"
    )


def _is_manifest(stored: Any) -> bool:
    return (
        isinstance(stored, dict)
        and stored.get("version") == VERSION
        and isinstance(stored.get("options"), dict)
        and isinstance(stored.get("logs"), list)
        and all(map(_is_row, stored["logs"]))
    )


def _is_row(row: Any) -> bool:
    if not isinstance(row, dict) or row.keys() != _ROW.keys():
        return False
    if not all(isinstance(row[key], kind) for key, kind in _ROW.items()):
        return False
    # Files are written by this name, nowhere but in the folder of their type.
    return row["name"] not in ("", ".", "..") and os.path.basename(row["name"]) == row["name"]


def _names(paths: list[str], earlier: dict[str, str], taken: set[str]) -> dict[str, str]:
    """A name for the files of each log, that of the `earlier` run or one that is not `taken`: the
    log's own, numbered where two are called the same.
    """
    names: dict[str, str] = {}
    for path in paths:
        if path in names:
            continue
        if path in earlier:
            names[path] = earlier[path]
            continue
        stem = os.path.basename(path)
        for suffix in (".gz", ".zst", ".tlog", ".BIN", ".bin", ".log"):
            stem = stem.removesuffix(suffix)
        name, number = stem or "log", 1
        while name in taken:
            number += 1
            name = f"{stem}-{number}"
        taken.add(name)
        names[path] = name
    return names
