"""`align`: several message types on a common clock, as one wide table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from .common_clock import Span, align_batches
from .selection import HEADER, columns_of, names_of
from .table import Table, by_instance, check_sender


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

    The clock is the times of the type `on`, each once, or ticks from the first row of all to the
    last. `rate` is the span between ticks: "50ms", "1s", seconds, or a timedelta. A tick gets the
    last row at or before it (`method="ffill"`), the one closest to it ("nearest"), or for numbers
    the straight line between its neighbours ("linear", as float64; enum values and bit masks are
    those before). Rows further away than `tolerance` do not count; where none is left there are
    nulls. Several instances of a type are aligned each by itself, as `TYPE[0].field`. The table is
    called `name`. For "linear" read the tables with `invalid="null"`, as `log.align` does.
    ValueError for arguments that make no sense, for a type that several senders sent, and for rows
    without times.
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
    batches = {one: table._batches for one, table in parts.items()}
    clock = None if on is None else tables[on]._batches
    found = align_batches(batches, clock, rate=rate, method=method, tolerance=tolerance)
    path = next((table.path for table in parts.values()), None)
    return Table(name or "+".join(names), found, path)


def check_clock(on: object) -> None:
    """Raise ValueError for what is no message type, whose times could be the clock."""
    if on is not None and not isinstance(on, str):
        raise ValueError(f"on is the name of a message type, not {on!r}")


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
