"""Which messages of a log are wanted: what users write, turned into ids and seconds."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from math import isnan
from operator import index

from mavwire._text import did_you_mean

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Any, Self

DAY = 86_400
YEAR = 31_556_952
"""Seconds; the latter of a mean year of the calendar."""
MAX_SYSTEM = 255
MAX_ID = 0xFFFFFF
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
UNKNOWN = "UNKNOWN"
_ID = "MAVLINK_MSG_ID_"
A_TIME = (
    "a time is seconds since 1970, a datetime, a datetime64 or a text such as 2024-01-31T12:00:00"
)
MOST_SECONDS = 1e15
"""Seconds of which a float has no microseconds any more, nor records a time."""


class Selection:
    """Known message ids, unknown ones, system ids and a span of time; None stands for all."""

    def __init__(self) -> None:
        self.types: list[int] | None = None
        self.unknown: list[int] | None = None
        self.systems: list[int] | None = None
        self.start: float | None = None
        self.end: float | None = None

    @classmethod
    def of(cls, dialect: Any, types: Any, systems: Any, start: Any, end: Any) -> Self:
        """From the arguments of `TelemetryLog.messages`."""
        made = cls()
        if types is not None:
            made._choose_types(dialect, types_of(types))
        if systems is not None:
            made.systems = [system_of(one) for one in several(systems)]
        made.start = seconds_of(start)
        made.end = seconds_of(end)
        if made.start is not None and made.end is not None and made.start >= made.end:
            raise ValueError(f"start is a time before end, not {start!r} with {end!r}")
        return made

    def _choose_types(self, dialect: Any, types: Iterable[Any]) -> None:
        known: set[int] = set()
        unknown: set[int] | None = set()
        for one in types:
            if isinstance(one, type):
                known.add(_class_id(one))
            elif one == UNKNOWN:
                unknown = None
            elif one.startswith(f"{UNKNOWN}_") and one.removeprefix(f"{UNKNOWN}_").isdecimal():
                number = _unknown_id(one)
                if unknown is not None:
                    unknown.add(number)
            else:
                known.add(_named_id(dialect, one))
        self.types = sorted(known)
        self.unknown = None if unknown is None else sorted(unknown)


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


def _named_id(dialect: Any, name: str) -> int:
    if has_message(dialect, name):
        return int(getattr(dialect, _ID + name))
    raise ValueError(no_message(dialect, name))


def has_message(dialect: Any, name: object) -> bool:
    """Whether there is a message of this name; BAD_DATA and UNKNOWN have negative ids, and are none."""
    msgid = getattr(dialect, f"{_ID}{name}", None) if isinstance(name, str) else None
    return isinstance(msgid, int) and msgid >= 0


def _unknown_id(name: str) -> int:
    digits = name.removeprefix(f"{UNKNOWN}_").lstrip("0") or "0"
    if len(digits) > len(str(MAX_ID)) or int(digits) > MAX_ID:
        raise ValueError(f"there is no message {name!r}: ids are 0 to {MAX_ID}")
    return int(digits)


def no_message(dialect: Any, name: object) -> str:
    """What to say of a message that a dialect does not have."""
    names = [key.removeprefix(_ID) for key in vars(dialect) if key.startswith(_ID)]
    names = [one for one in names if has_message(dialect, one)]
    hint = did_you_mean(name.upper(), names) if isinstance(name, str) else ""
    return f"the dialect {dialect.DIALECT} has no message {name!r}{hint}"


def _class_id(cls: type) -> int:
    msgid = getattr(cls, "id", None)
    if isinstance(msgid, int):
        return msgid
    raise ValueError(f"{cls.__name__} is not a message class")


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
