"""`read` and `scan`: logs as tables, whole or in batches."""

from __future__ import annotations

import errno
import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mavwire._native import DataflashTables, LogColumns, RecordBatches, empty_table

from .query import Query, check_fields
from .sources import is_dataflash, open_columns
from .table import Table, tidy

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from datetime import datetime
    from types import ModuleType

BATCH_ROWS = 65_536
BATCH_BYTES = 64 << 20
"""What `scan` holds at most of rows that are not yet a batch."""


def native_dialect(dialect: str | ModuleType) -> tuple[Any, Any]:
    """The module of a dialect and its native form."""
    from .telemetry import dialect_module

    module = dialect_module(dialect)
    return module, module.MAVLink(None)._dialect


def check_readable(path: str) -> None:
    """Raise FileNotFoundError, IsADirectoryError or PermissionError, with the name."""
    if os.path.isdir(path):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    with open(path, "rb"):
        pass


def read(
    path: str | os.PathLike[str],
    types: str | type | Iterable[str | type] | None = None,
    systems: int | Iterable[int] | None = None,
    fields: str | Iterable[str] | None = None,
    start: float | datetime | None = None,
    end: float | datetime | None = None,
    *,
    units: str | None = None,
    enums: str | None = None,
    wide: bool = False,
    dialect: str | ModuleType = "all",
) -> dict[str, Table]:
    """Read a log into a table for each message type, in one pass: a telemetry log, a raw stream, or
    a dataflash log, binary or text.

    `types`, `systems`, `start` and `end` are those of `TelemetryLog.messages`; `fields` names the
    fields that become columns. `units="si"` scales values to SI units (angles stay degrees or
    radians), `enums="names"` makes names of enum values. A file ending in gzip or zstd is
    decompressed on the way. Types that are asked for and are not in the log give empty tables.
    `wide=True` gives types with an instance field as `Table.wide` does, a column for each instance.

    Every good record of a damaged log is there. Raises FileNotFoundError and its kin, ValueError
    for a type or field that the dialect, or the dataflash log, does not have.
    """
    path = os.fspath(path)
    check_readable(path)
    module, native = native_dialect(dialect)
    query = Query.of(module, types, systems, fields, start, end, units, enums)
    dataflash = DataflashTables.open(path)
    if dataflash is not None:
        from .dataflash import read_tables

        return read_tables(dataflash, path, query, fields, wide)
    query.check_telemetry()
    check_fields(module, query, fields)
    tables = joined(LogColumns(path, native, query), path)
    for msgid in query.types or ():
        name = module.mavlink_map[msgid].msgname
        if name not in tables:
            tables[name] = tidy(name, no_rows(native, msgid, query), path)
    return {name: table.wide() if wide else table for name, table in sorted(tables.items())}


def joined(columns: LogColumns, path: str) -> dict[str, Table]:
    """The whole tables of a run over a log."""
    pieces: dict[str, list[RecordBatches]] = {}
    for found in columns:
        for name, batches in found:
            pieces.setdefault(name, []).append(batches)
    return {name: tidy(name, RecordBatches.joined(some), path) for name, some in pieces.items()}


def no_rows(native: Any, msgid: int, query: Query) -> RecordBatches:
    """The table of a message that is not in a log; of the wanted columns those that it has."""
    if query.columns is None:
        return empty_table(native, msgid, query)
    every = empty_table(native, msgid, replace(query, columns=None)).names
    columns = [name for name in query.columns if name in every]
    return empty_table(native, msgid, replace(query, columns=columns))


def scan(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    types: str | type | Iterable[str | type] | None = None,
    systems: int | Iterable[int] | None = None,
    fields: str | Iterable[str] | None = None,
    start: float | datetime | None = None,
    end: float | datetime | None = None,
    *,
    units: str | None = None,
    enums: str | None = None,
    dialect: str | ModuleType = "all",
    batch_rows: int = BATCH_ROWS,
) -> Iterator[Table]:
    """Read logs of any size in batches: tables of at most `batch_rows` rows of one type each, with
    `name` and `path`.

    The rows of a type come in the order of the log. Memory stays bounded: what is read ahead does
    not depend on the size of a log. A text column is always followed by `<name>_raw`.
    """
    one = isinstance(paths, str | os.PathLike)
    every = [os.fspath(paths)] if one else [os.fspath(path) for path in paths]  # type: ignore[union-attr, arg-type]
    if batch_rows < 1:
        raise ValueError(f"batch_rows must be at least 1, not {batch_rows}")
    module, native = native_dialect(dialect)
    query = Query.of(module, types, systems, fields, start, end, units, enums)
    if not all(map(is_dataflash, every)):
        query.check_telemetry()
        check_fields(module, query, fields)
    query.batch_rows, query.batch_bytes = batch_rows, BATCH_BYTES
    return _batches(every, native, query)


def _batches(paths: list[str], native: Any, query: Query) -> Iterator[Table]:
    for path in paths:
        check_readable(path)
        for found in open_columns(path, native, query):
            for name, batches in found:
                yield Table(name, batches, path)
