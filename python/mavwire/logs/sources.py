"""Runs over logs of any kind: telemetry logs, raw streams, dataflash logs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavwire._native import Converter, DataflashTables, LogColumns

if TYPE_CHECKING:
    from .query import Query


def is_dataflash(path: str) -> bool:
    """Whether a file begins as a dataflash log, binary or text, does; false for one that cannot be
    read.
    """
    try:
        return DataflashTables.recognises(path)
    except OSError:
        return False


def open_columns(path: str, native: Any, query: Query) -> LogColumns:
    """A run over a log, giving tables; ValueError for what makes no sense with its kind."""
    tables = DataflashTables.open(path)
    if tables is None:
        query.check_telemetry()
        return LogColumns(path, native, query)
    query.check_dataflash()
    return tables.columns(query)


def open_converter(
    path: str, native: Any, query: Query, out: str, file: str, format: str, compression: str
) -> Converter:
    """A run over a log, writing `out/TYPE/file`; ValueError as by `open_columns`."""
    tables = DataflashTables.open(path)
    if tables is None:
        query.check_telemetry()
        return Converter(path, native, query, out, file, format, compression)
    query.check_dataflash()
    return tables.convert(query, out, file, format, compression)
