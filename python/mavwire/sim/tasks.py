"""The tasks of a vehicle. Each says, moment by moment, how the copter shall move.

A task knows nothing of messages and modes. The autopilot picks one when the mode or a command
asks for it, and looks at `done`.
"""

from __future__ import annotations

import math

from .geo import Local, bearing, distance, turned, wrap
from .physics import REST, Copter, Demand
from .steering import POSITION_GAIN, Tuning, approach, arrived, climb_to, fly_to

ON_GROUND, IN_AIR, TAKING_OFF, LANDING = 1, 2, 3, 4
# A stream of velocities that stops must not carry the vehicle away.
VELOCITY_TIMEOUT = 3.0
STICK_TIMEOUT = 2.0
STICK_SPEED = 5.0
STICK_YAW_RATE = math.radians(60)
# Full sticks beyond the dead zone around the middle.
DEAD_ZONE = 0.1


class Task:
    """Stays where it is on the ground."""

    landed_state = IN_AIR
    target: Local | None = None
    done = False

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        """How to move during the next `dt` seconds."""
        return REST


class _AtPlace(Task):
    def __init__(self, target: Local) -> None:
        self.target: Local = target


class Hold(_AtPlace):
    """Stays where it was when it began."""

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        return REST if copter.landed else fly_to(copter, self.target, tuning)


class Goto(Task):
    """Flies to a point and stays there; from the ground only with `lift`, and then straight up
    first.
    """

    def __init__(
        self,
        target: Local,
        speed: float | None = None,
        yaw: float | None = None,
        face: bool = True,
        lift: bool = False,
    ) -> None:
        self.target: Local = target
        self.speed, self.yaw, self.face, self.lift = speed, yaw, face, lift
        self._takeoff: Takeoff | None = None

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        if copter.landed:
            if not self.lift or self.target.up <= copter.up:
                return REST
            self._takeoff = Takeoff(copter.local._replace(up=self.target.up))
        if self._takeoff is not None and not self._takeoff.done:
            return self._takeoff.demand(copter, tuning, dt)
        self.done = arrived(copter, self.target, tuning.arrival_radius)
        return fly_to(copter, self.target, tuning, self.speed, self.yaw, self.face)


class Takeoff(_AtPlace):
    """Climbs to a height above its present place."""

    landed_state = TAKING_OFF

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        self.done = self.target.up - copter.up < 0.3
        if self.done:
            self.landed_state = IN_AIR
        demand = fly_to(copter, self.target, tuning)
        if copter.landed:
            demand.up = max(demand.up, 0.5)
        return demand


class Land(_AtPlace):
    """Comes down, on the spot or at a target; slowly near the ground."""

    landed_state = LANDING

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        self.done = copter.landed
        if self.done:
            return REST
        demand = fly_to(copter, self.target, tuning)
        away = distance(copter.local, self.target)
        if away > tuning.arrival_radius:
            demand.up = 0.0
        elif copter.up > tuning.slow_below:
            demand.up = -tuning.descent_speed
        else:
            demand.up = -tuning.land_speed
        return demand


class Return(Task):
    """Climbs, flies home, waits a little, lands."""

    def __init__(self, home: Local, copter: Copter, tuning: Tuning) -> None:
        up = max(copter.up, home.up + tuning.return_height)
        self.target: Local = home._replace(up=up)
        self._climbing = Hold(copter.local._replace(up=up))
        self._land = Land(home)
        self._loiter = tuning.return_loiter
        self._landing = False

    @property
    def landed_state(self) -> int:  # type: ignore[override]
        """Landing only on the last leg."""
        return LANDING if self._landing else IN_AIR

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        if self._landing or copter.landed:
            self.done = copter.landed
            return self._land.demand(copter, tuning, dt)
        if self.target.up - copter.up > 1.0 and distance(copter.local, self.target) > 1.0:
            return self._climbing.demand(copter, tuning, dt)
        if arrived(copter, self.target, tuning.arrival_radius):
            self._loiter -= dt
            self._landing = self._loiter <= 0
        return fly_to(copter, self.target, tuning, face=True)


class Velocity(Task):
    """Keeps a velocity as long as it is renewed, then stops."""

    def __init__(self, demand: Demand, hold_up: float | None = None) -> None:
        self._demand = demand
        self._left = VELOCITY_TIMEOUT
        self._hold_up = hold_up

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        if copter.landed and self._demand.up <= 0:
            return REST
        self._left -= dt
        if self._left < 0:
            return Demand()
        if self._hold_up is not None:
            self._demand.up = climb_to(copter, self._hold_up, tuning)
        return self._demand


class Orbit(Task):
    """Circles around a point, the nose towards it."""

    def __init__(self, centre: Local, radius: float, speed: float, turns: float = 0.0) -> None:
        self.target: Local = centre
        self.radius = max(abs(radius), 1.0)
        self.speed = abs(speed) or 1.0
        self.clockwise = math.copysign(1.0, radius)
        self._left = turns * math.tau if turns else math.inf

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        if copter.landed:
            return REST
        centre = self.target
        angle = bearing(centre, copter.local)
        off = distance(centre, copter.local) - self.radius
        inwards = approach(off, tuning.cruise_speed, POSITION_GAIN, 1.0)
        along = self.speed if abs(off) < self.radius / 2 + 2 else 0.0
        side = angle + self.clockwise * math.pi / 2
        # The pull that keeps it on the circle, as far as the velocity controller lags behind.
        inwards += along * along / self.radius / 1.6
        self._left -= along / self.radius * dt
        self.done = self._left <= 0
        return Demand(
            north=along * math.cos(side) - inwards * math.cos(angle),
            east=along * math.sin(side) - inwards * math.sin(angle),
            up=climb_to(copter, centre.up, tuning),
            yaw=wrap(angle + math.pi),
        )


class Sticks(Task):
    """Flown by hand: sticks from -1 to 1 set velocities; let go of, they keep the place."""

    def __init__(self, copter: Copter) -> None:
        self.roll = self.pitch = self.throttle = self.yaw = 0.0
        self._age = math.inf
        self._hold = Hold(copter.local)

    def move(self, roll: float, pitch: float, throttle: float, yaw: float) -> None:
        """New positions; they are forgotten unless they are renewed."""
        sticks = (roll, pitch, throttle, yaw)
        self.roll, self.pitch, self.throttle, self.yaw = (
            0.0 if abs(value) < DEAD_ZONE else max(-1.0, min(1.0, value)) for value in sticks
        )
        self._age = 0.0

    @property
    def moved(self) -> bool:
        """Whether any stick is off its middle."""
        return self._age < STICK_TIMEOUT and any((self.roll, self.pitch, self.throttle, self.yaw))

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        self._age += dt
        if not self.moved:
            if copter.groundspeed > 0.5 or abs(copter.climb) > 0.3:
                self._hold = Hold(copter.local)
                return REST if copter.landed else Demand()
            return self._hold.demand(copter, tuning, dt)
        self._hold = Hold(copter.local)
        if copter.landed and self.throttle <= 0:
            return REST
        north, east = turned(-self.pitch * STICK_SPEED, self.roll * STICK_SPEED, copter.yaw)
        climb = tuning.climb_speed if self.throttle > 0 else tuning.descent_speed
        return Demand(north, east, self.throttle * climb, yaw_rate=self.yaw * STICK_YAW_RATE)
