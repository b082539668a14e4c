"""Pictures of logs: values over time (`plot`), and where a vehicle was (`draw_map`).

    from mavwire import plots

    plots.plot(["flight.tlog"], ["ATTITUDE.roll", "VFR_HUD.alt:2"], "plot.html")
    plots.draw_map("flight.tlog", "track.html")

HTML pages hold everything they need and load nothing; images need matplotlib
(`pip install 'mavwire[plot]'`), and all of it NumPy.
"""

from typing import TYPE_CHECKING

from mavwire import _lazy

if TYPE_CHECKING:
    from .charts import plot
    from .maps import draw_map

__all__ = ["draw_map", "plot"]
# `mavwire graph` uses this package and draws neither charts nor maps.
__getattr__ = _lazy.attributes(__name__, {"draw_map": "maps", "plot": "charts"})
