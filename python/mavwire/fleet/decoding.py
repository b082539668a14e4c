"""`decode`: a log or a range of it as tables, a function that can be sent to any worker."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any, Unpack

from mavwire._native import DataflashTables, RecordBatches
from mavwire.dialects import UPSTREAM
from mavwire.logs.checks import check_described, check_tables
from mavwire.logs.query import Values, takes
from mavwire.logs.reading import check_records, joined, native_dialect, with_empty
from mavwire.logs.selection import Selection, names_of
from mavwire.logs.sources import Source, columns_from, describes, open_dataflash
from mavwire.logs.table import Table

from .places import ByteRange, Part, check_divisible, located


@takes(Values)
def decode(
    path: str | os.PathLike[str],
    byte_range: ByteRange | Part | None = None,
    types: str | Iterable[str] | None = None,
    columns: str | Iterable[str] | None = None,
    *,
    dialect: str | os.PathLike[str] = UPSTREAM,
    storage_options: Mapping[str, Any] | None = None,
    **query: Unpack[Values],
) -> dict[str, Table]:
    """`{type: table}` of a log, or of the bytes `first, end` of it, which are read like a log. With
    `first, end, stamped` they are part of a telemetry log, whose records have time stamps or not.

    `path` may be a URL that fsspec opens. `columns` are the names of those that are wanted, in
    their order, all if None; the other arguments are those of `mavwire.read`. Types that are asked
    for and are not there give empty tables; a text column is always followed by `<name>_raw`.
    Raises OSError for a log that cannot be read. LogFormatError is for a file that is not a log,
    and for a range of a compressed or dataflash log that needs bytes in front of it; ValueError for
    arguments that make no sense, and for types and columns that a dataflash log does not describe.
    """
    wanted = selection_of(types, columns, dialect, **query)
    return decoded(path, byte_range, *wanted, storage_options)


def decoded(
    path: str | os.PathLike[str],
    byte_range: ByteRange | Part | None,
    module: Any,
    native: Any,
    selection: Selection,
    storage_options: Mapping[str, Any] | None,
    *,
    lenient: bool = False,
) -> dict[str, Table]:
    """`decode`; where it is `lenient`, types and columns that a dataflash log does not describe are
    left out: other logs of a fleet may have them.
    """
    path = os.fsdecode(path).removeprefix("file://")
    if lenient:
        selection.allow(selection.names or ())
    with located(path, byte_range, storage_options) as source:
        described = _described(source, path, byte_range, storage_options)
        run = columns_from(described, source, native, selection)
        if described is None and not lenient:
            check_tables(module, native, selection, selection.columns)
        elif described is not None and not lenient:
            check_described(described.types(), selection, selection.columns)
        found = joined(run)
        if described is None:
            with_empty(found, module, native, selection)
        else:
            _add_empty(found, described, selection)
        if byte_range is None and described is None:
            check_records(run, path, selection, source)
    return {name: Table(name, found[name], path) for name in sorted(found)}


def selection_of(
    types: str | Iterable[str] | None,
    columns: str | Iterable[str] | None,
    dialect: str | os.PathLike[str],
    storage_options: object = None,
    **query: Unpack[Values],
) -> tuple[Any, Any, Selection]:
    """The module of the dialect, its native form, and the selection for the arguments of `decode`."""
    module, native = native_dialect(dialect)
    selection = Selection.of(module, types, **query)
    selection.columns = None if columns is None else names_of(columns)
    return module, native, selection


def _described(
    source: Source,
    path: str,
    byte_range: ByteRange | Part | None,
    storage_options: Mapping[str, Any] | None,
) -> DataflashTables | None:
    """The survey of a dataflash log or of a range of one; None for a telemetry log. LogFormatError
    if it describes no records, and for a range that cannot be read by itself.
    """
    if byte_range is None or not byte_range[0]:
        return open_dataflash(source, path)
    opened = DataflashTables.read(source)
    if opened is None or not describes(opened[0]):
        check_divisible(path, storage_options)
    return None if opened is None else opened[0]


def _add_empty(
    found: dict[str, RecordBatches], described: DataflashTables, selection: Selection
) -> None:
    known = described.types()
    for name in selection.names or ():
        if name not in found and name in known:
            found[name] = described.empty(name, selection)
