"""`plot`: expressions over logs as an image or a page."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mavwire._extras import extra
from mavwire._native import jump_text
from mavwire._text import cannot_write, did_you_mean
from mavwire.dialects import UPSTREAM
from mavwire.logs.no_records import lacking
from mavwire.logs.store import write_file
from mavwire.logs.targets import file_to_write

from .expressions import Expression, parse
from .images import has_dates
from .modes import Span
from .series import LogSeries, message_types, read_series

IMAGES = (".png", ".svg", ".pdf")
PAGES = (".html", ".htm")
AUTOPILOTS = {"apm": 3, "px4": 12}
"""Values of MAV_AUTOPILOT."""


@dataclass
class Line:
    """One line of a chart."""

    label: str
    right: bool
    times: Any
    """Seconds, since 1970 or since the first value, or values of another expression."""
    values: Any


@dataclass
class Chart:
    """Lines and flight modes to draw."""

    title: str
    lines: list[Line]
    modes: list[Span]
    absolute: bool
    """Times are since 1970."""
    across: str = "seconds"
    """The label of an x axis that has no times since 1970."""


@dataclass
class Plotted:
    """The result of `plot`."""

    path: str
    points: int
    notes: list[str]
    """Values that were left out, with the reason, and jumps of times."""


def plot(
    logs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    expressions: str | Sequence[str],
    out: str | os.PathLike[str],
    *,
    labels: Sequence[str] | None = None,
    title: str | None = None,
    condition: str | None = None,
    xaxis: str | None = None,
    system: int | None = None,
    relative: bool = False,
    timeshift: float = 0.0,
    modes: bool = True,
    flightmode: str | None = None,
    dialect: str | os.PathLike[str] = UPSTREAM,
) -> Plotted:
    """Draw expressions such as `ATTITUDE.roll` or `degrees(ATTITUDE.pitch):2` over time.

    Each expression is drawn from the logs that can have its messages, so telemetry and dataflash
    logs may be mixed. `out` ends in .png, .svg or .pdf (needs matplotlib), or in .html. `:2` is the
    axis on the right. `labels` stand in the legend for the expressions. `condition` leaves out
    messages at which it does not hold; `xaxis` is an expression to plot over in the place of time.
    `system` is the vehicle's id, by default the first autopilot that is heard. `relative` counts
    seconds from the first value of each log, so that several can be compared; `timeshift` is added
    to the times of the first log. `modes` shades the flight modes of the first log that is drawn.
    `flightmode` reads those of a telemetry log as modes of ArduPilot ("apm") or PX4 ("px4"). Raises
    OSError for files that cannot be read or written, ImportError where matplotlib is missing,
    ValueError for what cannot be plotted.
    """
    with extra("plot"):
        import numpy  # noqa: F401
    paths = [os.fspath(one) for one in ([logs] if isinstance(logs, str | os.PathLike) else logs)]
    texts = [expressions] if isinstance(expressions, str) else list(expressions)
    out = os.fspath(out)
    _check(paths, texts, out, labels, flightmode)
    _check_times(timeshift, xaxis is not None, relative)
    target = file_to_write(out)
    parsed = [parse(text) for text in texts]
    across = None if xaxis is None else parse(xaxis)
    known = [message_types(path, dialect) for path in paths]
    _check_messages(parsed, known)
    names = labels or [one.text for one in parsed]
    named = [[(n, e) for n, e in zip(names, parsed, strict=True) if e.fits(has)] for has in known]
    read = [
        read_series(
            path,
            [one for _, one in own],
            condition=condition,
            xaxis=across,
            system=system,
            autopilot=None if flightmode is None else AUTOPILOTS[flightmode],
            dialect=dialect,
        )
        if own
        else LogSeries(path, [])
        for path, own in zip(paths, named, strict=True)
    ]
    own_names = [[name for name, _ in own] for own in named]
    chart = _chart(read, own_names, title, relative, float(timeshift), modes, across)
    notes = _notes(read) + ([] if across is not None else _jumps(read))
    points = sum(len(line.times) for line in chart.lines)
    if not points:
        lacks = [f"{said}: {path!r}" for path in paths if (said := lacking(path, dialect))]
        raise ValueError("; ".join(lacks if len(lacks) == len(paths) else lacks + notes))
    write_file(target, _drawn(chart, _suffix(out)))
    return Plotted(out, points, notes)


def _suffix(out: str) -> str:
    return os.path.splitext(out)[1].lower()


def _check(
    paths: list[str],
    texts: list[str],
    out: str,
    labels: Sequence[str] | None,
    flightmode: str | None,
) -> None:
    if _suffix(out) not in IMAGES + PAGES:
        raise ValueError(cannot_write(out, IMAGES + PAGES))
    if not paths or not texts:
        raise ValueError("a plot needs a log and an expression")
    if labels is not None and len(labels) != len(texts):
        raise ValueError(f"{len(texts)} expressions have {len(labels)} labels")
    if flightmode is not None and flightmode not in AUTOPILOTS:
        raise ValueError(f"flightmode is one of {', '.join(AUTOPILOTS)}, not {flightmode!r}")


def _check_messages(expressions: Sequence[Expression], known: Sequence[set[str] | None]) -> None:
    """ValueError for an expression over messages that no log can have."""
    for one in expressions:
        if not any(map(one.fits, known)):
            every = set().union(*filter(None, known))
            needed = sorted({name for name, _, _ in one.places})
            strange = [name for name in needed if name not in every]
            if not strange:
                raise ValueError(f"{one.text}: no log has all of {', '.join(needed)}")
            hint = did_you_mean(strange[0].upper(), every)
            raise ValueError(f"{one.text}: no log has a message {strange[0]!r}{hint}")


def _check_times(timeshift: float, is_over_values: bool, relative: bool) -> None:
    try:
        is_number = math.isfinite(timeshift)
    except (TypeError, OverflowError):
        is_number = False
    if not is_number:
        raise ValueError(f"timeshift is a number of seconds, not {timeshift!r}")
    if is_over_values and (relative or timeshift):
        raise ValueError("over xaxis there are no times: leave relative and timeshift out")


def _drawn(chart: Chart, suffix: str) -> bytes:
    if suffix in PAGES:
        from .pages import chart_page

        return chart_page(chart)
    from .images import chart_image

    return chart_image(chart, suffix.removeprefix("."))


def _chart(
    read: list[LogSeries],
    labels: Sequence[Sequence[str]],
    title: str | None,
    relative: bool,
    timeshift: float,
    modes: bool,
    across: Expression | None,
) -> Chart:
    lines: list[Line] = []
    shown: list[Span] = []
    firsts = [float(one.times[0]) for log in read for one in log.series if len(one.times)]
    if across is None:
        times = [time + shift for time in _bounds(read) for shift in (0.0, timeshift)]
        first, last = min(times, default=0.0), max(times, default=0.0)
        relative = relative or first < 0 or not has_dates(first, last)
    first_drawn = next((number for number, log in enumerate(read) if log.series), 0)
    for number, log in enumerate(read):
        own = [float(one.times[0]) for one in log.series if len(one.times)]
        zero = min(own, default=0.0) if relative else 0.0
        zero -= 0.0 if number else timeshift
        name = f"{os.path.basename(log.path)}: " if len(read) > 1 else ""
        for label, one in zip(labels[number], log.series, strict=True):
            right = one.expression.right
            lines.append(Line(name + label, right, one.times - zero, one.values))
        if modes and number == first_drawn and firsts:
            shown = [Span(s.mode, s.start - zero, s.end - zero) for s in log.modes]
    names = ", ".join(os.path.basename(log.path) for log in read)
    title = names if title is None else title
    if across is not None:
        return Chart(title, lines, [], False, across.text)
    return Chart(title, lines, shown, not relative)


def _bounds(read: list[LogSeries]) -> list[float]:
    filled = [one.times for log in read for one in log.series if len(one.times)]
    return [float(bound) for times in filled for bound in (times.min(), times.max())]


def _jumps(read: list[LogSeries]) -> list[str]:
    """The logs with times that stretch the axis beyond a flight."""
    import numpy as np

    notes = []
    for log in read:
        times = np.sort(np.concatenate([np.empty(0), *(one.times for one in log.series)]))
        if len(times) > 1:
            widest = int(np.diff(times).argmax())
            jump = jump_text(float(times[widest]), float(times[widest + 1]))
            notes += [f"{log.path}: {jump}"] if jump else []
    return notes


def _notes(read: list[LogSeries]) -> list[str]:
    notes = []
    for log in read:
        if not log.series:
            notes.append(f"{log.path}: not drawn: it cannot have the messages of the expressions")
        for one in log.series:
            text = one.expression.text
            if one.left_out:
                notes.append(f"{log.path}: {text}: {one.left_out:,} left out: {one.error}")
            elif not len(one.times):
                why = f": {one.error}" if one.error else ""
                notes.append(f"{log.path}: {text}: there are no values{why}")
            if one.mixed:
                example = f"write {one.mixed}[n] for one of them"
                notes.append(f"{log.path}: {text}: all instances are one line: {example}")
    return notes
