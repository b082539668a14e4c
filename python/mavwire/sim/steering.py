"""Velocities that bring a copter to a point without overshooting it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .geo import Local, bearing, clamp, distance
from .physics import Copter, Demand

POSITION_GAIN = 0.8
# Braking within what the lean allows, and a little less.
BRAKING = 2.0
CLIMB_BRAKING = 1.5
# Closer than this the heading stays: the bearing of a point underfoot is noise.
FACE_BEYOND = 3.0


@dataclass
class Tuning:
    """The settings of a flight that parameters give: m/s, m, seconds, mAh."""

    cruise_speed: float = 5.0
    climb_speed: float = 2.5
    descent_speed: float = 1.5
    land_speed: float = 0.5
    slow_below: float = 10.0
    arrival_radius: float = 2.0
    return_height: float = 15.0
    takeoff_height: float = 2.5
    disarm_delay: float = 10.0
    landed_disarm_delay: float = 1.0
    return_loiter: float = 5.0
    battery_capacity: float = 5200.0
    battery_low: float = 20.0


def approach(away: float, speed: float, gain: float, braking: float) -> float:
    """Speed at which to cover `away` metres: proportional when near, then what still can stop."""
    near = braking / (gain * gain)
    if abs(away) <= near:
        wanted = gain * away
    else:
        wanted = math.copysign(math.sqrt(2 * braking * (abs(away) - near / 2)), away)
    return clamp(wanted, speed)


def climb_to(copter: Copter, up: float, tuning: Tuning) -> float:
    """Climb rate towards a height."""
    wanted = approach(up - copter.up, 99.0, POSITION_GAIN, CLIMB_BRAKING)
    return max(-tuning.descent_speed, min(tuning.climb_speed, wanted))


def fly_to(
    copter: Copter,
    target: Local,
    tuning: Tuning,
    speed: float | None = None,
    yaw: float | None = None,
    face: bool = False,
) -> Demand:
    """Straight to `target`, at `speed` or the cruise speed; `face` turns the nose along the way."""
    away = distance(copter.local, target)
    rate = approach(away, speed or tuning.cruise_speed, POSITION_GAIN, BRAKING)
    demand = Demand(up=climb_to(copter, target.up, tuning), yaw=yaw)
    if away > 0.01:
        demand.north = (target.north - copter.north) / away * rate
        demand.east = (target.east - copter.east) / away * rate
    if yaw is None and face and away > FACE_BEYOND:
        demand.yaw = bearing(copter.local, target)
    return demand


def arrived(copter: Copter, target: Local, radius: float) -> bool:
    """Whether the copter is at `target`, within `radius` metres in each direction."""
    return distance(copter.local, target) < radius and abs(copter.up - target.up) < radius
