"""How far a vehicle went, from one position to the next."""

from __future__ import annotations

from mavwire.mavextra import distance_lat_lon


class Track:
    """The length of a way in `metres`. A position whose stamp is the last one's is the same one."""

    def __init__(self) -> None:
        self.metres = 0.0
        self.start: tuple[float, float] | None = None
        self.end: tuple[float, float] | None = None
        self._stamp: int | None = None

    def add(self, lat: float, lon: float, stamp: int) -> None:
        """Go on to a position, in degrees."""
        if stamp == self._stamp:
            return
        here = (lat, lon)
        if self.end is None:
            self.start = here
        elif here != self.end:
            self.metres += distance_lat_lon(*self.end, lat, lon)
        self.end, self._stamp = here, stamp
