"""Places on the globe and in the flat world around a vehicle's origin.

The simulation runs in metres north, east and up of the place where the vehicle was switched on. A
flat earth is good to centimetres within the few kilometres that a copter flies.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

METRES_PER_DEGREE = 111_319.49
# The simulated world ends here, in metres from the origin: sideways, and up or down.
WORLD = 50_000.0
SKY = 10_000.0
# Nearer to the poles the flat world has no east.
MAX_LATITUDE = 89


class Place(NamedTuple):
    """Degrees, and metres above mean sea level."""

    lat: float
    lon: float
    alt: float


def place_of(home: Iterable[float]) -> Place:
    """The place that `home` names by degrees and metres; ValueError if it is none."""
    numbers = () if isinstance(home, (str, bytes)) else home  # characters may be numbers, too
    try:
        lat, lon, alt = map(float, numbers)
    except (TypeError, ValueError):
        reason = "home must be latitude, longitude and metres above sea level"
        raise ValueError(f"{reason}: {home!r}") from None
    return Place(lat, lon, alt)


def check_start(home: Place, heading: float) -> None:
    """ValueError for what is no place or heading (degrees) to start from; NaN is neither."""
    if not (abs(home.lat) < MAX_LATITUDE and abs(home.lon) <= 180 and abs(home.alt) <= SKY):
        raise ValueError(
            f"home must be a latitude within {MAX_LATITUDE} and a longitude within 180 degrees, and an "
            f"altitude within {SKY:.0f} m: {home.lat}, {home.lon}, {home.alt}"
        )
    if not abs(heading) <= 360:
        raise ValueError(f"heading must be between -360 and 360 degrees: {heading}")


class Local(NamedTuple):
    """Metres north and east of the origin, and above it."""

    north: float
    east: float
    up: float


class Origin:
    """Converts between places and the local frame around one of them."""

    def __init__(self, place: Place) -> None:
        self.place = place
        self._east = METRES_PER_DEGREE * max(math.cos(math.radians(place.lat)), 1e-6)

    def local(self, place: Place) -> Local:
        """A place in the local frame."""
        north = (place.lat - self.place.lat) * METRES_PER_DEGREE
        east = (place.lon - self.place.lon) * self._east
        return within_world(Local(north, east, place.alt - self.place.alt))

    def globe(self, local: Local) -> Place:
        """A point of the local frame as a place."""
        lat = self.place.lat + local.north / METRES_PER_DEGREE
        lon = self.place.lon + local.east / self._east
        return Place(lat, lon, self.place.alt + local.up)


def within_world(local: Local) -> Local:
    """The nearest point that the world has; what is no number is the origin's."""
    north, east, up = (0.0 if math.isnan(value) else value for value in local)
    return Local(clamp(north, WORLD), clamp(east, WORLD), clamp(up, SKY))


def wrap(angle: float) -> float:
    """An angle in rad between -pi and pi."""
    return (angle + math.pi) % math.tau - math.pi


def turned(forward: float, right: float, yaw: float) -> tuple[float, float]:
    """A vector of the vehicle's axes as north and east."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return forward * cos - right * sin, forward * sin + right * cos


def distance(a: Local, b: Local) -> float:
    """Horizontal distance in metres."""
    return math.hypot(b.north - a.north, b.east - a.east)


def bearing(a: Local, b: Local) -> float:
    """Direction from `a` to `b` in rad, clockwise from north."""
    return math.atan2(b.east - a.east, b.north - a.north)


def clamp(value: float, limit: float) -> float:
    """`value` between -limit and limit."""
    return max(-limit, min(limit, value))


def e7(degrees: float) -> int:
    """Degrees as messages carry them: in units of 1e-7."""
    return round(degrees * 1e7)
