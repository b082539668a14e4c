"""The sensors of a vehicle: a battery that drains, a GPS that needs a while, noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

from .geo import METRES_PER_DEGREE, Place
from .physics import Copter

NOISES = 8
# Noise is drawn this often; faster noise would only cost time.
NOISE_INTERVAL = 0.1
CELLS = 4
FULL_CELL = 4.2
EMPTY_CELL = 3.3
CELL_RESISTANCE = 0.004
# Amperes: switched on, propellers turning on the ground, hovering, and for each m/s of climb.
IDLE_CURRENT = 0.4
TURNING_CURRENT = 2.0
HOVER_CURRENT = 18.0
CLIMB_CURRENT = 3.0
# The earth's field in milligauss: north, east, down.
FIELD = (220.0, 30.0, -420.0)
SEA_LEVEL_PRESSURE = 1013.25


@dataclass
class Battery:
    """Charge in mAh, current in A."""

    capacity: float
    used: float = 0.0
    current: float = IDLE_CURRENT

    @property
    def remaining(self) -> int:
        """Per cent left."""
        return max(0, min(100, round(100.0 * (1.0 - self.used / max(self.capacity, 1.0)))))

    @property
    def voltage(self) -> float:
        """Volts at the terminals."""
        left = max(0.0, 1.0 - self.used / max(self.capacity, 1.0))
        # Steep at both ends and flat between, as lithium cells are.
        cell: float = EMPTY_CELL + (FULL_CELL - EMPTY_CELL) * (0.75 * left + 0.25 * left**0.25)
        return CELLS * (cell - CELL_RESISTANCE * self.current)

    def step(self, dt: float, copter: Copter, powered: bool) -> None:
        """Use up charge for `dt` seconds."""
        if not powered:
            self.current = IDLE_CURRENT
        elif copter.landed:
            self.current = TURNING_CURRENT
        else:
            lean = math.cos(copter.roll) * math.cos(copter.pitch)
            self.current = max(HOVER_CURRENT / lean + CLIMB_CURRENT * copter.climb, 4.0)
        self.used += self.current * dt / 3.6


class Sensors:
    """GPS and noise of one vehicle; everything random comes from `random`."""

    def __init__(self, random: Random, copter: Copter, gps_delay: float) -> None:
        self.random = random
        self.copter = copter
        self.gps_delay = gps_delay
        self.noise = [0.0] * NOISES
        self.seconds = 0.0
        self._next_noise = 0.0

    @property
    def gps_fix(self) -> int:
        """GPS_FIX_TYPE: none at first, 3D after `gps_delay` seconds."""
        if self.seconds >= self.gps_delay:
            return 3
        return 2 if self.seconds >= 0.7 * self.gps_delay else 1

    @property
    def satellites(self) -> int:
        """Satellites in use."""
        share = 1.0 if not self.gps_delay else min(1.0, self.seconds / self.gps_delay)
        return round(14 * share)

    def step(self, dt: float) -> None:
        """Move on by `dt` seconds."""
        self.seconds += dt
        if self.seconds >= self._next_noise:
            self._next_noise += NOISE_INTERVAL
            gauss = self.random.gauss
            self.noise = [0.9 * old + gauss(0, 0.1) for old in self.noise]

    def gps_place(self) -> Place:
        """Where the GPS says it is: within about half a metre."""
        place, noise = self.copter.place, self.noise
        shift = 0.5 / METRES_PER_DEGREE
        return Place(
            place.lat + noise[0] * shift, place.lon + noise[1] * shift, place.alt + noise[2]
        )

    def accel(self) -> tuple[float, float, float]:
        """Accelerometer in m/s2, body frame."""
        x, y, z = self.copter.specific_force()
        noise = self.noise
        return x + 0.05 * noise[3], y + 0.05 * noise[4], z + 0.05 * noise[5]

    def gyro(self) -> tuple[float, float, float]:
        """Gyroscope in rad/s."""
        copter, noise = self.copter, self.noise
        return (
            copter.roll_rate + 0.002 * noise[4],
            copter.pitch_rate + 0.002 * noise[5],
            copter.yaw_rate + 0.002 * noise[6],
        )

    def mag(self) -> tuple[float, float, float]:
        """Magnetometer in milligauss, body frame."""
        return self.copter.body(*FIELD)

    def pressure(self) -> float:
        """Air pressure in hPa."""
        alt: float = self.copter.place.alt + 0.1 * self.noise[7]
        return float(SEA_LEVEL_PRESSURE * (1 - 2.25577e-5 * alt) ** 5.25588)
