"""Doing: a part of the logs to files of tables. A function of its arguments: any process may do it."""

from __future__ import annotations

import hashlib
import os
import secrets
import tempfile
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from mavwire._native import LakeFile, RecordBatches, folder_of
from mavwire._text import in_words
from mavwire.fleet.places import located
from mavwire.logs.conversion import Job
from mavwire.logs.manifest import Converted, in_utf8
from mavwire.logs.open_files import many_open_files
from mavwire.logs.reading import native_dialect
from mavwire.logs.selection import Selection
from mavwire.logs.sources import Source, check_run, columns_from, open_dataflash
from mavwire.logs.unknown import kinds_of

from .planning import Task

GROUP_ROWS = 65_536
"""Rows that are written together."""
WAITING_BYTES = 512 << 20
"""Bytes of rows of small logs that wait for more of their table, at most."""
LARGE_BYTES = 128 << 20
"""Bytes of rows from which on a log has files of its own, which go if it cannot be read to its end."""
FILE_BYTES = 256 << 20
"""Bytes of a file from which on a new one is begun."""
OPEN_FILES = 256
EARLIEST = 946_684_800_000_000
"""2000-01-01 in microseconds: times before it count from the start of an autopilot."""

Key = tuple[str, tuple[tuple[str, str | None], ...], tuple[Any, ...]]
"""The folder of a table, values of the partition, and columns."""


@dataclass(frozen=True)
class Recipe:
    """How logs become rows."""

    staging: str
    """A folder on the disk of the lake."""
    selection: Selection
    dialect: str | os.PathLike[str]
    partition: tuple[str, ...]
    storage_options: dict[str, Any] | None = None


@dataclass
class Written:
    """A file of a table."""

    table: str
    name: str
    """Below the folder of the part."""
    partition: dict[str, str | None]
    size: int
    rows: int
    columns: list[tuple[str, str]]
    """Names and types."""
    metadata: dict[str, dict[str, str]]
    ranges: list[tuple[str, tuple[int, int] | tuple[str, str] | None, int]]


@dataclass
class Made:
    """The outcome of a part: rows of the manifest, and files in a folder."""

    folder: str
    rows: list[Converted] = field(default_factory=list)
    files: list[Written] = field(default_factory=list)


def do_part(tasks: list[Task], recipe: Recipe) -> Made:
    """Read the logs and write files into a new folder. An error of a log is in its row."""
    made = Made(tempfile.mkdtemp(prefix="part-", dir=recipe.staging))
    shared = Gatherer(made.folder)
    native = native_dialect(recipe.dialect)[1]
    with many_open_files():
        for task in tasks:
            job = _Job(
                made.folder, native, recipe.selection, "parquet", "zstd", None,
                shared=shared, partition=recipe.partition, known=task.digest,
            )  # fmt: skip
            made.rows.append(_done(task, job, recipe))
            # Not within the row's errors: where a shared file cannot be written, rows of other logs are lost too.
            made.files += job.finish()
        made.files += shared.finish()
    return made


def _done(task: Task, job: _Job, recipe: Recipe) -> Converted:
    try:
        with located(task.path, None, recipe.storage_options) as source:
            row = job.run(task.path, "", source)
    except Exception as error:  # file systems of fsspec raise errors of any type
        row = Converted(task.path, "", error=in_words(error, task.path))
    row.size, row.mtime_ns = task.size, task.mtime_ns
    return row


