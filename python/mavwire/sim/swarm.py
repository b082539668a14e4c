"""Several vehicles behind one link: each hears what arrives and takes what concerns it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .vehicle import Vehicle


class Swarm:
    """Vehicles with different system ids; used like a single `Vehicle`."""

    def __init__(self, vehicles: Sequence[Vehicle]) -> None:
        ids = [vehicle.sysid for vehicle in vehicles]
        if not ids or len(set(ids)) != len(ids):
            raise ValueError(f"a swarm needs vehicles with different system ids: {ids}")
        self.vehicles = list(vehicles)

    @property
    def keys(self) -> set[bytes | None]:
        """The signing keys of the vehicles; None is among them if one has none."""
        return {vehicle.signing.key for vehicle in self.vehicles}

    @property
    def key(self) -> bytes | None:
        """The signing key that all of them have; None if there is no such key."""
        keys = self.keys
        return keys.pop() if len(keys) == 1 else None

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
        """Bytes from a link, cut anywhere. Each vehicle checks signatures with its own key."""
        for vehicle in self.vehicles:
            vehicle.receive(data)

    def handle(self, msg: Any) -> None:
        """A message, for those who parse themselves, and check signatures too."""
        for vehicle in self.vehicles:
            vehicle.handle(msg)

    def advance(self, dt: float) -> None:
        """Let `dt` seconds pass."""
        for vehicle in self.vehicles:
            vehicle.advance(dt)

    def take(self) -> list[bytes]:
        """Frames that are to be sent now."""
        return [frame for vehicle in self.vehicles for frame in vehicle.take()]
