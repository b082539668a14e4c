"""TIMESYNC and PING: both send back what came, with a time of their own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mavwire.dialects.v20 import all as mavlink

from .service import Handler, Service, sender


class Timesync(Service):
    """Answers requests; answers to others are none of its business."""

    def handlers(self) -> Mapping[str, Handler]:
        return {"TIMESYNC": self._on_timesync, "PING": self._on_ping}

    def _on_timesync(self, msg: Any) -> None:
        if msg.tc1 == 0:
            now = self.vehicle.time_us * 1000
            self.vehicle.send(mavlink.MAVLink_timesync_message(max(now, 1), msg.ts1))

    def _on_ping(self, msg: Any) -> None:
        if msg.target_system == 0:
            to = sender(msg)
            self.vehicle.send(mavlink.MAVLink_ping_message(msg.time_usec, msg.seq, *to))
