"""Several tables on a common clock."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import timedelta

from mavwire._native import RecordBatches, align_tables

Span = str | float | timedelta
"""A length of time: "50ms", seconds, or a timedelta."""
UNITS = {"us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0}
METHODS = ("ffill", "nearest", "linear")


def align_batches(
    tables: Mapping[str, RecordBatches],
    clock: RecordBatches | None,
    *,
    rate: Span | None = None,
    method: str = "ffill",
    tolerance: Span | None = None,
) -> RecordBatches:
    """One wide table of tables of one sender and instance each."""
    if (clock is None) == (rate is None):
        raise ValueError("give either on= (a message type) or rate= (a span of time)")
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, not {method!r}")
    step = None if rate is None else _micros(rate, "rate")
    if step == 0:
        raise ValueError(f"rate must be a microsecond or more, not {rate!r}")
    reach = None if tolerance is None else _micros(tolerance, "tolerance")
    try:
        return align_tables([*tables.items()], clock, step, method, reach)
    except ValueError as error:  # Arrow's, which say first what kind they are of
        raise ValueError(str(error).removeprefix("Invalid argument error: ")) from None


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
        micros = -1.0
    if not 0 <= micros < 2**62:
        raise ValueError(
            f"{what} is a span of time such as '50ms', 0.05 or a timedelta, not {span!r}"
        )
    return round(micros)
