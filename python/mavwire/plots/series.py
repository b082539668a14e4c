"""The values of expressions over a log, and the flight modes meanwhile."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite, nan
from typing import Any

from mavwire._text import in_words
from mavwire.dialects import UPSTREAM
from mavwire.expression import evaluate_expression
from mavwire.links.recognise import log_kind
from mavwire.logs.selection import system_of
from mavwire.logs.sources import decompressed
from mavwire.logs.table import Table

from .expressions import Expression, Places, as_number, column_of, read_by, why_nothing
from .modes import Span, mode_changes, spans, vehicle_of

NO_NUMBER = "no number"
NO_VALUE = "the value means unknown, as 65535 often does"


@dataclass
class Series:
    """One expression over one log: arrays of seconds since 1970, or of what the x axis has in their
    place, and of values, all finite.
    """

    expression: Expression
    times: Any
    values: Any
    left_out: int = 0
    """Messages at which it failed or was no number."""
    error: str | None = None
    """How it failed first, or why there is no value."""
    mixed: str | None = None
    """A type of which the line has the values of several instances."""


@dataclass
class LogSeries:
    """The lines of one log."""

    path: str
    series: list[Series]
    modes: list[Span] = field(default_factory=list)


def read_series(
    path: str,
    expressions: Sequence[Expression],
    *,
    condition: str | None = None,
    xaxis: Expression | None = None,
    system: int | None = None,
    autopilot: int | None = None,
    dialect: str | os.PathLike[str] = UPSTREAM,
) -> LogSeries:
    """The series of a log, in the order of the expressions.

    `condition` leaves out messages at which it does not hold. The values of `xaxis` stand in the
    place of times. `system` is the vehicle's, by default the first autopilot that is heard and
    sends what is drawn; `autopilot` is whose flight modes a telemetry log has, in the place of what
    it says itself. Raises OSError for a log that cannot be read. ValueError is for a file that is
    not a log, a log without times, and a field or type that its definitions do not have.
    """
    system = None if system is None else system_of(system)
    how = _How(condition, xaxis, system, dialect)
    if not is_telemetry(path):
        return _of_messages(path, expressions, how)
    from mavwire.logs import DataflashLog, open_log

    log = open_log(path, dialect=dialect)  # says what the file is, if it is no telemetry log
    if isinstance(log, DataflashLog):  # compressed, or under a name of another kind
        with decompressed(path) as copy:
            return replace(_of_messages(copy, expressions, how), path=path)
    quick = condition is None and xaxis is None
    plain = [one for one in expressions if one.plain and quick]
    tables = _tables(path, plain, dialect)
    heartbeats = tables["HEARTBEAT"]
    if system is None:
        shown = (table for name, table in tables.items() if name != "HEARTBEAT")
        system = vehicle_of(heartbeats, shown) or busiest_system(path, dialect)
    found = {one: _from_table(one, tables[one.type], system) for one in plain}
    other = [one for one in expressions if one not in found]
    if other:
        with decompressed(path) as copy:
            made, _ = _from_messages(copy, other, replace(how, system=system))
        found.update(zip(other, made, strict=True))
    series = [found[one] for one in expressions]
    changes = mode_changes(heartbeats, system, autopilot)
    return LogSeries(path, series, spans(changes, _end(series)))


@dataclass(frozen=True)
class _How:
    """How messages are evaluated."""

    condition: str | None
    xaxis: Expression | None
    system: int | None
    dialect: str | os.PathLike[str]

    @cached_property
    def native(self) -> Any:
        """The native dialect, which is loaded once and only for telemetry."""
        from mavwire.logs.reading import native_dialect

        return native_dialect(self.dialect)[1]


def is_telemetry(path: str) -> bool:
    """Whether it is to be read as a telemetry log; OSError for what cannot be read at all."""
    from mavwire.logs.reading import check_readable

    check_readable(path)
    csv = path.lower().endswith(".csv")
    kind = log_kind(path, readonly=True)
    return not csv and (kind is None or not kind.is_dataflash)


def message_types(path: str, dialect: str | os.PathLike[str]) -> set[str] | None:
    """The types that a log can have: those of the dialect, or those that a dataflash log describes.
    None where neither tells. Raises as `read_series` does.
    """
    from mavwire.logs.reading import native_dialect
    from mavwire.logs.sources import describes, open_dataflash

    stamped = is_telemetry(path)
    tables = open_dataflash(path, path)
    if tables is not None:
        return set(tables.names) if describes(tables) else None
    module, _ = native_dialect(dialect)
    return {cls.msgname for cls in module.mavlink_map.values()} if stamped else None


def _end(series: Sequence[Series]) -> float | None:
    return max((float(one.times.max()) for one in series if len(one.times)), default=None)


# -- columns


def _tables(
    path: str, plain: Sequence[Expression], dialect: str | os.PathLike[str]
) -> dict[str, Table]:
    import numpy as np

    from mavwire.logs import read
    from mavwire.logs.reading import native_dialect

    module, native = native_dialect(dialect)
    known = {cls.msgname: cls for cls in module.mavlink_map.values()}
    fields = {"type", "autopilot", "base_mode", "custom_mode"}
    for one in plain:
        for name in one.fields() if one.type in known else ():
            if name not in known[one.type].fieldnames:
                raise ValueError(f"{one.text}: {one.type} has no field {name!r}")
        fields |= one.fields()
        if one.type in known:
            fields |= _instance_fields(native, known[one.type].id)
    types = sorted({"HEARTBEAT", *(one.type for one in plain)})
    tables = read(path, types, fields=sorted(fields), invalid="null", dialect=dialect)
    filled = [table for table in tables.values() if len(table)]
    if filled and all(bool(np.isnat(table["timestamp"]).all()) for table in filled):
        raise ValueError(f"a raw stream without a clock has no times to plot over: {path!r}")
    return tables


def _instance_fields(native: Any, msgid: int) -> set[str]:
    """The field that tells the instances of a message type apart, if it has any."""
    from mavwire._native import empty_table
    from mavwire.logs.selection import Selection
    from mavwire.logs.table import Table

    name = Table("", empty_table(native, msgid, Selection())).instance_field
    return set() if name is None else {name}


def busiest_system(path: str, dialect: str | os.PathLike[str]) -> int | None:
    """The system that most messages of a telemetry log come from."""
    from mavwire.logs import open_log

    counts: dict[int, int] = {}
    for (system, _), sender in open_log(path, dialect=dialect).info().senders.items():
        counts[system] = counts.get(system, 0) + sender.count.messages
    return max(counts, key=lambda one: counts[one], default=None)


def _from_table(one: Expression, table: Table, system: int | None) -> Series:
    """A plain expression over its table."""
    import numpy as np

    rows = slice(None) if system is None else table["sysid"] == system
    lacking = False

    def column(name: str) -> Any:
        nonlocal lacking
        values = table[column_of(name)][rows]
        if values.dtype.kind not in "iuf":
            raise ValueError(f"{one.text}: {name} holds texts, which cannot be plotted")
        marked = "invalid" in table.metadata.get(column_of(name), {})
        values = values.astype(np.float64)
        lacking = lacking or (marked and bool(np.isnan(values).any()))
        return values

    values = np.asarray(one.over(column))
    if values.ndim > 1:
        raise ValueError(f"{one.text} is an array: name an element, as in {one.text}[0]")
    stamps = table["timestamp"][rows]
    times = stamps.astype("int64") * 1e-6
    good = np.isfinite(values) & ~np.isnat(stamps)
    left_out = int(np.count_nonzero(~good))
    error = (NO_VALUE if lacking else NO_NUMBER) if left_out else None
    instances = table[table.instance_field][rows] if table.instance_field else values[:0]
    mixed = one.type if len(instances) and bool((instances != instances[0]).any()) else None
    return Series(one, times[good], values[good], left_out, error, mixed)


# -- messages


def _of_messages(path: str, expressions: Sequence[Expression], how: _How) -> LogSeries:
    made, changes = _from_messages(path, expressions, how)
    return LogSeries(path, made, spans(changes, _end(made)))


def _from_messages(
    path: str, expressions: Sequence[Expression], how: _How
) -> tuple[list[Series], list[tuple[float, str]]]:
    """Evaluate at each message, with the newest messages of the vehicle; and the modes it was in."""
    collectors = [_Collector(one, how) for one in expressions]
    wanted: dict[str, list[_Collector]] = {}
    for one in collectors:
        for name in one.expression.types:
            wanted.setdefault(name, []).append(one)
    changes: list[tuple[float, str]] = []
    messages: dict[str, Any] = {}
    condition_places = read_by(how.condition)[1]
    types = [*wanted, *(how.xaxis.types if how.xaxis is not None else ()), "MODE"]
    for msg, link in vehicle_messages(path, types, how.system, how.dialect):
        time = time_of(msg)
        if isfinite(time) and (not changes or changes[-1][1] != link.flightmode):
            changes.append((time, link.flightmode))
        kind, messages = msg.get_type(), link.messages
        if kind not in wanted or not _holds(how, condition_places, link):
            continue
        for one in wanted[kind]:
            one.take(msg, kind, messages)
    return [one.series(messages) for one in collectors], changes


def _holds(how: _How, places: Places, link: Any) -> bool:
    """Whether the condition, which reads some places, holds now. ValueError names one that cannot be
    evaluated.
    """
    try:
        holds = bool(link.check_condition(how.condition))
    except Exception as error:  # functions of expressions raise errors of any type
        raise ValueError(f"the condition {how.condition!r}: {in_words(error)}") from error
    return holds and not lacks_value(places, link.messages, how)


def lacks_value(places: Places, messages: Mapping[str, Any], how: _How) -> bool:
    """Whether one of some fields holds an invalid value."""
    for kind, name, index in places:
        msg = messages.get(kind)
        if msg is None or hasattr(msg, "fmt"):  # a dataflash log has no such values
            continue
        marks = how.native.invalid_fields(bytes(msg.get_msgbuf())).get(name, [])
        if index is None and marks and all(marks):
            return True
        if index is not None and index < len(marks) and marks[index]:
            return True
    return False


def vehicle_messages(
    path: str, types: list[str], system: int | None, dialect: str | os.PathLike[str]
) -> Iterator[tuple[Any, Any]]:
    """The vehicle's messages of some types as mavutil gives them, with the link."""
    from mavwire._log_link import definitions, open_link
    from mavwire.logs.dialect import dialect_module

    dialect_module(dialect)  # a ValueError names one that there is not
    with definitions(os.fspath(dialect)), closing(open_link(os.fspath(path))) as link:
        telemetry = hasattr(link, "mav")
        if telemetry and system is not None:
            link.sysid = system
        while (msg := link.recv_match(type=types)) is not None:
            if not telemetry or msg.get_srcSystem() == link.sysid:
                yield msg, link


