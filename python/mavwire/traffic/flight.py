"""A small multicopter that flies a lissajous track over a field: smooth, plausible values for the
telemetry to carry.

Not a simulator. Position is a closed formula of time, so velocity, attitude and rates are its
derivatives and agree with each other the way a log analysis expects; noise comes from the given
seed alone.
"""

from __future__ import annotations

import math
from random import Random

GRAVITY = 9.80665
METRES_PER_DEGREE = 111_319.49
CRUISE_HEIGHT = 30.0
CLIMB_SECONDS = 15.0
TRACK = (120.0, 80.0)  # half extent of the track in metres, north and east
BATTERY_MAH = 5200.0
OMEGA = (0.050, 0.075)  # angular speed along the track in rad/s, north and east


class Flight:
    """State of one vehicle: angles in rad, lengths in m, north-east-down axes."""

    def __init__(
        self, seed: int, home: tuple[float, float, float] = (-35.363262, 149.165237, 584.0)
    ) -> None:
        self.random = Random(seed)
        self.home_lat, self.home_lon, self.home_alt = home
        self.metres_per_degree_east = METRES_PER_DEGREE * math.cos(math.radians(home[0]))
        self.phase = self.random.uniform(0, math.tau)
        self.consumed_mah = 0.0
        self.yaw = self.roll = self.pitch = 0.0
        self.noise = [0.0] * 8
        self.ticks = 0
        self.advance(0.0)

    def advance(self, seconds: float) -> None:
        """Move to a time in seconds since boot, which must not be before the last one."""
        before = getattr(self, "seconds", 0.0)
        self.seconds, self.step = seconds, max(seconds - before, 0.0)
        self.ms = int(seconds * 1e3) & 0xFFFFFFFF  # starts anew after 50 days, as on vehicles
        self.us = int(seconds * 1e6)
        self.ticks += 1
        gauss = self.random.gauss
        self.noise = [0.9 * old + gauss(0, 0.1) for old in self.noise]
        self._position()
        self._attitude()
        self._energy()

    def _position(self) -> None:
        """Where it is and how fast: the track and its derivatives."""
        t, phase = self.seconds, self.phase
        ramp = min(t / CLIMB_SECONDS, 1.0)
        (a, b), (u, v) = TRACK, OMEGA
        self.north, self.east = a * math.sin(u * t + phase), b * math.sin(v * t)
        self.vn, self.ve = a * u * math.cos(u * t + phase), b * v * math.cos(v * t)
        self.an, self.ae = -a * u * u * math.sin(u * t + phase), -b * v * v * math.sin(v * t)
        self.height = CRUISE_HEIGHT * ramp + self.noise[0] * 0.1
        self.climb = CRUISE_HEIGHT / CLIMB_SECONDS * (ramp < 1.0) + self.noise[1] * 0.05
        self.lat = self.home_lat + self.north / METRES_PER_DEGREE
        self.lon = self.home_lon + self.east / self.metres_per_degree_east
        self.alt = self.home_alt + self.height
        self.groundspeed = math.hypot(self.vn, self.ve)

    def _attitude(self) -> None:
        """A multicopter leans into its acceleration and points along its track."""
        yaw, roll, pitch = self.yaw, self.roll, self.pitch
        self.yaw = math.atan2(self.ve, self.vn)
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        forward, right = self.an * cos + self.ae * sin, self.ae * cos - self.an * sin
        self.pitch = -math.atan(forward / GRAVITY) + self.noise[2] * 0.01
        self.roll = math.atan(right / GRAVITY) + self.noise[3] * 0.01
        turn = (self.yaw - yaw + math.pi) % math.tau - math.pi
        rate = 1.0 / self.step if self.step else 0.0
        self.rates = ((self.roll - roll) * rate, (self.pitch - pitch) * rate, turn * rate)
        self.heading = math.degrees(self.yaw) % 360.0
        # The reading of an accelerometer in thousandths of g.
        self.accel = (
            int(1000 * math.sin(self.pitch)) + int(20 * self.noise[4]),
            int(-1000 * math.sin(self.roll)) + int(20 * self.noise[5]),
            int(-1000 * math.cos(self.roll) * math.cos(self.pitch)) + int(20 * self.noise[6]),
        )
        self.gyro = tuple(int(1000 * rate) for rate in self.rates)
        field = 450.0
        self.mag = (int(0.5 * field * cos), int(-0.5 * field * sin), int(0.8 * field))

    def _energy(self) -> None:
        """A battery that drains and is changed in flight, motors that work against weight and climb."""
        self.current = 18.0 + 3.0 * self.climb + abs(self.noise[7])
        self.consumed_mah = (self.consumed_mah + self.current * self.step / 3.6) % BATTERY_MAH
        self.remaining = 100 - int(self.consumed_mah / BATTERY_MAH * 100)
        self.voltage = 16.8 - 0.0004 * self.consumed_mah - 0.01 * self.current
        self.throttle = min(100, int(40 + 5 * self.climb))
        self.motors = [
            int(1500 + 40 * self.climb + sign * 30 * self.noise[2]) for sign in (1, -1, 1, -1)
        ]
        self.pressure = 1013.25 * (1 - 2.25577e-5 * self.alt) ** 5.25588
