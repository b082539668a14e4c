"""What to read into tables: what users write, turned into what the native reader takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from mavwire._native import empty_table
from mavwire._text import did_you_mean

from .selection import UNKNOWN, Selection, has_message, no_message, several, types_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from datetime import datetime

    from mavwire._native import RecordBatches

HEADER = ("timestamp", "sysid", "compid", "seq")
"""The columns in front of the fields."""


@dataclass
class Query:
    """The attributes that `LogColumns` and `Converter` read; None stands for all."""

    types: list[int] | None = None
    unknown: list[int] | None = None
    """Ids that the dialect lacks, for logs that are rewritten: they have no table."""
    names: list[str] | None = None
    """Record types of dataflash logs."""
    systems: list[int] | None = None
    start: float | None = None
    end: float | None = None
    columns: list[str] | None = None
    si: bool = False
    enum_names: bool = False
    invalid: str = "keep"
    """"null" or "keep"."""
    csv_safe: bool = False
    """CSV files have an apostrophe in front of texts that a spreadsheet would run as formulas."""
    untimed: bool = False
    """Records without times are wanted whatever `start` and `end` are; else that is an error."""
    batch_rows: int | None = None
    batch_bytes: int | None = None
    foreign: dict[str, str] | None = None
    """Types that only dataflash logs can have, and what is wrong with them where a telemetry log is
    read.
    """

    @classmethod
    def of(
        cls,
        dialect: Any,
        types: str | type | Iterable[str | type] | None = None,
        systems: int | Iterable[int] | None = None,
        fields: str | Iterable[str] | None = None,
        start: float | str | datetime | None = None,
        end: float | str | datetime | None = None,
        units: str | None = None,
        enums: str | None = None,
        invalid: str | None = None,
    ) -> Query:
        """From the arguments of `read`; ValueError names one that makes no sense."""
        if units not in (None, "si"):
            raise ValueError(f"units must be None or 'si', not {units!r}")
        if enums not in (None, "names"):
            raise ValueError(f"enums must be None or 'names', not {enums!r}")
        if invalid not in (None, "null", "keep"):
            raise ValueError(f"invalid must be None, 'null' or 'keep', not {invalid!r}")
        wanted = None if types is None else types_of(types)
        known, foreign = _telemetry_types(dialect, wanted)
        selection = Selection.of(dialect, known, systems, start, end)
        return cls(
            types=selection.types,
            unknown=selection.unknown,
            names=None if wanted is None else [_name_of(one) for one in wanted],
            systems=selection.systems,
            start=selection.start,
            end=selection.end,
            columns=None if fields is None else columns_of(fields),
            si=units == "si",
            enum_names=enums == "names",
            invalid=invalid or ("null" if units == "si" else "keep"),
            foreign=foreign,
        )

    @classmethod
    def of_dataflash(
        cls,
        types: str | type | Iterable[str | type] | None = None,
        systems: int | Iterable[int] | None = None,
        fields: str | Iterable[str] | None = None,
        start: float | str | datetime | None = None,
        end: float | str | datetime | None = None,
        units: str | None = None,
        enums: str | None = None,
        invalid: str | None = None,
    ) -> Query:
        """For a log that is known to be a dataflash log; ValueError as by `of`."""
        query = cls.of(None, None, systems, fields, start, end, units, enums, invalid)
        if types is not None:
            query.names = [_name_of(one) for one in types_of(types)]
        return query

    def check_telemetry(self) -> None:
        """Raise ValueError for types that no telemetry log has."""
        for reason in (self.foreign or {}).values():
            raise ValueError(reason)

    def allow(self, described: Iterable[str]) -> None:
        """Some types are those of dataflash logs that are read too: no error beside them."""
        left = {name: why for name, why in (self.foreign or {}).items() if name not in described}
        self.foreign = left or None

    def check_dataflash(self) -> None:
        """Raise ValueError for what makes no sense with a dataflash log."""
        if self.systems is not None:
            raise ValueError("a dataflash log is of one system: leave systems= out")


def _name_of(one: str | type) -> str:
    return one if isinstance(one, str) else str(getattr(one, "msgname", one.__name__))


def _telemetry_types(
    dialect: Any, types: list[Any] | None
) -> tuple[list[Any] | None, dict[str, str] | None]:
    """The types without those that only a dataflash log can have, and what to say of these where a
    telemetry log is read.
    """
    if types is None:
        return None, None
    known: list[Any] = []
    foreign: dict[str, str] = {}
    for one in types:
        is_known = not isinstance(one, str) or one.startswith(UNKNOWN)
        if not is_known and not has_message(dialect, one):
            foreign[one] = no_message(dialect, one)
        else:
            known.append(one)
    return known, foreign or None


def columns_of(fields: str | Iterable[str]) -> list[str]:
    """The columns of some fields: those in front, and what a field's own column may be called."""
    columns = list(HEADER)
    for name in names_of(fields):
        columns += [f"{name}_" if name in HEADER else name, f"{name}_raw"]
    return list(dict.fromkeys(columns))


