"""Several vehicles behind one link: what arrives is parsed once and given to whom it concerns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mavwire.dialects.v20 import all as mavlink

from .vehicle import Vehicle


class Swarm:
    """Vehicles with different system ids; used like a single `Vehicle`."""

    def __init__(self, vehicles: Sequence[Vehicle]) -> None:
        ids = [vehicle.sysid for vehicle in vehicles]
        if not ids or len(set(ids)) != len(ids):
            raise ValueError(f"a swarm needs vehicles with different system ids: {ids}")
        self.vehicles = list(vehicles)
        self._mav: Any = mavlink.MAVLink(None)
        self._mav.robust_parsing = True

    @property
    def key(self) -> bytes | None:
        """The signing key of the first vehicle; they are expected to share one."""
        return self.vehicles[0].signing.key

    @property
    def until_next(self) -> float:
        """Seconds until one of them has something to send."""
        return min(vehicle.until_next for vehicle in self.vehicles)

    def step(self, dt: float, data: bytes = b"") -> bytes:
        """Receive `data`, let `dt` seconds pass, and return all that is sent meanwhile."""
        self.receive(data)
        self.advance(dt)
        return b"".join(self.take())

    def receive(self, data: bytes) -> None:
        """Bytes from a link, cut anywhere."""
        if data:
            self._mav.signing.secret_key = self.key
            for msg in self._mav.parse_buffer(data) or ():
                if msg.get_type() != "BAD_DATA":
                    self.handle(msg)

    def handle(self, msg: Any) -> None:
        """A message, for those who parse themselves."""
        for vehicle in self.vehicles:
            vehicle.handle(msg)

    def advance(self, dt: float) -> None:
        """Let `dt` seconds pass."""
        for vehicle in self.vehicles:
            vehicle.advance(dt)

    def take(self) -> list[bytes]:
        """Frames that are to be sent now."""
        return [frame for vehicle in self.vehicles for frame in vehicle.take()]
