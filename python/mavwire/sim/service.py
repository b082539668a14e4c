"""The base class of the protocol services of a vehicle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from .vehicle import Vehicle

Handler = Callable[[Any], None]


class Address(NamedTuple):
    """The sender of a message, who gets the answer."""

    system: int
    component: int


def sender(msg: Any) -> Address:
    """The address a message came from."""
    return Address(msg.get_srcSystem(), msg.get_srcComponent())


class Service:
    """One protocol of the MAVLink guide. A service handles messages and has work to do as time
    passes.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle

    def handlers(self) -> Mapping[str, Handler]:
        """Message type -> method."""
        raise NotImplementedError

    def step(self) -> None:
        """One tick has passed."""
