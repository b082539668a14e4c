"""Runs a program and writes what its figures show as JSON, in place of pixels or windows.

`python figure_record.py PROGRAM ARGUMENTS`: images that it saves have that content, and `show()` writes
`figure1.json` and so on into the working directory. PROGRAM is a script, or `-m` and a module.
"""

from __future__ import annotations

import json
import runpy
import sys
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib._pylab_helpers import Gcf
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase, FigureManagerBase
from matplotlib.colors import to_hex

FigureRecord = dict[str, Any]


def record(figure: Any) -> FigureRecord:
    """What a figure shows: its axes with lines, shaded spans, texts and legend."""
    figure.canvas.draw()
    return {
        "title": figure.get_suptitle(),
        "legend": [_legend(one) for one in figure.legends],
        "axes": [_axes(one) for one in figure.axes],
    }


def _axes(axes: Any) -> FigureRecord:
    legend = axes.get_legend()
    return {
        "title": axes.get_title(),
        "labels": [axes.get_xlabel(), axes.get_ylabel()],
        "scales": [axes.get_xscale(), axes.get_yscale()],
        "limits": [*axes.get_xlim(), *axes.get_ylim()],
        "grid": [line.get_visible() for line in axes.get_xgridlines()[:1]],
        "ticks": [tick.get_text() for tick in axes.get_xticklabels()],
        "legend": None if legend is None else _legend(legend),
        "lines": [_line(one) for one in axes.get_lines()],
        "spans": [_span(one) for one in axes.patches],
        "texts": [_text(one) for one in axes.texts],
        "points": [one.get_offsets().tolist() for one in axes.collections],
    }


def _text(text: Any) -> FigureRecord:
    place = [str(getattr(text, name, None)) for name in ("xy", "xycoords", "textcoords")]
    style = [
        text.get_rotation(),
        text.get_color(),
        text.get_ha(),
        text.get_va(),
        text.get_fontsize(),
    ]
    return {"text": text.get_text(), "at": [*text.get_position()], "place": place, "style": style}


def _legend(legend: Any) -> FigureRecord:
    return {
        "texts": [one.get_text() for one in legend.get_texts()],
        "colours": [_colour(one) for one in legend.legend_handles],
        "place": legend._loc,
    }


def _colour(handle: Any) -> str:
    value = handle.get_color() if hasattr(handle, "get_color") else handle.get_facecolor()
    return str(to_hex(value))


def _line(line: Any) -> FigureRecord:
    x, y = line.get_xdata(orig=False), line.get_ydata(orig=False)
    return {
        "label": line.get_label(),
        "colour": to_hex(line.get_color()),
        "style": [line.get_linestyle(), line.get_marker(), line.get_linewidth()],
        "x": [float(one) for one in x],
        "y": [float(one) for one in y],
    }


def _span(patch: Any) -> FigureRecord:
    bounds = patch.get_path().transformed(patch.get_patch_transform()).get_extents()
    return {
        "label": patch.get_label(),
        "colour": to_hex(patch.get_facecolor(), keep_alpha=True),
        "x": [float(bounds.x0), float(bounds.x1)],
    }


def _plot_date(
    axes: Any, x: Any, y: Any, fmt: str = "o", tz: Any = None, xdate: bool = True, **options: Any
) -> Any:
    """What matplotlib had to its version 3.10, and pymavlink's scripts call."""
    if xdate:
        axes.xaxis_date(tz)
    return axes.plot(x, y, fmt, **options)


def _save(canvas: Any, place: Any, *args: Any, **options: Any) -> None:
    """`place` is a name or a file for bytes."""
    content = json.dumps(record(canvas.figure), indent=1).encode()
    if hasattr(place, "write"):
        place.write(content)
    else:
        Path(place).write_bytes(content)


def _show(*args: Any, **options: Any) -> None:
    for manager in Gcf.get_all_fig_managers():
        _save(manager.canvas, f"figure{manager.num}.json")


def main() -> None:
    """Run the program that the arguments name."""
    matplotlib.use("agg")
    matplotlib.use = lambda *args, **options: None
    if not hasattr(Axes, "plot_date"):
        Axes.plot_date = _plot_date
    FigureCanvasBase.print_figure = _save
    FigureManagerBase.pyplot_show = _show
    FigureManagerBase.show = _show
    sys.argv = sys.argv[1:]
    if sys.argv[0] == "-m":
        sys.argv = sys.argv[1:]
        runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
    else:
        runpy.run_path(sys.argv[0], run_name="__main__")


if __name__ == "__main__":
    main()
