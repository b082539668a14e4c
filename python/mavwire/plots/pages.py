"""Charts and maps as pages that hold everything they need and load nothing.

Content of a log reaches a page as data, never as markup or code.
"""

from __future__ import annotations

import base64
import html
import json
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from .images import LINES
from .modes import colours_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .charts import Chart, Line
    from .modes import Span

MOST_POINTS = 200_000
"""Points of a line on a page; of more than that, extremes of stretches are kept."""

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; \
style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<header><h1>{title}</h1><div id="legend"></div></header>
<main><canvas id="canvas"></canvas><div id="tip"></div></main>
<footer>{help}</footer>
<script type="application/json" id="data">{data}</script>
<script>
{script}</script>
</body>
</html>
"""


def page(title: str, help: str, data: dict[str, Any], script: str) -> bytes:
    """A page around one canvas, drawn by an asset of this package."""
    assets = files(__package__) / "_assets"
    # `<` would end the element around the data.
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    scripts = [(assets / name).read_text("utf-8") for name in ("common.js", script)]
    return _PAGE.format(
        title=html.escape(title),
        help=html.escape(help),
        style=(assets / "page.css").read_text("utf-8"),
        data=text,
        script="".join(scripts),
    ).encode("utf-8", "replace")


def chart_page(chart: Chart) -> bytes:
    """A chart to zoom and to move in."""
    first = min((float(line.times.min()) for line in chart.lines if len(line.times)), default=0.0)
    lines = [
        {
            "label": line.label,
            "right": line.right,
            "colour": LINES[number % len(LINES)],
            **_points(line, first),
        }
        for number, line in enumerate(chart.lines)
    ]
    data = {
        "lines": lines,
        "modes": shaded(chart.modes, first),
        "zero": first,
        "absolute": chart.absolute,
        "across": chart.across,
    }
    help = "wheel: zoom in time · shift + wheel: zoom values · drag: move · double click: all"
    return page(chart.title, help, data, "chart.js")


def shaded(modes: Iterable[Span], zero: float) -> list[dict[str, Any]]:
    """Stretches of time in a mode, with its colour."""
    every = list(modes)
    colours = colours_of(span.mode for span in every)
    return [
        {"mode": s.mode, "start": s.start - zero, "end": s.end - zero, "colour": colours[s.mode]}
        for s in every
    ]


def _points(line: Line, zero: float) -> dict[str, Any]:
    kept = extremes(line.values, MOST_POINTS)
    return {"x": packed(line.times[kept] - zero), "y": packed(line.values[kept])}


def packed(values: Any) -> str:
    """An array of doubles for a page: little-endian, in base 64."""
    return base64.b64encode(values.astype("<f8").tobytes()).decode("ascii")


def extremes(values: Any, most: int) -> Any:
    """Which of many values to show: all, or the smallest and largest of each stretch."""
    import numpy as np

    if len(values) <= most:
        return np.arange(len(values))
    stretches = most // 2 - 1
    length = -(-len(values) // stretches)
    whole = len(values) // length * length
    blocks = values[:whole].reshape(-1, length)
    starts = np.arange(0, whole, length)
    chosen = [starts + blocks.argmin(axis=1), starts + blocks.argmax(axis=1)]
    if whole < len(values):
        rest = values[whole:]
        chosen.append(whole + np.array([rest.argmin(), rest.argmax()]))
    return np.unique(np.concatenate([[0, len(values) - 1], *chosen]))
