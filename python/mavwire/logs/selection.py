"""Which messages of a log are wanted: what users write, turned into ids and seconds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from math import isnan
from operator import index
from typing import TYPE_CHECKING, Any, Unpack

from mavwire._text import did_you_mean

from .query import Query, Types

if TYPE_CHECKING:
    from mavwire._native import RecordBatches

DAY = 86_400
YEAR = 31_556_952
"""Seconds; the latter of a mean year of the calendar."""
MAX_SYSTEM = 255
MAX_ID = 0xFFFFFF
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
UNKNOWN = "UNKNOWN"
ID_PREFIX = "MAVLINK_MSG_ID_"
A_TIME = (
    "a time is seconds since 1970, a datetime, a datetime64 or a text such as 2024-01-31T12:00:00"
)
MOST_SECONDS = 1e15
"""Seconds of which a float has no microseconds any more, nor records a time."""


HEADER = ("timestamp", "sysid", "compid", "seq")
"""The columns in front of the fields."""


@dataclass
class Selection:
    """The attributes that `LogColumns` and `Converter` read; None means all."""

    dialect: Any = None
    """The module, for texts."""
    types: list[int] | None = None
    unknown_ids: list[int] | None = None
    """Ids that the dialect lacks, for logs that are rewritten: they have no table."""
    names: list[str] | None = None
    """Record types of dataflash logs."""
    systems: list[int] | None = None
    start: float | None = None
    end: float | None = None
    columns: list[str] | None = None
    predicate: tuple[list[str], Callable[[RecordBatches], RecordBatches]] | None = None
    """Columns, and a function that is given tables with these. It answers with the numbers of the rows that
    are wanted, in a column of a table.
    """
    si: bool = False
    enum_names: bool = False
    invalid: str = "keep"
    """"null" or "keep"."""
    unknown: str | None = None
    """Messages that the dialect does not define: "table" makes a table of them, "ignore" says nothing."""
    csv_safe: bool = False
    """CSV files have an apostrophe in front of texts that a spreadsheet would run as formulas."""
    descriptions: dict[str, tuple[str, dict[str, str]]] | None = None
    """Texts of messages and their fields for the schemas of MCAP files."""
    batch_rows: int | None = None
    batch_bytes: int | None = None
    foreign: dict[str, str] | None = None
    """Types that only dataflash logs can have, and what is wrong with them where a telemetry log is
    read.
    """

    def __getstate__(self) -> dict[str, Any]:
        return vars(self) | {"dialect": None}  # a module cannot be sent to a worker

    @classmethod
    def of(
        cls,
        dialect: Any,
        types: Types = None,
        *,
        systems: int | Iterable[int] | None = None,
        fields: str | Iterable[str] | None = None,
        start: float | str | datetime | None = None,
        end: float | str | datetime | None = None,
        units: str | None = None,
        enums: str | None = None,
        invalid: str | None = None,
        unknown: str | None = None,
    ) -> Selection:
        """From the arguments of `read`; ValueError names one that makes no sense."""
        if units not in (None, "si"):
            raise ValueError(f"units must be None or 'si', not {units!r}")
        if enums not in (None, "names"):
            raise ValueError(f"enums must be None or 'names', not {enums!r}")
        if invalid not in (None, "null", "keep"):
            raise ValueError(f"invalid must be None, 'null' or 'keep', not {invalid!r}")
        if unknown not in (None, "table", "ignore"):
            raise ValueError(f"unknown must be None, 'table' or 'ignore', not {unknown!r}")
        wanted = None if types is None else types_of(types)
        known, foreign = _telemetry_types(dialect, wanted)
        ids, unknown_ids = (None, None) if known is None else ids_of(dialect, known)
        first, behind = seconds_of(start), seconds_of(end)
        if first is not None and behind is not None and first >= behind:
            raise ValueError(f"start is a time before end, not {start!r} with {end!r}")
        return cls(
            dialect=dialect,
            types=ids,
            unknown_ids=None if unknown == "table" else unknown_ids,
            unknown=unknown,
            names=None if wanted is None else [_name_of(one) for one in wanted],
            systems=None if systems is None else [system_of(one) for one in several(systems)],
            start=first,
            end=behind,
            columns=None if fields is None else columns_of(fields),
            si=units == "si",
            enum_names=enums == "names",
            invalid=invalid or ("null" if units == "si" else "keep"),
            foreign=foreign,
        )

    @classmethod
    def of_dataflash(cls, types: Types = None, **query: Unpack[Query]) -> Selection:
        """For a log that is known to be a dataflash log; ValueError as by `of`."""
        selection = cls.of(None, **query)
        if types is not None:
            selection.names = [_name_of(one) for one in types_of(types)]
        return selection

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
        if not is_known and id_of(dialect, one) is None:
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


def separate_fields(query: Query, wide: bool = False) -> list[str] | None:
    """The names of the fields that a query asks for. `wide` tables are read with all columns: one of them
    tells instances apart.
    """
    fields = query.get("fields")
    names = None if fields is None else names_of(fields)
    query["fields"] = None if wide else names
    return names


def ids_of(dialect: Any, types: Iterable[Any]) -> tuple[list[int], list[int] | None]:
    """The ids of some types that the dialect has, and those that it has not; None for all of these."""
    known: set[int] = set()
    unknown: set[int] = set()
    types = list(types)
    for one in types:
        digits = "" if isinstance(one, type) else one.removeprefix(f"{UNKNOWN}_")
        if isinstance(one, type):
            if not isinstance(msgid := getattr(one, "id", None), int):
                raise ValueError(f"{one.__name__} is not a message class")
            known.add(msgid)
        elif digits != one and digits.isdecimal():
            if len(digits.lstrip("0")) > len(str(MAX_ID)) or int(digits) > MAX_ID:
                raise ValueError(f"there is no message {one!r}: ids are 0 to {MAX_ID}")
            unknown.add(int(digits))
        elif (msgid := id_of(dialect, one)) is not None:
            known.add(msgid)
        elif one != UNKNOWN:
            raise ValueError(no_message(dialect, one))
    return sorted(known), None if UNKNOWN in types else sorted(unknown)


def types_of(types: Any) -> list[str | type]:
    """One type or several, names and classes; ValueError for what is neither."""
    wanted: list[str | type] = []
    for one in several(types):
        if not isinstance(one, str | type):
            raise ValueError(f"a type is a name or a message class, not {one!r}")
        wanted.append(one)
    return wanted


def several(values: Any) -> Iterator[Any]:
    """The values of a collection, or the one that was given alone: one by one, so that of very many a
    wrong one is refused before the others take memory.
    """
    if isinstance(values, str | type):
        return iter([values])
    try:
        return iter(values)
    except TypeError:  # of an array without dimensions, too
        return iter([values])


def id_of(dialect: Any, name: object) -> int | None:
    """The id of the message with this name, or of the other layout of an id with this name. None without one:
    BAD_DATA and UNKNOWN are no messages.
    """
    if not isinstance(name, str) or not hasattr(dialect, "MAVLink"):
        return None
    msgid = getattr(dialect, f"{ID_PREFIX}{name}", None)
    try:
        msgid = dialect.MAVLink(None)._dialect.message_class(name).id if msgid is None else msgid
    except KeyError:
        return None
    return msgid if isinstance(msgid, int) and msgid >= 0 else None


def no_message(dialect: Any, name: object) -> str:
    """The error for a message that a dialect does not have."""
    names = [key.removeprefix(ID_PREFIX) for key in vars(dialect) if key.startswith(ID_PREFIX)]
    names = [one for one in names if id_of(dialect, one) is not None]
    hint = did_you_mean(name.upper(), names) if isinstance(name, str) else ""
    return f"the dialect {dialect.DIALECT} has no message {name!r}{hint}"


def system_of(number: Any) -> int:
    """A system id; ValueError for what is none."""
    try:
        system = index(number)
    except TypeError:
        raise ValueError(f"a system id is a number, not {number!r}") from None
    if not 0 <= system <= MAX_SYSTEM:
        raise ValueError(f"a system id is 0 to {MAX_SYSTEM}, not {system}")
    return system


def record_seconds(micros: int) -> float:
    """Seconds of a time in microseconds, rounded as those of records are: another rounding misses
    the record that has exactly this time.
    """
    return micros * 1e-6


def seconds_of(time: Any) -> float | None:
    """Seconds since 1970 of a time as users give it: a number, a datetime, one of NumPy, or a text
    of ISO 8601, which is UTC where it names no zone. ValueError for what is none.
    """
    if time is None:
        return None
    if isinstance(time, str):
        time = _parsed(time)
    if str(time) == "NaT":  # of NumPy or pandas, where it is a datetime too
        raise ValueError(f"{A_TIME}, not NaT")
    if hasattr(time, "to_datetime64"):  # of pandas, without a zone UTC as those of NumPy
        time = time.to_datetime64()
    if isinstance(time, datetime):
        return record_seconds(_micros_of(time))
    if type(time).__name__ == "datetime64":  # of NumPy, as the tables have it
        return record_seconds(int(time.astype("datetime64[us]").astype("int64")))
    try:
        seconds = float(time + 0.0)  # float() alone takes texts too
    except (TypeError, OverflowError):
        seconds = float("nan")
    if isnan(seconds):
        raise ValueError(f"{A_TIME}, not {time!r}")
    # To the microsecond, as records have it: a float of today is a quarter of one off.
    return record_seconds(round(seconds * 1e6)) if abs(seconds) < MOST_SECONDS else seconds


def _micros_of(time: datetime) -> int:
    # Local time where it names no zone. One with a zone may be before or after all that UTC can say.
    if time.utcoffset() is None:
        try:
            time = time.astimezone()
        except (OverflowError, ValueError):  # in the first or last year, far from all records
            time = time.replace(tzinfo=UTC)
    return (time - EPOCH) // timedelta(microseconds=1)


def _parsed(text: str) -> datetime:
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        raise ValueError(f"{A_TIME}, not {text!r}") from None
    return time if time.tzinfo is not None else time.replace(tzinfo=UTC)
