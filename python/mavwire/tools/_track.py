"""How far a vehicle went, from one position to the next."""

from __future__ import annotations

from math import atan2, cos, radians, sin, sqrt

from mavwire._sphere import RADIUS


class Track:
    """The length of a way in `metres`. A position whose stamp is the last one's is the same one."""

    __slots__ = ("_place", "_stamp", "end", "metres", "start")

    def __init__(self) -> None:
        self.metres = 0.0
        self.start: tuple[float, float] | None = None
        self.end: tuple[float, float] | None = None
        # In radians, with the cosine of the latitude.
        self._place = (0.0, 0.0, 1.0)
        self._stamp: int | None = None

    def add(self, lat: float, lon: float, stamp: int) -> None:
        """Go on to a position, in degrees."""
        if stamp == self._stamp:
            return
        self._stamp = stamp
        lat1, lon1, cos1 = self._place
        lat2, lon2 = radians(lat), radians(lon)
        cos2 = cos(lat2)
        self._place = (lat2, lon2, cos2)
        if self.start is None:
            self.start = (lat, lon)
        else:
            # The great circle of mavwire._sphere, with one cosine a position.
            a = sin((lat2 - lat1) / 2) ** 2 + sin((lon2 - lon1) / 2) ** 2 * cos1 * cos2
            self.metres += RADIUS * 2.0 * atan2(sqrt(a), sqrt(max(0.0, 1.0 - a)))
        self.end = (lat, lon)


def minutes(seconds: int) -> str:
    """`2:40`"""
    return f"{seconds // 60}:{seconds % 60:02d}"
