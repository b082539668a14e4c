"""The common columns of one message type in several logs.

Each dataflash log describes its types itself, so logs may have different columns.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from mavwire._native import DataflashTables, RecordBatches

from .checks import check_described, check_tables, no_rows
from .selection import Selection
from .sources import file_status, is_dataflash, open_dataflash

Described = tuple[list[str], RecordBatches | None]
"""The types that a dataflash log describes, and an empty table of the wanted type if it has one."""

MAX_KEPT = 64
"""Number of logs whose surveys are kept, of up to some 200 KB each."""


class Surveys:
    """Surveys of the logs of a scan. The first `MAX_KEPT` are kept for the pass that reads rows."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[tuple[int, int], DataflashTables]] = {}

    def open(self, path: str) -> DataflashTables | None:
        """The survey of a dataflash log; None for another kind of log. Raises LogFormatError as
        `open_dataflash` does.
        """
        status = file_status(path)
        known, tables = self._kept.get(path, (None, None))
        if tables is None or known != status:
            tables = open_dataflash(path, path)
            if tables is not None and len(self._kept) < MAX_KEPT:
                self._kept[path] = status, tables
        return tables


def empty_of(
    paths: list[str], surveys: Surveys, module: Any, native: Any, selection: Selection
) -> RecordBatches:
    """An empty table of the wanted type with the columns of all logs. Raises ValueError as
    `common_columns` does.
    """
    logs = ((path, surveys.open(path) if is_dataflash(path) else None) for path in paths)
    described = ((path, tables and description_of(tables, selection)) for path, tables in logs)
    return common_columns(described, module, native, selection)


def description_of(tables: DataflashTables, selection: Selection) -> Described:
    """The description of the wanted type in a dataflash log. ValueError for arguments that do not suit it."""
    selection.check_dataflash()
    [name] = selection.names or [""]
    names = tables.names
    return names, tables.empty(name, selection) if name in names else None


def common_columns(
    logs: Iterable[tuple[str, Described | None]], module: Any, native: Any, selection: Selection
) -> RecordBatches:
    """An empty table of the wanted type with the columns of all logs. A log is a path and its
    description of the type, which is None for a telemetry log. ValueError if no log can have the type,
    or if columns of one name have no common type.
    """
    return RecordBatches.common(_columns_of_each(logs, module, native, selection))


def _columns_of_each(
    logs: Iterable[tuple[str, Described | None]], module: Any, native: Any, selection: Selection
) -> Iterator[tuple[str, RecordBatches]]:
    names: set[str] = set()
    dataflash = telemetry = found = 0
    for path, described in logs:
        if described is None:
            telemetry += 1
            continue
        dataflash += 1
        names.update(described[0])
        if described[1] is not None:
            found += 1
            yield path, described[1]
    by_dialect = telemetry or not dataflash
    if by_dialect and selection.types:
        yield f"the dialect {module.DIALECT}", no_rows(native, selection.types[0], selection)
    elif not found:
        if by_dialect:
            selection.check_telemetry()
            check_tables(module, native, selection)
        check_described(dict.fromkeys(names, ()), selection, logs=dataflash)
