"""Graphs as mavgraph.py draws them: its colours and line styles, local time, shaded flight modes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from mavwire.logs.selection import DAY

from .images import has_dates, printable
from .modes import MOST_SPANS, Span

COLOURS = (
    "red", "green", "blue", "orange", "olive", "black", "grey", "yellow", "brown", "darkcyan",
    "cornflowerblue", "darkmagenta", "deeppink", "darkred",
)  # fmt: skip
"""Of the lines; further ones are red."""
MODE_COLOURS = {
    "STABILIZE": "#80ff00", "ACRO": "#ffff00", "ALT_HOLD": "#ff8080", "AUTO": "#00ff00",
    "GUIDED": "#8080ff", "LOITER": "#0000ff", "RTL": "#ff0080", "CIRCLE": "#80ff80",
    "POSITION": "#ff00ff", "LAND": "#00ff80", "MANUAL": "#ff0000", "FBWA": "#ff8000",
    "CRUISE": "#00ffff", "STEERING": "#8000ff", "HOLD": "#0080ff",
}  # fmt: skip
OTHER_MODE = "#1a1a1a"
PX4_COLOURS = {
    "MANUAL": "#ff0000", "SEATBELT": "#808000", "EASY": "#00ff00", "AUTO": "#0000ff",
    "UNKNOWN": "#ffffff",
}  # fmt: skip
SHADE = 0.1
SIZE = (12.0, 6.0)
"""Inches."""
QUARTER_HOUR = 900


@dataclass(frozen=True)
class Style:
    """How lines and legends look; `over` says that x is no time."""

    legend: str = "upper left"
    legend2: str = "upper right"
    marker: str | None = None
    linestyle: str | None = None
    over: bool = False

    def line(self) -> dict[str, str]:
        """matplotlib's options."""
        marker, line = ("+", "None") if self.over else ("None", "-")
        return {"marker": self.marker or marker, "linestyle": self.linestyle or line}


@dataclass
class Modes:
    """The flight modes of one log; `colours` are those of its kind of autopilot."""

    colours: dict[str, str]
    spans: list[Span] = field(default_factory=list)

    def add(self, stamp: float, mode: str) -> None:
        """The vehicle is in this mode, in seconds since 1970."""
        last = self.spans[-1] if self.spans else None
        if last is not None:
            self.spans[-1] = replace(last, end=stamp)
        if last is None or (mode != last.mode and len(self.spans) < MOST_SPANS):
            self.spans.append(Span(mode, stamp, stamp))


@dataclass
class Line:
    """One line, or one for each element of an array: x in seconds since 1970 or of another field, and
    texts that stand at an x.
    """

    label: str
    right: bool
    colour: str
    x: list[float]
    y: list[float | list[float]]
    texts: list[tuple[float, str]]


@dataclass
class Graph:
    """Lines and shades to draw."""

    style: Style
    lines: list[Line] = field(default_factory=list)
    shades: list[Modes] = field(default_factory=list)

    def add(
        self,
        label: str,
        right: bool,
        colour: int,
        x: list[float],
        y: list[float | list[float]],
        texts: list[tuple[float, str]],
    ) -> None:
        """A line in the colour of this number."""
        name = COLOURS[colour] if colour < len(COLOURS) else COLOURS[0]
        self.lines.append(Line(label, right, name, x, y, texts))

    def modes(self, vehicle: str) -> Modes:
        """The modes of another log; `vehicle` is "px4" or ArduPilot."""
        self.shades.append(Modes(PX4_COLOURS if vehicle == "px4" else MODE_COLOURS))
        return self.shades[-1]


def check(style: Style) -> None:
    """ValueError, in matplotlib's words, for what it does not know."""
    from matplotlib.figure import Figure

    axes: Any = Figure().gca()
    axes.plot([], **style.line())
    for place in (style.legend, style.legend2):
        axes.legend([], [], loc=place)


def draw(figure: Any, graph: Graph) -> None:
    """Draw it into a figure of matplotlib."""
    left = figure.gca()
    right = left.twinx() if any(line.right for line in graph.lines) else None
    shown = _across(left, graph)
    if shown is _local_days:
        for axes in (left, right):
            if axes is not None:
                _use_clock(axes)
    for line in graph.lines:
        _draw_line(right if line.right and right is not None else left, line, graph.style, shown)
    for number, modes in enumerate(graph.shades, 1):
        _shade(left, modes, shown, is_last=number == len(graph.shades))
    if left.get_lines():
        left.legend(loc=graph.style.legend)
    if right is not None and right.get_lines():
        right.legend(loc=graph.style.legend2)


def _across(axes: Any, graph: Graph) -> Callable[[list[float]], Any]:
    """How values of x are shown: times on the local clock, as seconds where calendars end."""
    if graph.style.over:
        return list
    times = [x for line in graph.lines for x in (*line.x, *(x for x, _ in line.texts))]
    times += [x for modes in graph.shades for span in modes.spans for x in (span.start, span.end)]
    if not times or has_dates(min(times), max(times)):
        return _local_days
    axes.set_xlabel("seconds since 1970")
    return list


def _shade(axes: Any, modes: Modes, shown: Callable[[list[float]], Any], is_last: bool) -> None:
    """Flight modes in the background; the last of all reaches to the edge."""
    for number, span in enumerate(modes.spans, 1):
        start, end = shown([span.start, span.end])
        if is_last and number == len(modes.spans):
            end = max(start, axes.get_xlim()[1])
        colour = modes.colours.get(span.mode, OTHER_MODE)
        axes.axvspan(start, end, fc=colour, ec="none", alpha=SHADE)


def _draw_line(axes: Any, line: Line, style: Style, shown: Callable[[list[float]], Any]) -> None:
    if line.x:
        label = printable(line.label)
        axes.plot(shown(line.x), line.y, label=label, color=line.colour, **style.line())
    if line.texts:
        places = axes.get_xaxis_transform()
        for x, (_, text) in zip(shown([x for x, _ in line.texts]), line.texts, strict=True):
            axes.text(
                x, 0.02, f"[{printable(text)}]", rotation=90, transform=places, parse_math=False,
                color=line.colour,
            )  # fmt: skip
            axes.update_datalim([(x, 0.0)], updatey=False)
        axes.autoscale_view(scaley=False)


def _use_clock(axes: Any) -> None:
    from matplotlib.dates import AutoDateLocator, DateFormatter

    axes.xaxis_date()
    axes.xaxis.set_major_locator(AutoDateLocator())
    axes.xaxis.set_major_formatter(DateFormatter("%H:%M:%S"))


def _local_days(seconds: list[float]) -> Any:
    """Days since 1970 on the local clock, which is what matplotlib takes for times."""
    import numpy as np

    stamps = np.asarray(seconds, float)
    blocks, which = np.unique(stamps // QUARTER_HOUR, return_inverse=True)
    offsets = np.array([_offset(float(block) * QUARTER_HOUR) for block in blocks])
    return (stamps + offsets[which]) / DAY


def _offset(stamp: float) -> int:
    """Seconds of the local clock before UTC; clocks change at quarters of an hour."""
    try:
        return time.localtime(stamp).tm_gmtoff
    except (OverflowError, OSError, ValueError):  # a year that the system does not have
        return 0
