"""`align`: several message types on a common clock, as one wide table."""

from __future__ import annotations

from datetime import timedelta
from typing import TYPE_CHECKING

from mavwire._native import align_tables

from .query import HEADER, columns_of, names_of
from .table import Table

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

Span = str | float | timedelta
"""A length of time: "50ms", seconds, or a timedelta."""
UNITS = {"us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0}
METHODS = ("ffill", "nearest", "linear")


def align(
    tables: Mapping[str, Table],
    types: str | Iterable[str] | None = None,
    *,
    on: str | None = None,
    rate: Span | None = None,
    method: str = "ffill",
    tolerance: Span | None = None,
    name: str | None = None,
) -> Table:
    """A table with `timestamp` and the fields of each type as `TYPE.field`.

    The clock is the times of the type `on`, each once, or ticks that are `rate` apart ("50ms", "1s",
    seconds, or a timedelta) from the first row of all to the last. A tick gets the last row at or before it
    (`method="ffill"`), the one closest to it ("nearest"), or for numbers the straight line between
    its neighbours ("linear", as float64; enum values and bit masks are those before). Rows further
    away than `tolerance` do not count; where none is left there are nulls. Several instances of a
    type are aligned each by itself, as `TYPE[0].field`. The table is called `name`. For "linear"
    read the tables with `invalid="null"`, as `log.align` does. ValueError for
    arguments that make no sense, for a type that several senders sent, and for rows without times.
    """
    check_clock(on)
    names = names_of(tables if types is None else types)
    missing = [one for one in (*names, *([on] if on else [])) if one not in tables]
    if missing:
        raise ValueError(f"there is no table of {missing[0]!r}")
    for one in {*names, *([on] if on else [])}:
        check_sender(tables[one], "align tables of one, {0} as table.sender{1}")
    parts: dict[str, Table] = {}
    for one in names:
        several = by_instance(tables[one])
        parts |= several if len(several) > 1 else {one: tables[one]}
    clock = None if on is None else tables[on]
    name = name or "+".join(names)
    return aligned(parts, clock, name, rate=rate, method=method, tolerance=tolerance)


def check_clock(on: object) -> None:
    """Raise ValueError for what is no message type, whose times could be the clock."""
    if on is not None and not isinstance(on, str):
        raise ValueError(f"on is the name of a message type, not {on!r}")


def aligned(
    tables: Mapping[str, Table],
    clock: Table | None,
    name: str,
    *,
    rate: Span | None = None,
    method: str = "ffill",
    tolerance: Span | None = None,
) -> Table:
    """`align` where tables of one sender and instance each are at hand, and the clock."""
    if (clock is None) == (rate is None):
        raise ValueError("give either on= (a message type) or rate= (a span of time)")
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, not {method!r}")
    step = None if rate is None else _micros(rate, "rate")
    if step == 0:
        raise ValueError(f"rate must be a microsecond or more, not {rate!r}")
    reach = None if tolerance is None else _micros(tolerance, "tolerance")
    chosen = [(one, table._batches) for one, table in tables.items()]
    ticks = None if clock is None else clock._batches
    path = next((table.path for table in tables.values()), None)
    try:
        return Table(name, align_tables(chosen, ticks, step, method, reach), path)
    except ValueError as error:  # Arrow's, which say first what kind they are of
        raise ValueError(str(error).removeprefix("Invalid argument error: ")) from None


def by_instance(table: Table) -> dict[str, Table]:
    """A table for each instance, as `IMU[0]`, without the column that tells them apart."""
    kept = [column for column in table.columns if column != table.instance_field]
    return {name: part.select(kept) for name, part in table.instances().items()}


def of_fields(
    tables: Mapping[str, Table], fields: str | Iterable[str] | None, *, several: bool
) -> dict[str, Table]:
    """The tables with the columns of some fields and, wanted or not, the one that tells instances
    apart; with `several` only where there are several.
    """
    if fields is None:
        return dict(tables)
    wanted, parts = columns_of(fields), {}
    for name, table in tables.items():
        instance = table.instance_field
        if instance is not None and several and len(table.instances()) < 2:
            instance = None
        # In front, since the first that is marked counts where a type has several.
        front = HEADER if instance is None else (*HEADER, instance)
        kept = dict.fromkeys(column for column in (*front, *wanted) if column in table.columns)
        parts[name] = table.select(list(kept))
    return parts


def possible_columns(table: Table) -> set[str]:
    """The columns, and of telemetry those of raw bytes that there are where a text is no UTF-8."""
    columns = set(table.columns)
    if columns.issuperset(HEADER):
        texts = (name for name, kind in table._batches.types().items() if kind == "Utf8")
        columns.update(f"{name}_raw" for name in texts)
    return columns


def check_sender(table: Table, advice: str) -> None:
    """ValueError where there are several: their rows side by side make values that nobody sent.
    `advice` is what else to do, of the name and a sender.
    """
    senders = sorted(table._batches.senders())
    if len(senders) > 1:
        which = ", ".join(f"{sysid}/{compid}" for sysid, compid in senders[:5])
        more = ", ..." if len(senders) > 5 else ""
        raise ValueError(
            f"{table.name} comes from several senders ({which}{more}): choose one by systems=, or "
            + advice.format(table.name, senders[0])
        )


def _micros(span: Span, what: str) -> int:
    """A span of time as users give it, in microseconds."""
    if type(span).__name__ == "timedelta64":  # of NumPy, as times of tables differ
        span = span.astype("timedelta64[us]").item()  # type: ignore[union-attr]
    if isinstance(span, timedelta):
        span = f"{span // timedelta(microseconds=1)}us"
    # A year would be a number of seconds.
    text = "" if type(span).__name__ == "datetime64" else str(span).strip()
    number, unit = text, "s"
    if isinstance(span, str):
        unit = text.lstrip("0123456789.") or "s"
        number = text.removesuffix(unit)
    try:
        micros = float(number) * UNITS[unit] * 1e6
    except (KeyError, ValueError):
        raise ValueError(
            f"{what} is a span of time such as '50ms', 0.05 or a timedelta, not {span!r}"
        ) from None
    if not 0 <= micros < 2**62:
        raise ValueError(
            f"{what} is a span of time such as '50ms', 0.05 or a timedelta, not {span!r}"
        )
    return round(micros)
