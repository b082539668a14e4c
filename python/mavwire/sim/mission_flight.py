"""Flying a mission: one item after the other, each as a task of its own."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from mavwire.dialects.v20 import all as mavlink

from .geo import Local, Place
from .physics import REST, Copter, Demand
from .plans import Item, Plan
from .steering import Tuning
from .tasks import Goto, Hold, Land, Orbit, Return, Takeoff, Task

if TYPE_CHECKING:
    from .autopilot import Autopilot

# Items that are passed at once may form a circle of jumps; a mission must not hang on it.
MAX_PASSED = 100
DEFAULT_RADIUS = 10.0


class Leg:
    """A task that ends when it was done for `wait` seconds; None never ends."""

    def __init__(self, task: Task, wait: float | None = 0.0) -> None:
        self.task = task
        self._wait = wait

    def finished(self, dt: float) -> bool:
        """Whether it is over; to be asked after each step."""
        if self._wait is None or not self.task.done:
            return False
        self._wait -= dt
        return self._wait <= 0


class FlyMission(Task):
    """Works through a plan from its current item on."""

    def __init__(self, autopilot: Autopilot, plan: Plan) -> None:
        self._autopilot = autopilot
        self._plan = plan
        self._leg: Leg | None = None
        self._jumps: dict[int, int] = {}
        self._speed: float | None = None
        self._last: Local | None = None
        self.waiting = False
        first = autopilot.personality.first_mission_item
        if plan.complete or plan.current < first:
            plan.current, plan.complete = first, False

    @property
    def target(self) -> Local | None:  # type: ignore[override]
        """Where the current item leads."""
        return None if self._leg is None else self._leg.task.target

    @property
    def landed_state(self) -> int:  # type: ignore[override]
        """That of the current item."""
        return Task.landed_state if self._leg is None else self._leg.task.landed_state

    def restart(self) -> None:
        """The current item was changed from outside."""
        self._leg = None
        self.done = False
        self._plan.complete = False

    def demand(self, copter: Copter, tuning: Tuning, dt: float) -> Demand:
        if self.waiting:
            return REST
        if self._leg is None and not self.done:
            self._next(copter)
        leg = self._leg
        if leg is None:
            return REST if copter.landed else Demand()
        demand = leg.task.demand(copter, tuning, dt)
        if not self.done and leg.finished(dt):
            self._autopilot.vehicle.mission_reached(self._plan.current)
            self._last = leg.task.target if isinstance(leg.task, Goto | Takeoff) else None
            self._leg = None
            self._plan.current += 1
        return demand

    def _next(self, copter: Copter) -> None:
        """Begin the current item; items that only do something are passed."""
        for _ in range(MAX_PASSED):
            if self._plan.current >= len(self._plan):
                break
            item = self._plan.items[self._plan.current]
            starter = _LEGS.get(item.command)
            if starter is not None:
                self._leg = starter(self, item)
                self._autopilot.vehicle.streams.send("MISSION_CURRENT")
                return
            self._pass(item)
        self._finish(copter)

    def _finish(self, copter: Copter) -> None:
        """Stay at the last place that the mission led to."""
        self._plan.current = max(len(self._plan) - 1, 0)
        self._plan.complete = self.done = True
        at = copter.local if copter.landed else self._last or copter.local
        self._leg = Leg(Hold(at), None)

    def _pass(self, item: Item) -> None:
        """Do what needs no flying."""
        seq = self._plan.current
        if item.command == mavlink.MAV_CMD_DO_JUMP:
            left = self._jumps.setdefault(seq, int(item.param2))
            if left and 0 <= int(item.param1) < len(self._plan):
                self._jumps[seq] = left - 1
                self._plan.current = int(item.param1)
                return
        elif item.command == mavlink.MAV_CMD_DO_CHANGE_SPEED:
            self._speed = item.param2 if item.param2 > 0 else None
        elif item.command == mavlink.MAV_CMD_DO_SET_HOME:
            self._autopilot.set_home(None if item.param1 == 1 else self._place(item))
        self._plan.current += 1

    def _place(self, item: Item) -> Place:
        autopilot = self._autopilot
        return item.place(autopilot.home_place, autopilot.copter.place)

    def _local(self, item: Item) -> Local:
        return self._autopilot.copter.origin.local(self._place(item))

    # -- items that take time

    def _goto(self, item: Item, wait: float | None) -> Leg:
        yaw = None
        if self._autopilot.personality.waypoint_yaw and math.isfinite(item.param4):
            yaw = math.radians(item.param4)
        return Leg(Goto(self._local(item), self._speed, yaw, lift=True), wait)

    def _waypoint(self, item: Item) -> Leg:
        return self._goto(item, _seconds(item.param1))

    def _turns(self, item: Item) -> Leg:
        radius = item.param3 or DEFAULT_RADIUS
        speed = self._speed or self._autopilot.tuning.cruise_speed
        return Leg(Orbit(self._local(item), radius, speed, item.param1 or 1.0))

    def _take_off(self, item: Item) -> Leg:
        return Leg(Takeoff(self._autopilot.copter.local._replace(up=self._local(item).up)))

    def _return(self, item: Item) -> Leg:
        pilot = self._autopilot
        return Leg(Return(pilot.home_local, pilot.copter, pilot.tuning))

    def _delay(self, item: Item) -> Leg:
        hold = Hold(self._autopilot.copter.local)
        hold.done = True
        return Leg(hold, _seconds(item.param1))


def _seconds(value: float) -> float:
    """A delay out of a message; nonsense is none."""
    return value if 0 < value < math.inf else 0.0


_LEGS: dict[int, Callable[[FlyMission, Item], Leg]] = {
    mavlink.MAV_CMD_NAV_WAYPOINT: FlyMission._waypoint,
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT: FlyMission._waypoint,
    mavlink.MAV_CMD_NAV_LOITER_TIME: FlyMission._waypoint,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM: lambda mission, item: mission._goto(item, None),
    mavlink.MAV_CMD_NAV_LOITER_TURNS: FlyMission._turns,
    mavlink.MAV_CMD_NAV_TAKEOFF: FlyMission._take_off,
    mavlink.MAV_CMD_NAV_LAND: lambda mission, item: Leg(
        Land(mission._local(item)._replace(up=0.0))
    ),
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: FlyMission._return,
    mavlink.MAV_CMD_NAV_DELAY: FlyMission._delay,
    mavlink.MAV_CMD_CONDITION_DELAY: FlyMission._delay,
}