class _Collector:
    """Gathers the values of one expression."""

    def __init__(self, expression: Expression, how: _How) -> None:
        self.expression = expression
        self._xaxis = how.xaxis
        self._condition = how.condition
        self._how = how
        self._times: list[float] = []
        self._values: list[float] = []
        self._failed = 0
        self._error: str | None = None
        self._instances: dict[str, Any] = {}
        """The first instance of each type that came."""
        self._mixed: str | None = None

    def take(self, msg: Any, kind: str, messages: dict[str, Any]) -> None:
        """The vehicle has sent a message that the expression names."""
        instance = self.expression.instances.get(kind)
        if instance is not None and not is_instance(msg, instance):
            return
        if instance is None and self._instances.setdefault(kind, instance_of(msg)) != instance_of(
            msg
        ):
            self._mixed = kind
        try:
            number = self._number(self.expression, messages)
            place = time_of(msg) if self._xaxis is None else self._number(self._xaxis, messages)
        except Exception as error:  # functions of expressions raise errors of any type
            self._failed += 1
            self._error = self._error or in_words(error)
            return
        if number is None or place is None:
            return
        if not (isfinite(number) and isfinite(place)):
            self._failed += 1
            self._error = self._error or NO_NUMBER
            return
        self._times.append(place)
        self._values.append(number)

    def _number(self, expression: Expression, messages: dict[str, Any]) -> float | None:
        if lacks_value(expression.places, messages, self._how):
            self._error = self._error or NO_VALUE
            return nan
        return _number(expression, messages)

    def series(self, messages: dict[str, Any]) -> Series:
        """The gathered values. Without any, the newest messages tell why."""
        import numpy as np

        if not self._times and self._error in (None, NO_NUMBER, NO_VALUE):
            why = why_nothing(self.expression.text, messages, self._condition)
            if why is None and self._xaxis is not None:
                why = why_nothing(self._xaxis.text, messages)
            self._error = why or self._error
        times, values = np.array(self._times, float), np.array(self._values, float)
        return Series(self.expression, times, values, self._failed, self._error, self._mixed)


def _number(expression: Expression, messages: dict[str, Any]) -> float | None:
    """The value of an expression now, which may be no number; None before its messages were heard,
    and where its condition does not hold.
    """
    value = evaluate_expression(expression.text, messages)
    if value is None and not expression.conditional and expression.types <= messages.keys():
        return nan  # as of a division by zero
    return None if value is None else as_number(value)


def time_of(msg: Any) -> float:
    """When a message came; NaN in front of the first clock of a raw stream."""
    time: float = msg._timestamp
    return time if time or hasattr(msg, "fmt") else nan


def is_instance(msg: Any, number: int) -> bool:
    """Whether a message is of one instance; True for types without."""
    return instance_of(msg) in (None, number)


def instance_of(msg: Any) -> Any:
    """Which instance a message is of; None for types without."""
    fmt = getattr(msg, "fmt", None)
    name = fmt.instance_field if fmt is not None else getattr(msg, "_instance_field", None)
    return None if name is None else getattr(msg, name, None)
