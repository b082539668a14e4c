"""Pictures of logs: values over time (`plot`), and where a vehicle was (`draw_map`).

    from mavwire import plots

    plots.plot(["flight.tlog"], ["ATTITUDE.roll", "VFR_HUD.alt:2"], "plot.html")
    plots.draw_map("flight.tlog", "track.html")

HTML pages hold everything they need and load nothing; images need matplotlib
(`pip install 'mavwire[plot]'`), and all of it NumPy.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .charts import plot
    from .maps import draw_map

__all__ = ["draw_map", "plot"]
_MODULES = {"draw_map": "maps", "plot": "charts"}


def __getattr__(name: str) -> Any:
    """Charts and maps are imported when they are drawn: tools need less of this package."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    globals()[name] = value
    return value