def names_of(names: str | Iterable[str]) -> list[str]:
    """One name or several, those of a set by the alphabet; ValueError for what is none."""
    every: list[str] = []
    for one in several(names):
        if not isinstance(one, str):
            raise ValueError(f"a name is a text, not {one!r}")
        every.append(one)
    return sorted(every) if isinstance(names, set | frozenset) else every


def check_tables(
    dialect: Any, native: Any, query: Query, fields: str | Iterable[str] | None = None
) -> None:
    """Raise ValueError for types that are in no table, and for a field that none of the wanted
    messages has.
    """
    for name in query.names or ():
        if name == UNKNOWN or name.startswith(f"{UNKNOWN}_"):
            raise ValueError("messages with ids that the dialect does not have are in no table")
    if fields is None:
        return
    classes = dialect.mavlink_map
    every = replace(query, columns=None)
    known = set(HEADER)
    for msgid in classes if query.types is None else query.types:
        known.update(classes[msgid].fieldnames, empty_table(native, msgid, every).names)
    for name in names_of(fields):
        if name not in known:
            raise ValueError(f"no wanted message has a field {name!r}")


def check_described(
    described: Mapping[str, Iterable[str]],
    query: Query,
    fields: str | Iterable[str] | None = None,
    logs: int = 1,
) -> None:
    """Raise ValueError for a record type that is not among those that so many dataflash logs describe,
    and for a field that none of the wanted ones has.
    """
    for name in query.names or ():
        if name not in described:
            raise ValueError(no_record_type(name, described, logs))
    if fields is None:
        return
    check_fields({one for name in query.names or described for one in described[name]}, fields)


def no_record_type(name: object, described: Iterable[str], logs: int = 1) -> str:
    """The error for a record type that so many dataflash logs do not describe."""
    hint = did_you_mean(name.upper(), described) if isinstance(name, str) else ""
    if logs == 1:
        return f"the log describes no record type {name!r}{hint}"
    return f"none of the {logs:,} logs describes a record type {name!r}{hint}"


def no_rows(native: Any, msgid: int, query: Query) -> RecordBatches:
    """An empty table of a message, with those of the wanted columns that it has."""
    if query.columns is None:
        return empty_table(native, msgid, query)
    every = empty_table(native, msgid, replace(query, columns=None)).names
    columns = [name for name in query.columns if name in every]
    return empty_table(native, msgid, replace(query, columns=columns))


def check_fields(columns: set[str], fields: str | Iterable[str]) -> None:
    """Raise ValueError for a field that none of the columns of the wanted types is of."""
    for field in names_of(fields):
        if columns.isdisjoint({field, *columns_of(field)[len(HEADER) :]}):
            raise ValueError(f"no wanted type has a field {field!r}")
