"""Plays a log back: its frames to ground stations, its flight to FlightGear, at its own pace."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

# A gap in the log longer than this is cut short, as are times that go back.
LONGEST_GAP = 10.0


class Flight:
    """The state for FlightGear: the newest attitude, position and speed of the vehicle."""

    def __init__(self, gps_altitude: bool = False) -> None:
        from mavwire.fgFDM import fgFDM

        self._fdm = fgFDM()
        self._gps_altitude = gps_altitude
        self._fdm.set("num_engines", 1)

    def add(self, msg: Any) -> bytes | None:
        """Take in a message; a packet for FlightGear if the vehicle has moved by it."""
        update = getattr(self, f"_on_{msg.get_type().lower()}", None)
        if update is None:
            return None
        update(msg)
        self._fdm.set("cur_time", int(msg._timestamp) % 2**31, units="seconds")
        return self._fdm.pack()

    def _set(self, units: str, **values: float) -> None:
        for name, value in values.items():
            self._fdm.set(name, value, units=units)

    def _on_attitude(self, msg: Any) -> None:
        self._set("radians", phi=msg.roll, theta=msg.pitch, psi=msg.yaw)
        self._set("rps", phidot=msg.rollspeed, thetadot=msg.pitchspeed, psidot=msg.yawspeed)

    def _on_global_position_int(self, msg: Any) -> None:
        self._set("degrees", latitude=msg.lat * 1e-7, longitude=msg.lon * 1e-7)
        self._set("mps", v_north=msg.vx * 0.01, v_east=msg.vy * 0.01, v_down=msg.vz * 0.01)
        self._set("meters", agl=msg.relative_alt * 1e-3)
        if not self._gps_altitude:
            self._set("meters", altitude=msg.alt * 1e-3)

    def _on_gps_raw_int(self, msg: Any) -> None:
        self._set("degrees", latitude=msg.lat * 1e-7, longitude=msg.lon * 1e-7)
        if self._gps_altitude:
            self._set("meters", altitude=msg.alt * 1e-3)

    def _on_vfr_hud(self, msg: Any) -> None:
        self._set("mps", vcas=msg.airspeed, climb_rate=msg.climb)
        self._fdm.set("rpm", msg.throttle * 20.0)
        if not self._gps_altitude:
            self._set("meters", altitude=msg.alt)


class Player:
    """Hands the messages of a log on when they are due, `speed` times as fast as they came.

    `send` gets each frame, `fly` each packet for FlightGear.
    """

    def __init__(
        self,
        messages: Iterable[Any],
        send: Callable[[bytes], Any],
        fly: Callable[[bytes], Any],
        flight: Flight,
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.speed = speed
        self.paused = False
        self.sent = 0
        self.stamp: float | None = None
        """Time of the message that was sent last, seconds since 1970."""
        self._messages = iter(messages)
        self._send, self._fly, self._flight, self._clock = send, fly, flight, clock
        self._next = next(self._messages, None)
        self._due = clock()

    @property
    def done(self) -> bool:
        """Whether all of the log is sent."""
        return self._next is None

    def step(self) -> float:
        """Send what is due; seconds until the next message is, 0 at the end."""
        now = self._clock()
        if self.paused:
            self._due = now
            return LONGEST_GAP
        while self._next is not None:
            if self._due > now:
                return self._due - now
            self._play(self._next)
            self._next = next(self._messages, None)
            if self._next is not None and self.stamp is not None:
                gap = self._next._timestamp - self.stamp
                self._due += min(gap, LONGEST_GAP) / self.speed if gap > 0 else 0.0
        return 0.0

    def _play(self, msg: Any) -> None:
        self.stamp = msg._timestamp
        self.sent += 1
        self._send(bytes(msg.get_msgbuf()))
        packet = self._flight.add(msg)
        if packet is not None:
            self._fly(packet)
