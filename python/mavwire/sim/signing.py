"""Signing on a vehicle: a key from the beginning or through SETUP_SIGNING, timestamps from its
clock.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from mavwire.links.signing import check_key
from mavwire.links.signing_time import EPOCH, UNITS_PER_SECOND

from .service import Handler, Service

if TYPE_CHECKING:
    from .vehicle import Vehicle

MICROSECONDS_PER_UNIT = 1_000_000 // UNITS_PER_SECOND
# A start in the far future would leave no room for timestamps: a day at most.
MAX_AHEAD = 24 * 3600 * UNITS_PER_SECOND


class Signing(Service):
    """The key of one vehicle. Without one it neither signs nor checks."""

    def __init__(self, vehicle: Vehicle, mav: Any) -> None:
        super().__init__(vehicle)
        self._state = mav.signing

    @property
    def key(self) -> bytes | None:
        """The secret key, or None."""
        key: bytes | None = self._state.secret_key
        return key

    def handlers(self) -> Mapping[str, Handler]:
        return {"SETUP_SIGNING": self._on_setup}

    def use(self, key: bytes | None) -> None:
        """Sign and check with `key` of 32 bytes; None stops both."""
        if key is not None:
            check_key(key)
        self._state.secret_key = key
        self._state.sign_outgoing = key is not None
        if key is not None:
            self._state.timestamp = self._now()

    def _now(self) -> int:
        return max(self.vehicle.unix_us - EPOCH * 1_000_000, 0) // MICROSECONDS_PER_UNIT

    def keep_time(self) -> None:
        """Before a frame is signed: the timestamp follows the clock and never goes back."""
        state = self._state
        if state.secret_key is not None:
            state.timestamp = max(state.timestamp, self._now())

    def _on_setup(self, msg: Any) -> None:
        """A ground station hands over a key, addressed to this vehicle alone; zeros take it back."""
        if msg.target_system == self.vehicle.sysid and not self.vehicle.armed:
            key = bytes(msg.secret_key)
            self.use(key if any(key) else None)
            if any(key) and msg.initial_timestamp < self._now() + MAX_AHEAD:
                self._state.timestamp = max(msg.initial_timestamp, self._now())
