"""`decode`: a log or a range of it as tables, a function that can be sent to any worker."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from mavwire._native import RecordBatches, empty_table
from mavwire.logs.query import Query
from mavwire.logs.reading import native_dialect, no_rows
from mavwire.logs.sources import open_columns
from mavwire.logs.table import Table

from .places import ByteRange, Part, located

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from datetime import datetime


def decode(
    path: str | os.PathLike[str],
    byte_range: ByteRange | Part | None = None,
    types: str | Iterable[str] | None = None,
    columns: str | Iterable[str] | None = None,
    *,
    systems: int | Iterable[int] | None = None,
    start: float | datetime | None = None,
    end: float | datetime | None = None,
    units: str | None = None,
    enums: str | None = None,
    dialect: str = "all",
    storage_options: Mapping[str, Any] | None = None,
) -> dict[str, Table]:
    """`{type: table}` of a log, or of the bytes `first, end` of it, which are read like a log. With
    `first, end, stamped` they are part of a telemetry log, whose records have time stamps or not.

    `path` may be a URL that fsspec opens. `columns` are the names of those that are wanted, all if
    None; the other arguments are those of `mavwire.read`. Types that are asked for and are not
    there give empty tables; a text column is always followed by `<name>_raw`. Raises OSError for a
    log that cannot be read, ValueError for arguments that make no sense.
    """
    path = os.fspath(path).removeprefix("file://")
    module, native = native_dialect(dialect)
    query = Query.of(module, types, systems, None, start, end, units, enums)
    if columns is not None:
        wanted = [columns] if isinstance(columns, str) else list(columns)
        if query.foreign is None:  # else the columns are those of dataflash logs
            _check(wanted, module, query)
        query.columns = wanted
    pieces: dict[str, list[RecordBatches]] = {}
    with located(path, byte_range, storage_options) as source:
        for found in open_columns(source, native, query):
            for name, batches in found:
                pieces.setdefault(name, []).append(batches)
    tables = {name: RecordBatches.joined(some) for name, some in pieces.items()}
    for msgid in query.types or ():
        name = module.mavlink_map[msgid].msgname
        if name not in tables:
            tables[name] = no_rows(native, msgid, query)
    return {name: Table(name, tables[name], path) for name in sorted(tables)}


def _check(columns: list[str], module: Any, query: Query) -> None:
    """ValueError names a column that no wanted message has."""
    native = module.MAVLink(None)._dialect
    wanted = module.mavlink_map if query.types is None else query.types
    known = {name for msgid in wanted for name in empty_table(native, msgid, query).names}
    for name in columns:
        if name not in known:
            raise ValueError(f"no wanted message has a column {name!r}")
