"""Checks that logs have what is asked for, and the errors where they do not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from mavwire._native import RecordBatches, empty_table
from mavwire._text import did_you_mean

from .selection import HEADER, UNKNOWN, Selection, columns_of, names_of


def check_tables(
    dialect: Any, native: Any, selection: Selection, fields: str | Iterable[str] | None = None
) -> None:
    """Raise ValueError for types that are in no table, and for a field that none of the wanted
    messages has.
    """
    for name in selection.names or ():
        if name == UNKNOWN or name.startswith(f"{UNKNOWN}_"):
            raise ValueError("messages with ids that the dialect does not have are in no table")
    if fields is None:
        return
    known = fields_of(dialect, native, selection)
    for name in names_of(fields):
        if name not in known:
            raise ValueError(f"no wanted message has a field {name!r}")


def fields_of(dialect: Any, native: Any, selection: Selection) -> set[str]:
    """The fields and columns of the wanted messages of a dialect."""
    classes = dialect.mavlink_map
    every = replace(selection, columns=None)
    known = set(HEADER)
    for msgid in classes if selection.types is None else selection.types:
        known.update(classes[msgid].fieldnames, empty_table(native, msgid, every).names)
    return known


def check_described(
    described: Mapping[str, Iterable[str]],
    selection: Selection,
    fields: str | Iterable[str] | None = None,
    logs: int = 1,
) -> None:
    """Raise ValueError for a record type that is not among those that so many dataflash logs describe,
    and for a field that none of the wanted ones has.
    """
    for name in selection.names or ():
        if name not in described:
            raise ValueError(no_record_type(name, described, logs))
    if fields is None:
        return
    check_fields({one for name in selection.names or described for one in described[name]}, fields)


def no_record_type(name: object, described: Iterable[str], logs: int = 1) -> str:
    """The error for a record type that so many dataflash logs do not describe."""
    hint = did_you_mean(name.upper(), described) if isinstance(name, str) else ""
    if logs == 1:
        return f"the log describes no record type {name!r}{hint}"
    return f"none of the {logs:,} logs describes a record type {name!r}{hint}"


def no_rows(native: Any, msgid: int, selection: Selection) -> RecordBatches:
    """An empty table of a message, with those of the wanted columns that it has."""
    if selection.columns is None:
        return empty_table(native, msgid, selection)
    every = empty_table(native, msgid, replace(selection, columns=None)).names
    columns = [name for name in selection.columns if name in every]
    return empty_table(native, msgid, replace(selection, columns=columns))


def check_fields(columns: set[str], fields: str | Iterable[str]) -> None:
    """Raise ValueError for a field that none of the columns of the wanted types is of."""
    for field in names_of(fields):
        if columns.isdisjoint({field, *columns_of(field)[len(HEADER) :]}):
            raise ValueError(f"no wanted type has a field {field!r}")
