"""How far a vehicle went, from one position to the next."""

from __future__ import annotations

from math import radians

from mavwire._sphere import great_circle


class Track:
    """The length of a way in `metres`. A position whose stamp is the last one's is the same one."""

    def __init__(self) -> None:
        self.metres = 0.0
        self.start: tuple[float, float] | None = None
        self.end: tuple[float, float] | None = None
        self._radians = (0.0, 0.0)
        self._stamp: int | None = None

    def add(self, lat: float, lon: float, stamp: int) -> None:
        """Go on to a position, in degrees."""
        if stamp == self._stamp:
            return
        end, self.end, self._stamp = self.end, (lat, lon), stamp
        lat, lon = radians(lat), radians(lon)
        if end is None:
            self.start = self.end
        else:
            self.metres += great_circle(*self._radians, lat, lon)
        self._radians = (lat, lon)
