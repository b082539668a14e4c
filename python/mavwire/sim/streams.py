"""Telemetry on time: which message goes out how often, and the requests that change it."""

from __future__ import annotations

from collections.abc import Mapping
from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink

from .service import Handler, Service
from .telemetry import TELEMETRY, message

if TYPE_CHECKING:
    from .vehicle import Vehicle

TICK = 0.01
TICKS_PER_SECOND = round(1 / TICK)
TICK_US = round(TICK * 1e6)


class Streams(Service):
    """The schedule of one vehicle, counted in ticks of 10 ms: no stream is faster than that."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self._by_id = {mavlink_id(name): name for name in TELEMETRY}
        self._defaults: dict[str, int] = {}
        self._periods: dict[str, int] = {}
        self._asked: set[str] = set()
        self._heap: list[tuple[int, str]] = []
        self.load_rates()

    def handlers(self) -> Mapping[str, Handler]:
        return {"REQUEST_DATA_STREAM": self._on_request}

    # -- rates

    def load_rates(self) -> None:
        """Rates as the personality and the parameters say; those asked for by message stay."""
        rates = dict(self.vehicle.personality.streams)
        for group, name in self.vehicle.personality.stream_params.items():
            rate = self.vehicle.params[name]
            rates.update(dict.fromkeys(self.vehicle.personality.stream_groups[group], rate))
        self._defaults = {name: _ticks(rate) for name, rate in rates.items() if rate > 0}
        asked = {name: ticks for name, ticks in self._periods.items() if name in self._asked}
        wanted = {n: t for n, t in self._defaults.items() if n not in self._asked} | asked
        if wanted != self._periods:
            self._periods = wanted
            self._restart()

    def _restart(self) -> None:
        """Spread the streams over time, so that they do not all fall on one tick."""
        now = self.vehicle.ticks
        self._heap = [
            (now + 1 + index * 7 % period, name)
            for index, (name, period) in enumerate(self._periods.items())
        ]
        heapify(self._heap)

    def set_period(self, name: str, ticks: int) -> None:
        """Send `name` every `ticks` ticks, 0 for never."""
        self._heap = [entry for entry in self._heap if entry[1] != name]
        heapify(self._heap)
        self._periods.pop(name, None)
        if ticks:
            self._periods[name] = ticks
            heappush(self._heap, (self.vehicle.ticks + 1, name))

    def set_interval(self, message_id: int, microseconds: float) -> bool:
        """As MAV_CMD_SET_MESSAGE_INTERVAL: -1 stops, 0 is the usual rate; False if unknown.

        Heartbeats are no telemetry: they cannot be changed.
        """
        name = self._by_id.get(message_id)
        if name is None or name == "HEARTBEAT":
            return False
        if microseconds == 0:
            self._asked.discard(name)
            self.set_period(name, self._defaults.get(name, 0))
        else:
            self._asked.add(name)
            self.set_period(name, max(1, round(microseconds / TICK_US)) if microseconds > 0 else 0)
        return True

    def interval(self, message_id: int) -> int:
        """As MESSAGE_INTERVAL: microseconds, -1 when stopped, 0 when there is no such stream."""
        name = self._by_id.get(message_id)
        if name is None:
            return 0
        return self._periods[name] * TICK_US if name in self._periods else -1

    def rate(self, name: str) -> float:
        """Messages a second."""
        return TICKS_PER_SECOND / self._periods[name] if name in self._periods else 0.0

    # -- sending

    @property
    def next_tick(self) -> int:
        """When the next message is due."""
        return self._heap[0][0] if self._heap else self.vehicle.ticks + TICKS_PER_SECOND

    def step(self) -> None:
        """Send what is due."""
        heap, now = self._heap, self.vehicle.ticks
        while heap and heap[0][0] <= now:
            due, name = heappop(heap)
            heappush(heap, (due + self._periods[name], name))
            self.send(name)

    def send(self, name: str) -> None:
        """Send one message of the table, now."""
        self.vehicle.send(message(name, self.vehicle))

    def send_by_id(self, message_id: int) -> bool:
        """The same by message id; False when it is not in the table."""
        name = self._by_id.get(message_id)
        if name is not None:
            self.send(name)
        return name is not None

    def _on_request(self, msg: Any) -> None:
        groups = self.vehicle.personality.stream_groups
        if msg.req_stream_id == mavlink.MAV_DATA_STREAM_ALL:
            wanted = list(groups)
        else:
            wanted = [group for group in groups if group == msg.req_stream_id]
        ticks = _ticks(msg.req_message_rate) if msg.start_stop and msg.req_message_rate else 0
        for group in wanted:
            for name in groups[group]:
                self._asked.add(name)
                self.set_period(name, ticks)


def _ticks(rate: float) -> int:
    """The period of a rate in Hz."""
    return max(1, round(TICKS_PER_SECOND / rate))


def mavlink_id(name: str) -> int:
    """The id of a message by its upper-case name."""
    return int(getattr(mavlink, f"MAVLINK_MSG_ID_{name}"))
