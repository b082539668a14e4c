"""How a multicopter moves: it leans to accelerate, and everything it reports follows from that.

A point mass with lagging attitude. The velocity that is asked for becomes an acceleration, the
acceleration a lean, and only the lean that was reached moves the vehicle; so attitude, rates,
velocity, position and what an accelerometer feels agree with each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from mavwire.quaternion import from_angles

from .geo import SKY, WORLD, Local, Origin, Place, clamp, wrap

GRAVITY = 9.80665
# How fast the vehicle follows: attitude and yaw in seconds, velocities per second.
LEAN_LAG = 0.15
YAW_LAG = 0.25
VELOCITY_GAIN = 1.6
CLIMB_GAIN = 2.5
YAW_GAIN = 2.0
# The limits of the frame: lean in rad, climb acceleration in m/s2, yaw rate in rad/s.
MAX_LEAN = math.radians(30)
MAX_CLIMB_ACCEL = 4.0
MAX_YAW_RATE = math.radians(90)
# The highest speed along each axis, in m/s.
MAX_SPEED = 25.0
MAX_CLIMB = 12.0
# Air resistance: the lean at constant speed comes from it. In 1/s.
DRAG = 0.12
FALL_DRAG = 0.3


@dataclass
class Demand:
    """The movement that is asked of the vehicle: velocities in m/s north, east and up; a heading in rad or a turn
    in rad/s, or neither to keep the heading.
    """

    north: float = 0.0
    east: float = 0.0
    up: float = 0.0
    yaw: float | None = None
    yaw_rate: float | None = None


REST = Demand(up=-1.0)


class Copter:
    """State of the vehicle in its local frame: metres, m/s, rad and rad/s."""

    def __init__(self, origin: Origin, heading: float, wind: tuple[float, float]) -> None:
        self.origin = origin
        self.wind_north, self.wind_east = wind
        self.north = self.east = self.up = 0.0
        self.vn = self.ve = self.climb = 0.0
        self.an = self.ae = self.au = 0.0
        self.roll = self.pitch = 0.0
        self.yaw = heading
        self.roll_rate = self.pitch_rate = self.yaw_rate = 0.0
        self.landed = True

    @property
    def local(self) -> Local:
        """Where it is in the local frame."""
        return Local(self.north, self.east, self.up)

    @property
    def place(self) -> Place:
        """Where it is on the globe."""
        return self.origin.globe(self.local)

    @property
    def groundspeed(self) -> float:
        """Horizontal speed over ground."""
        return math.hypot(self.vn, self.ve)

    @property
    def airspeed(self) -> float:
        """Horizontal speed through the air."""
        return math.hypot(self.vn - self.wind_north, self.ve - self.wind_east)

    def step(self, dt: float, demand: Demand, powered: bool) -> None:
        """Move on by `dt` seconds; without power it falls."""
        if self.landed:
            if not powered or demand.up <= 0:
                self._rest()
                return
            self.landed = False
        if powered:
            self._lean(dt, demand)
            self._turn(dt, demand)
            climb = clamp(demand.up, MAX_CLIMB)
            self.au = clamp(CLIMB_GAIN * (climb - self.climb), MAX_CLIMB_ACCEL)
        else:
            self.roll_rate = self.pitch_rate = self.yaw_rate = 0.0
            self.an = -DRAG * (self.vn - self.wind_north)
            self.ae = -DRAG * (self.ve - self.wind_east)
            self.au = -GRAVITY - FALL_DRAG * self.climb
        self._move(dt)

    def _lean(self, dt: float, demand: Demand) -> None:
        """Roll and pitch towards the demanded acceleration, which the wind and drag change."""
        north, east = clamp(demand.north, MAX_SPEED), clamp(demand.east, MAX_SPEED)
        north = VELOCITY_GAIN * (north - self.vn) + DRAG * (self.vn - self.wind_north)
        east = VELOCITY_GAIN * (east - self.ve) + DRAG * (self.ve - self.wind_east)
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        forward, right = north * cos + east * sin, east * cos - north * sin
        share = 1.0 - math.exp(-dt / LEAN_LAG)
        pitch = clamp(-math.atan(forward / GRAVITY), MAX_LEAN)
        roll = clamp(math.atan(right / GRAVITY), MAX_LEAN)
        self.pitch_rate = (pitch - self.pitch) * share / dt
        self.roll_rate = (roll - self.roll) * share / dt
        self.pitch += self.pitch_rate * dt
        self.roll += self.roll_rate * dt
        forward, right = -GRAVITY * math.tan(self.pitch), GRAVITY * math.tan(self.roll)
        self.an = forward * cos - right * sin - DRAG * (self.vn - self.wind_north)
        self.ae = forward * sin + right * cos - DRAG * (self.ve - self.wind_east)

    def _turn(self, dt: float, demand: Demand) -> None:
        """Yaw towards the heading or at the rate that is wanted."""
        rate = demand.yaw_rate or 0.0
        if demand.yaw is not None:
            rate = YAW_GAIN * wrap(demand.yaw - self.yaw)
        rate = clamp(rate, MAX_YAW_RATE)
        self.yaw_rate += (rate - self.yaw_rate) * (1.0 - math.exp(-dt / YAW_LAG))
        self.yaw = wrap(self.yaw + self.yaw_rate * dt)

    def _move(self, dt: float) -> None:
        """Velocities and position from accelerations; the ground stops everything."""
        self.vn += self.an * dt
        self.ve += self.ae * dt
        self.climb += self.au * dt
        self.north = clamp(self.north + self.vn * dt, WORLD)
        self.east = clamp(self.east + self.ve * dt, WORLD)
        self.up = min(self.up + self.climb * dt, SKY)
        if self.up <= 0.0 and self.climb <= 0.0:
            self.up = 0.0
            self.landed = True
            self._rest()

    def _rest(self) -> None:
        self.vn = self.ve = self.climb = 0.0
        self.an = self.ae = self.au = 0.0
        self.roll = self.pitch = 0.0
        self.roll_rate = self.pitch_rate = self.yaw_rate = 0.0

    def body(self, north: float, east: float, down: float) -> tuple[float, float, float]:
        """A vector of the earth frame in the body frame: forward, right, down."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        x, y = north * cos + east * sin, east * cos - north * sin
        cos, sin = math.cos(self.pitch), math.sin(self.pitch)
        x, z = x * cos - down * sin, x * sin + down * cos
        cos, sin = math.cos(self.roll), math.sin(self.roll)
        return x, y * cos + z * sin, z * cos - y * sin

    def specific_force(self) -> tuple[float, float, float]:
        """The reading of an accelerometer in m/s2: forward, right, down."""
        return self.body(self.an, self.ae, -self.au - GRAVITY)

    def quaternion(self) -> tuple[float, float, float, float]:
        """The attitude as a quaternion, w first."""
        return from_angles(self.roll, self.pitch, self.yaw)
