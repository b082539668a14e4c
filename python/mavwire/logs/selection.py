"""Which messages of a log are wanted: what users write, turned into ids and seconds."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from math import isnan

from mavwire._wording import did_you_mean

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Self

MAX_SYSTEM = 255
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
UNKNOWN = "UNKNOWN"


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
            made._choose_types(dialect, [types] if isinstance(types, str | type) else types)
        if systems is not None:
            one = isinstance(systems, str) or hasattr(systems, "__index__")
            wanted = [systems] if one else systems
            made.systems = [_system(one) for one in wanted]
        made.start = _seconds(start)
        made.end = _seconds(end)
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
                if unknown is not None:
                    unknown.add(int(one.removeprefix(f"{UNKNOWN}_")))
            else:
                known.add(_named_id(dialect, one))
        self.types = sorted(known)
        self.unknown = None if unknown is None else sorted(unknown)


def _named_id(dialect: Any, name: str) -> int:
    msgid = getattr(dialect, f"MAVLINK_MSG_ID_{name}", None)
    if isinstance(msgid, int) and msgid >= 0:
        return msgid
    raise ValueError(no_message(dialect, name))


def no_message(dialect: Any, name: object) -> str:
    """What to say of a message that a dialect does not have."""
    prefix = "MAVLINK_MSG_ID_"
    names = [key.removeprefix(prefix) for key in vars(dialect) if key.startswith(prefix)]
    hint = did_you_mean(name.upper(), names) if isinstance(name, str) else ""
    return f"the dialect {dialect.DIALECT} has no message {name!r}{hint}"


def _class_id(cls: type) -> int:
    msgid = getattr(cls, "id", None)
    if isinstance(msgid, int):
        return msgid
    raise ValueError(f"{cls.__name__} is not a message class")


def _system(number: int) -> int:
    if not hasattr(number, "__index__"):
        raise ValueError(f"a system id is a number, not {number!r}")
    if not 0 <= number <= MAX_SYSTEM:
        raise ValueError(f"a system id is 0 to {MAX_SYSTEM}, not {number}")
    return number


def record_seconds(micros: int) -> float:
    """Seconds of a time in microseconds, rounded as those of records are: another rounding misses
    the record that has exactly this time.
    """
    return micros * 1e-6


def _seconds(time: Any) -> float | None:
    """Seconds since 1970 of a time as users give it. ValueError for what is none."""
    if time is None:
        return None
    if isinstance(time, datetime):
        return record_seconds((time.astimezone(UTC) - EPOCH) // timedelta(microseconds=1))
    if (
        type(time).__name__ == "datetime64" and str(time) != "NaT"
    ):  # of NumPy, as the tables have it
        return record_seconds(int(time.astype("datetime64[us]").astype("int64")))
    try:
        seconds = float(time + 0.0)  # float() alone takes texts too
    except TypeError:
        seconds = float("nan")
    if not isnan(seconds):
        return seconds
    raise ValueError(f"a time is seconds since 1970, a datetime or a datetime64, not {time!r}")
