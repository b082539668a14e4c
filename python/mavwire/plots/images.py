"""Charts as images, drawn by matplotlib."""

from __future__ import annotations

import io
import warnings
from typing import TYPE_CHECKING, Any

from mavwire.logs.selection import YEAR

from .modes import colours_of

if TYPE_CHECKING:
    from .charts import Chart

LINES = (
    "#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#8c564b", "#e377c2",
    "#bcbd22", "#7f7f7f",
)  # fmt: skip
SIZE = (12.0, 6.5)
"""Inches."""
YEAR_1, YEAR_10000 = -62_135_596_800, 253_402_300_800
"""Seconds since 1970 at which calendars begin, and end."""


def has_dates(first: float, last: float) -> bool:
    """Whether calendars have all that an axis shows around these times, in seconds since 1970:
    margins are up to a part of what is between them, or some years.
    """
    margin = (last - first) / 4 + 4 * YEAR
    return first - margin > YEAR_1 and last + margin < YEAR_10000


def chart_image(chart: Chart, format: str) -> bytes:
    """The bytes of an image: "png", "svg" or "pdf". ImportError where matplotlib is missing."""
    try:
        import matplotlib
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError(
            "matplotlib is needed for images: pip install 'mavwire[plot]'; or write an .html page"
        ) from error
    # Names come from logs: dollars are no formulas, and fonts need not have each character.
    with matplotlib.rc_context({"text.parse_math": False}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph")
        figure = Figure(figsize=SIZE, layout="constrained")
        _draw(figure, chart)
        content = io.BytesIO()
        figure.savefig(content, format=format, dpi=100)
    return content.getvalue()


def _draw(figure: Any, chart: Chart) -> None:
    left = figure.add_subplot()
    right = left.twinx() if any(line.right for line in chart.lines) else None
    if right is not None and all(line.right for line in chart.lines):
        left.yaxis.set_visible(False)
    handles, labels = [], []
    for number, line in enumerate(chart.lines):
        axes = right if line.right and right is not None else left
        style = "--" if line.right else "-"
        colour = LINES[number % len(LINES)]
        marker = "o" if len(line.times) == 1 else None
        (drawn,) = axes.plot(
            _times(chart, line.times),
            line.values,
            style,
            color=colour,
            linewidth=1.1,
            marker=marker,
        )
        handles.append(drawn)
        labels.append(printable(line.label) + (" (right)" if line.right else ""))
    _label_axes(chart, left)
    left.set_title(printable(chart.title), pad=18 if chart.modes else None)
    left.grid(alpha=0.3)
    left.margins(x=0.01)
    _shade(chart, left)
    (right or left).legend(handles, labels, loc="best", fontsize="small", framealpha=0.85)


def printable(text: str) -> str:
    """A text that can be drawn: without control characters, and not hidden by its first one."""
    shown = "".join(one if one.isprintable() else "\ufffd" for one in text)
    return f" {shown}" if shown.startswith("_") else shown


def _times(chart: Chart, seconds: Any) -> Any:
    return (seconds * 1e6).astype("datetime64[us]") if chart.absolute else seconds


def _label_axes(chart: Chart, axes: Any) -> None:
    if not chart.absolute:
        axes.set_xlabel(printable(chart.across))
        return
    from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

    locator = AutoDateLocator()
    axes.xaxis.set_major_locator(locator)
    axes.xaxis.set_major_formatter(ConciseDateFormatter(locator))
    axes.set_xlabel("UTC")


def _shade(chart: Chart, axes: Any) -> None:
    """Flight modes in the background, named above, where no legend is, if there is room."""
    import numpy as np

    colours = colours_of(span.mode for span in chart.modes)
    low, high = axes.get_xlim()
    for span in chart.modes:
        start, end = (
            axes.convert_xunits(one) for one in _times(chart, np.array([span.start, span.end]))
        )
        start, end = max(start, low), min(end, high)
        if end <= start:
            continue
        axes.axvspan(start, end, color=colours[span.mode], alpha=0.13, linewidth=0)
        if (end - start) / (high - low) > 0.006 * len(span.mode):
            axes.text(
                start, 1.005, f" {printable(span.mode)}", transform=axes.get_xaxis_transform(),
                va="bottom", ha="left", fontsize=8, color=colours[span.mode],
            )  # fmt: skip
    axes.set_xlim(low, high)
    if colours:
        from matplotlib.patches import Patch

        patches = [Patch(color=colour, alpha=0.3) for colour in colours.values()]
        names = [printable(mode) for mode in colours]
        axes.figure.legend(
            patches, names, loc="outside lower center", ncols=8, fontsize="small", frameon=False
        )
