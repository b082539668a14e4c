"""The length of the way that GPS messages tell, and how long it took."""

from __future__ import annotations

from math import radians
from typing import Any

from mavwire._sphere import great_circle

FIX_3D = 3


def minutes(seconds: int) -> str:
    """`2:40`"""
    return f"{seconds // 60}:{seconds % 60:02d}"


class Track:
    """The length of a way in `metres`, and the positions in degrees at its `start` and `end`."""

    def __init__(self) -> None:
        self.metres = 0.0
        self.start: tuple[float, float] | None = None
        self.end: tuple[float, float] | None = None
        self._stamp: object = None

    def add(self, lat: float, lon: float, stamp: object) -> None:
        """Go on to a position in degrees. A position with the stamp of the last one is the same one."""
        if self.end is None:
            self.start = (lat, lon)
        elif stamp == self._stamp:
            return
        else:
            before, here = map(radians, self.end), map(radians, (lat, lon))
            self.metres += great_circle(*before, *here)
        self.end, self._stamp = (lat, lon), stamp

    def follow(self, msg: Any) -> None:
        """Go on to the position of a GPS_RAW_INT, if it has one."""
        if msg.lat and msg.lon and msg.fix_type >= FIX_3D:
            self.add(msg.lat / 1.0e7, msg.lon / 1.0e7, msg.time_usec)