def digest_of(source: Source) -> str:
    """The SHA-256 of a log."""
    if isinstance(source, str):
        with open(source, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    return hashlib.sha256(source if isinstance(source, bytes) else b"").hexdigest()


@dataclass
class _Job(Job):
    """A log to rows that share files with those of other logs."""

    shared: Any = None
    partition: tuple[str, ...] = ()
    known: str = ""
    rows: _LogRows | None = None
    """Those of a log that was read."""

    def _convert(self, source: Source, row: Converted) -> None:
        row.digest = digest_of(source)
        if row.digest == self.known:
            row.skipped = True
            return
        log = columns_from(open_dataflash(source, row.path), source, self.native, self.selection)
        rows = _LogRows(self, (in_utf8(row.path), row.digest))
        for found in log:
            rows.add(found)
        position, row.bad_bytes, row.error, unknown = log.progress()
        check_run(source, row.path, position, row.bad_bytes, row.error)
        row.unknown = kinds_of(unknown)
        row.rows, self.rows = rows.count, rows

    def finish(self) -> list[Written]:
        """Hand on what is left of the rows; the files of the log alone."""
        return [] if self.rows is None else self.rows.finish()


class _LogRows:
    """The rows of a log. Those of a small one are handed on when all of it is read."""

    def __init__(self, job: _Job, origin: tuple[str, str]) -> None:
        self._job = job
        self._origin = origin
        self._kept: list[tuple[Key, RecordBatches, int]] = []
        self._bytes = 0
        self.count = 0
        self._own: Gatherer | None = None
        self._day: str | None = None
        self._has_day = False

    def add(self, found: list[tuple[str, RecordBatches]]) -> None:
        if not self._has_day and found:
            self._has_day = True
            self._day = day_of([batches for _, batches in found])
        for name, batches in found:
            for key, part in self._keyed(name, batches):
                size = part.nbytes
                self._kept.append((key, part, size))
                self._bytes += size
                self.count += part.num_rows
        if self._bytes >= LARGE_BYTES or self._own is not None:
            self._own = self._own or Gatherer(self._job.out)
            self._hand_on(self._own)

    def _keyed(self, name: str, batches: RecordBatches) -> list[tuple[Key, RecordBatches]]:
        names = batches.names
        # Widths of fields differ from one dataflash log to the next.
        is_telemetry = "sysid" in names
        columns = tuple(names) if is_telemetry else tuple(batches.types().items())
        parts = [("", batches)]
        if "vehicle" in self._job.partition and is_telemetry:
            systems = {system for system, _ in batches.senders()}
            parts = batches.split("sysid") if len(systems) > 1 else [(str(*systems), batches)]
        folder = folder_of(name)
        return [((folder, self._values(vehicle), columns), part) for vehicle, part in parts]

    def _values(self, vehicle: str) -> tuple[tuple[str, str | None], ...]:
        day = self._day
        known = {
            "day": day,
            "month": day and f"{day[:7]}-01",
            "year": day and day[:4],
            "vehicle": vehicle or None,
        }
        return tuple((name, known[name]) for name in self._job.partition)

    def _hand_on(self, files: Gatherer) -> None:
        for key, part, size in self._kept:
            files.add(key, part, size, self._origin)
        self._kept, self._bytes = [], 0

    def finish(self) -> list[Written]:
        """Hand on what is left; the files of the log alone."""
        self._hand_on(self._own or self._job.shared)
        return [] if self._own is None else self._own.finish()


def day_of(tables: list[RecordBatches]) -> str | None:
    """The day of the earliest first row of some tables in UTC, None if they tell no date."""
    first: list[int] = []
    for batches in tables:
        if "timestamp" in batches.names:
            view = batches.slice(0, 1).column("timestamp")
            valid = view.valid()
            if valid is None or all(valid):
                first += memoryview(view).cast("B").cast("q")
    earliest = min((time for time in first if time >= EARLIEST), default=None)
    if earliest is None:
        return None
    try:
        return datetime.fromtimestamp(earliest / 1e6, UTC).strftime("%Y-%m-%d")
    except (OverflowError, ValueError):  # beyond the year 9999
        return None


@dataclass
class _Rows:
    """Rows of a table and partition: those that wait to be written, and the file of those before."""

    waiting: list[tuple[RecordBatches, tuple[str, str]]] = field(default_factory=list)
    count: int = 0
    size: int = 0
    """Bytes of those that wait."""
    file: LakeFile | None = None
    name: str = ""
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)


class Gatherer:
    """Files of a part, one for each table and partition."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._rows: dict[Key, _Rows] = {}
        self._bytes = 0
        """Those of all rows that wait."""
        self._open = 0
        self._done: list[Written] = []

    def add(self, key: Key, batches: RecordBatches, size: int, origin: tuple[str, str]) -> None:
        """Take some rows of a log, and their bytes."""
        rows = self._rows.get(key)
        if rows is None:
            rows = self._rows[key] = _Rows(metadata=batches.metadata())
        rows.waiting.append((batches, origin))
        rows.count += batches.num_rows
        rows.size += size
        self._bytes += size
        if rows.count >= GROUP_ROWS:
            self._write(key, rows)
        elif self._bytes >= WAITING_BYTES:
            for each in self._rows.items():
                self._write(*each)

    def finish(self) -> list[Written]:
        """Write everything."""
        for key, rows in sorted(self._rows.items(), key=lambda each: str(each[0])):
            self._write(key, rows)
            self._close(key, rows)
        return self._done

    def _write(self, key: Key, rows: _Rows) -> None:
        if not rows.waiting:
            return
        if rows.file is None:
            if self._open >= OPEN_FILES:
                self._close(*next(each for each in self._rows.items() if each[1].file is not None))
            rows.name = f"{secrets.token_hex(8)}.parquet"
            rows.file = LakeFile(os.path.join(self._folder, rows.name))
            self._open += 1
        size = rows.file.write(rows.waiting)
        self._bytes -= rows.size
        rows.waiting, rows.count, rows.size = [], 0, 0
        if size >= FILE_BYTES:
            self._close(key, rows)

    def _close(self, key: Key, rows: _Rows) -> None:
        if rows.file is not None:
            partition = dict(key[1])
            self._done.append(
                finished(rows.file, self._folder, rows.name, key[0], partition, rows.metadata)
            )
            rows.file = None
            self._open -= 1


def finished(
    file: LakeFile,
    folder: str,
    name: str,
    table: str,
    partition: dict[str, str | None],
    metadata: dict[str, dict[str, str]],
) -> Written:
    """Complete a file."""
    rows, columns, ranges = file.finish()
    size = os.path.getsize(os.path.join(folder, name))
    return Written(table, name, partition, size, rows, columns, metadata, ranges)
