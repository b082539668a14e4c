"""`convert`: logs to files of other programs, a folder for each message type, or one MCAP file.

    OUT/manifest.json
    OUT/ATTITUDE/flight.parquet
    OUT/GPS_RAW_INT/flight.parquet

A log's files appear when all of them are complete; the manifest says what was done, so that a run
that was interrupted goes on where it stopped. A log that cannot be read is a row in the manifest.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Unpack

from mavwire._native import Converter
from mavwire._text import in_words
from mavwire.dialects import UPSTREAM
from mavwire.dialects._descriptions import of_messages

from .checks import check_tables
from .dialect import Dialects
from .formats import COMPRESSIONS, FORMATS, ONE_FILE, TEXT_SUFFIXES, TEXTS
from .manifest import Converted, Manifest
from .open_files import many_open_files
from .query import Query, Types, takes
from .reading import (
    absolute,
    allow_described,
    check_fields,
    check_readable,
    native_dialect,
    paths_of,
)
from .selection import Selection, separate_fields
from .sources import Source, check_run, columns_from, file_status, open_dataflash
from .store import Store, remove_left
from .unknown import kinds_of, log_of_table

BATCH_ROWS = 65_536
BATCH_BYTES = 32 << 20
"""Rows of a Parquet row group, and bytes that wait to become one."""
OUTPUT = 2
"""Increase it when the same options give other files, so that old files are made anew."""
INTERNAL = (
    "dialect",
    "unknown_ids",
    "descriptions",
    "batch_rows",
    "batch_bytes",
    "foreign",
)
"""Attributes of a selection that make no difference to files."""


@takes(Query)
def convert(
    paths: Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    format: str = "parquet",
    compression: str | None = None,
    types: Types = None,
    csv_safe: bool = True,
    dialect: Dialects = UPSTREAM,
    from_unknown: bool = False,
    progress: Callable[[str, float], object] | None = None,
    **query: Unpack[Query],
) -> list[Converted]:
    """Convert logs of any kind to `out/MESSAGE/LOG.parquet` (or .csv, .jsonl, .arrow), or to
    `out/LOG.mcap`, which holds all messages.

    `types` and `query` are those of `mavwire.read`. MCAP has values as sent,
    without invalid values unless `invalid="keep"`. `csv_safe` puts an apostrophe in front of texts in
    CSV files that begin with = + - @, a tab or a line break, except numbers: a spreadsheet would run
    them as formulas. A log with more than 1,000 types is refused unless `types` names some.
    Returns a row for each log, in the order given, and writes them to `out/manifest.json`. Logs
    that the manifest has with the same size, time, options and definitions, and whose files are all there, are
    not converted again. Logs of one name are numbered, and keep their numbers in later runs. With
    other options the manifest begins anew, and files of earlier runs stay until one of the same
    name replaces them: use a folder for each set of options. With
    `from_unknown` the paths are tables `mavwire.unknown` of an earlier run, as Parquet or Arrow. Memory
    does not depend on the size of a log. `progress` is told the path and percents.

    ValueError for an argument that makes no sense, where `out/manifest.json` is not one of these, and while another
    run writes to `out`; a log that cannot be read is a row with an `error`.
    """
    logs = paths_of(paths)
    for place in (os.fsdecode(out), *logs):
        if "://" in place and not os.path.exists(place):
            raise ValueError(
                f"{place} is a URL: mavwire.fleet (--workers, --scheduler) takes those"
            )
    logs = [absolute(path) for path in logs]
    compression, native, selection, how = prepare(
        format, compression, types, dialect, csv_safe=csv_safe, logs=logs, **query
    )
    allow_described(logs, selection)
    out = os.fsdecode(out)
    store = Store(out)
    with store.locked():
        remove_left(out)  # of a fleet that was killed
        manifest = Manifest(store, how)
        job = Job(out, native, selection, format, compression, progress, from_unknown=from_unknown)
        names = manifest.names(logs)
        rows = {path: manifest.done(path) for path in names}
        todo = {path: name for path, name in names.items() if rows[path] is None}
        manifest.begin(todo)
        try:
            for path, name in todo.items():
                rows[path] = row = job.run(path, name)
                manifest.add(row)
        finally:
            manifest.close()
    return [row for row in rows.values() if row is not None]


def prepare(
    format: str,
    compression: str | None,
    types: Types,
    dialect: Dialects,
    *,
    csv_safe: bool = True,
    logs: Iterable[str] = (),
    **query: Unpack[Query],
) -> tuple[str, Any, Selection, dict[str, Any]]:
    """The compression, the native dialect, what to read, and the options that a manifest keeps.

    `logs` tell what fields there are: those of a dataflash log are known by the log alone.
    ValueError for an argument that makes no sense.
    """
    if format not in FORMATS:
        raise ValueError(f"format must be one of {', '.join(FORMATS)}, not {format!r}")
    compression = compression or COMPRESSIONS[format][0]
    if compression not in COMPRESSIONS[format]:
        choices = ", ".join(COMPRESSIONS[format])
        raise ValueError(f"{format} is compressed with one of {choices}, not {compression!r}")
    module, native = native_dialect(dialect)
    if format in ONE_FILE and (query.get("units") or query.get("enums")) is not None:
        raise ValueError(f"{format} has values as they are sent: leave units and enums out")
    if format in ONE_FILE:
        # MCAP files are read by programs that draw graphs.
        query["invalid"] = query.get("invalid") or "null"
    fields = separate_fields(query)
    selection = Selection.of(module, types, **query)
    selection.csv_safe = csv_safe and format == "csv"
    check_tables(module, native, selection)
    if fields is not None:
        check_fields(list(logs), module, native, selection, fields)
    # A file of all types is sorted by time, stretch by stretch: none waits for more of its kind.
    selection.batch_rows = 0 if format in ONE_FILE else BATCH_ROWS
    selection.batch_bytes = BATCH_BYTES
    how = {"format": format, "compression": compression, "output": OUTPUT, **asked(selection)}
    how["dialect"] = getattr(module, "DIALECT", str(dialect))
    how["definitions"] = _fingerprint(native, selection)
    selection.descriptions = of_messages(native) if format in ONE_FILE else None
    return compression, native, selection, how


def asked(selection: Selection) -> dict[str, Any]:
    """The options of a user. Lists are sorted where the order makes no difference."""
    how = {name: one for name, one in vars(selection).items() if name not in INTERNAL}
    how["unknown"] = selection.unknown == "table"  # the other words make no difference to files
    for name in ("types", "names", "systems"):
        how[name] = None if how[name] is None else sorted(set(how[name]))
    return how


def _fingerprint(native: Any, selection: Selection) -> str:
    """A hash of the definitions of the wanted messages."""
    types = None if selection.types is None else set(selection.types)
    told = hashlib.sha256(native.layout_text(types).encode())
    if (
        selection.enum_names or selection.invalid == "null"
    ):  # `invalid` may be the name of an enum's value
        told.update(repr(native.enums()).encode())
    return told.hexdigest()


@dataclass
class Job:
    """How logs become files below `out`."""

    out: str
    native: Any
    selection: Selection
    format: str
    compression: str
    progress: Callable[[str, float], object] | None
    named: str | None = None
    """The name of `out` in errors, if files are moved when they are complete."""
    from_unknown: bool = False
    """The logs are tables `mavwire.unknown`."""

    def run(self, path: str, name: str, source: Source | None = None) -> Converted:
        """Convert a log to `out/MESSAGE/name`, or `out/name`; what went wrong is in the row.

        `source` is what is to be read of it, where that is not the file `path`, whose size and time are then left out.
        """
        row = Converted(path, name)
        try:
            if source is None:
                check_readable(path)
                row.size, row.mtime_ns = file_status(path)
            with many_open_files():
                if source is None:
                    source = log_of_table(path) if self.from_unknown else path
                self._convert(source, row)
        except (OSError, ValueError, MemoryError) as error:
            if isinstance(error, OSError):
                self._name_place(error)
            row.error = in_words(error, path)
        return row

    def _name_place(self, error: OSError) -> None:
        """Give an error of a file below `out` the name that the file is to have."""
        if self.named is not None and str(error.filename).startswith(os.path.join(self.out, "")):
            error.filename = os.path.join(self.named, os.path.relpath(error.filename, self.out))

    def _convert(self, source: Source, row: Converted) -> None:
        file = row.name + FORMATS[self.format]
        if self.format in TEXTS:
            file += TEXT_SUFFIXES.get(self.compression, "")
        log = columns_from(open_dataflash(source, row.path), source, self.native, self.selection)
        converter = Converter(log, self.selection, self.out, file, self.format, self.compression)
        try:
            while converter.step():
                position = log.progress()[0]
                if self.progress is not None and row.size:
                    self.progress(row.path, min(100.0, 100.0 * position / row.size))
            position, row.bad_bytes, row.error, unknown = log.progress()
            check_run(source, row.path, position, row.bad_bytes, row.error)
            row.unknown = kinds_of(unknown)
            for written, rows in converter.commit():
                row.files[os.path.relpath(written, self.out)] = rows
                row.rows += rows
        finally:
            converter.abandon()
