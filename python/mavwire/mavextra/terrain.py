"""Clearance over terrain along a line of sight. The elevations are MAVProxy's (SRTM)."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from typing import Any

from mavwire.mavextra import state
from mavwire.mavextra.position import distance_lat_lon

__all__ = [
    "radio_margin", "terrain_height", "terrain_margin", "terrain_margin_lat_lon",
]  # fmt: skip

_STEP = 20.0  # metres between two samples
_MAX_SAMPLES = 100_000


@lru_cache(maxsize=10_000)
def terrain_height(lat: float, lon: float) -> float | None:
    """Metres of the ground above sea level at a point in degrees; None where it is not known.

    Raises ModuleNotFoundError without MAVProxy, whose downloaded elevation data is used.
    """
    if state.SCALARS["EleModel"] is None:
        state.SCALARS["EleModel"] = _elevation_model()
    height: float | None = state.SCALARS["EleModel"].GetElevation(lat, lon)
    return height


def _elevation_model() -> Any:
    try:
        model = import_module("MAVProxy.modules.mavproxy_map.mp_elevation").ElevationModel
    except ImportError as error:
        raise ModuleNotFoundError(
            "terrain heights need MAVProxy and its elevation data: pip install MAVProxy",
            name="MAVProxy",
        ) from error
    return model("srtm", offline=1)


def _on_grid(angle: float) -> float:
    """An angle cut to 1e-5 degrees, so that close samples share one look-up."""
    return int(angle * 1.0e5) * 1.0e-5


def terrain_margin_lat_lon(
    lat1: float, lon1: float, alt1: float, lat2: float, lon2: float, alt2: float
) -> float:
    """The least clearance in metres of the straight line between two points above the ground.

    Raises ZeroDivisionError for a line of no length, ValueError where a height is not known.
    """
    distance = distance_lat_lon(lat1, lon1, lat2, lon2)
    if distance > _MAX_SAMPLES * _STEP:
        raise ValueError(f"a line of {distance:.0f} m is too long to be sampled")
    margins = []
    for sample in range(max(1, int(distance / _STEP))):
        part = sample * _STEP / distance
        lat, lon = lat1 + (lat2 - lat1) * part, lon1 + (lon2 - lon1) * part
        line = alt1 + (alt2 - alt1) * part
        margins.append(line - _known_height(_on_grid(lat), _on_grid(lon)))
    return min(margins)


def _known_height(lat: float, lon: float) -> float:
    height = terrain_height(lat, lon)
    if height is None:
        raise ValueError(f"the height of the ground at {lat}, {lon} is not known")
    return height


def terrain_margin(TERR: Any, lat: float, lon: float, antenna_height: float) -> float:
    """The least clearance of the line from a vehicle (message TERR) to an antenna on the ground."""
    antenna = _known_height(lat, lon) + antenna_height
    return terrain_margin_lat_lon(TERR.Lat, TERR.Lng, TERR.CHeight + TERR.TerrH, lat, lon, antenna)


def radio_margin(TERR: Any, lat: float, lon: float, antenna_height: float) -> float:
    """How many metres a vehicle could descend with the antenna still in sight, to 1 m."""
    antenna = _known_height(lat, lon) + antenna_height
    altitude = float(TERR.CHeight + TERR.TerrH if hasattr(TERR, "CHeight") else TERR.Alt)
    low, high = 0.0, altitude
    for _ in range(64):  # ends for any altitude, infinite ones too
        if not high - low > 1:
            break
        middle = (low + high) / 2
        if terrain_margin_lat_lon(TERR.Lat, TERR.Lng, middle, lat, lon, antenna) < 0:
            low = middle
        else:
            high = middle
    return altitude - high
