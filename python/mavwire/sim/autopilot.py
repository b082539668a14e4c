"""The part of a vehicle that decides: modes, arming, home, failsafes, and which task is flown.

Commands and messages call its methods; each either does what was asked or raises `RefusedError` with
the reason, which the caller puts into an acknowledgement and a text.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from .geo import Local, Place, turned
from .mission_flight import FlyMission
from .personality.base import Mode, Personality, Role
from .physics import REST, Copter
from .plans import Plan
from .sensors import Battery, Sensors
from .steering import BRAKING, Tuning
from .tasks import ON_GROUND, Goto, Hold, Land, Orbit, Return, Sticks, Takeoff, Task

if TYPE_CHECKING:
    from .vehicle import Vehicle

# The estimator needs this long after the first fix.
ESTIMATOR_DELAY = 1.0
BATTERY_CRITICAL = 5
OFFBOARD_TIMEOUT = 1.0
CIRCLE_RADIUS = 10.0
CIRCLE_SPEED = 2.0


class RefusedError(Exception):
    """The vehicle will not do what it was asked for; the text says why."""


class Autopilot:
    """State of the flight of one vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.personality: Personality = vehicle.personality
        self.copter: Copter = vehicle.copter
        self.sensors: Sensors = vehicle.sensors
        self.battery: Battery = vehicle.battery
        self.mission: Plan = vehicle.plans[0]
        self.tuning: Tuning = vehicle.tuning
        self.mode: Mode = self.personality.modes[self.personality.initial_mode]
        self.armed = False
        self.home: Place | None = None
        self.terminated = False
        self.sticks: Sticks = Sticks(self.copter)
        self.task: Task = Task()
        self.setpoint_age = math.inf
        self._idle = 0.0
        self._flown = False
        self._battery_said = 100
        self._position_was_ok = False
        self._start_task()

    # -- what others ask

    @property
    def position_ok(self) -> bool:
        """Whether it knows where it is."""
        return self.sensors.seconds >= self.sensors.gps_delay + ESTIMATOR_DELAY

    @property
    def home_place(self) -> Place:
        """Home, or the place of switching on before there is one."""
        return self.home or self.copter.origin.place

    @property
    def home_local(self) -> Local:
        """Home in the local frame."""
        return self.copter.origin.local(self.home_place)

    @property
    def height(self) -> float:
        """Metres above home."""
        return self.copter.place.alt - self.home_place.alt

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        return ON_GROUND if self.copter.landed else self.task.landed_state

    @property
    def battery_low(self) -> bool:
        """Whether the battery failsafe has something to say."""
        return self.battery.remaining <= self.tuning.battery_low

    # -- time

    def step(self, dt: float) -> None:
        """Fly on for `dt` seconds."""
        self.setpoint_age += dt
        if self.position_ok and not self._position_was_ok:
            self._position_was_ok = True
            self.set_home(None)
            self.vehicle.position_found()
        demand = self.task.demand(self.copter, self.tuning, dt) if self.armed else REST
        was_landed = self.copter.landed
        self.copter.step(dt, demand, self.armed and not self.terminated)
        self.battery.step(dt, self.copter, self.armed)
        if was_landed != self.copter.landed:
            self._touched(not was_landed)
        if self.armed:
            self._watch(dt, demand.up)

    def _touched(self, landed: bool) -> None:
        self._flown = self._flown or not landed
        if not landed:
            self.vehicle.takeoff_unix_us = self.vehicle.unix_us
        self.vehicle.say("landed" if landed else "took_off")

    def _watch(self, dt: float, climb: float) -> None:
        """Disarming, mode changes and failsafes that nobody asks for."""
        if self.task.done:
            self._task_done()
        if self.copter.landed and climb <= 0:
            self._idle += dt
            self._disarm_idle()
        else:
            self._idle = 0.0
        if self.mode.role is Role.OFFBOARD and self.setpoint_age > OFFBOARD_TIMEOUT:
            self.vehicle.say("offboard_lost")
            self._enter(self.personality.mode_of(Role.HOLD))
        self._watch_battery()

    def _task_done(self) -> None:
        role = self.personality.after(self.mode.role, self.copter.landed)
        if role is not None and role is not self.mode.role:
            if self.mode.role is Role.MISSION:
                self.vehicle.say("mission_done")
            self._enter(self.personality.mode_of(role))

    def _disarm_idle(self) -> None:
        ended = self._flown and (self.mode.role in (Role.LAND, Role.RETURN) or self.task.done)
        delay = self.tuning.landed_disarm_delay if ended else self.tuning.disarm_delay
        if delay >= 0 and self._idle >= delay:
            self.disarm(reason="disarmed_landing" if ended else "disarmed_idle", force=True)

    def _watch_battery(self) -> None:
        remaining, low = self.battery.remaining, self.tuning.battery_low
        for level, phrase in ((low, "battery_low"), (BATTERY_CRITICAL, "battery_critical")):
            if remaining <= level < self._battery_said:
                self._battery_said = remaining
                self.vehicle.say(phrase)
                self._battery_failsafe(Role.RETURN if level == low else Role.LAND)

    def _battery_failsafe(self, role: Role) -> None:
        if not self.copter.landed and self.mode.role not in (role, Role.LAND):
            self._enter(self.personality.mode_of(role))

    # -- modes

    def set_mode(self, mode: Mode) -> None:
        """Change the mode; RefusedError when it cannot work now."""
        if mode is self.mode:
            return
        if mode.position and not self.position_ok:
            raise RefusedError(self.vehicle.phrase("mode_position", mode=mode.name))
        if mode.role is Role.MISSION:
            reason = self.personality.mission_refusal(self)
            if reason:
                raise RefusedError(
                    self.vehicle.phrase("mode_failed", mode=mode.name, reason=reason)
                )
        if mode.role is Role.OFFBOARD and self.setpoint_age > OFFBOARD_TIMEOUT:
            raise RefusedError(
                self.vehicle.phrase("mode_failed", mode=mode.name, reason="no setpoints")
            )
        self._enter(mode)

    def set_role(self, role: Role) -> None:
        """Change to the mode that does `role`."""
        self.set_mode(self.personality.mode_of(role))

    def _enter(self, mode: Mode) -> None:
        setpoint = self.task if mode.role is Role.OFFBOARD else None
        self.mode = mode
        self._start_task()
        if setpoint is not None and self.vehicle.guided.last is not None:
            self.task = self.vehicle.guided.last
        self.vehicle.streams.send("HEARTBEAT")

    def _start_task(self) -> None:
        self.task = _TASKS[self.mode.role](self)

    def _stay(self) -> Task:
        """Keep the place that was just reached, or brake and keep where that ends."""
        copter, before = self.copter, self.task
        if before.done and isinstance(before, Goto | Takeoff | FlyMission) and before.target:
            return Hold(before.target)
        ahead = copter.groundspeed / (2 * BRAKING)
        return Hold(
            Local(copter.north + copter.vn * ahead, copter.east + copter.ve * ahead, copter.up)
        )

    def _mission(self) -> Task:
        mission = FlyMission(self, self.mission)
        mission.waiting = self.copter.landed and self.personality.mission_waits(self)
        return mission

    def _take_off(self) -> Task:
        here = self.copter.local
        up = self.home_local.up + self.tuning.takeoff_height
        return Takeoff(here._replace(up=max(up, here.up)))

    def _circle(self) -> Task:
        north, east = turned(CIRCLE_RADIUS, 0.0, self.copter.yaw)
        here = self.copter.local
        centre = Local(here.north + north, here.east + east, here.up)
        return Orbit(centre, CIRCLE_RADIUS, CIRCLE_SPEED)

    # -- arming

    def arm(self, force: bool = False) -> None:
        """Start the motors; RefusedError with the first failed check unless forced."""
        if self.armed:
            return
        if not force:
            failures = self.personality.arming_failures(self)
            if failures:
                raise RefusedError(failures[0])
        self.armed = True
        self.vehicle.armed_unix_us = self.vehicle.unix_us
        self._idle = 0.0
        self._flown = False
        if self.position_ok:
            self.set_home(None)
        self._start_task()
        self.vehicle.say("armed")
        self.vehicle.streams.send("HEARTBEAT")

    def disarm(self, force: bool = False, reason: str = "disarmed") -> None:
        """Stop the motors; RefusedError in the air unless forced."""
        if not self.armed:
            return
        if not self.copter.landed and not force:
            raise RefusedError(self.vehicle.phrase("disarm_flying"))
        self.armed = False
        self.vehicle.say(reason)
        self.vehicle.streams.send("HEARTBEAT")
        role = self.personality.after_disarming(self.mode.role)
        if role is not None:
            self._enter(self.personality.mode_of(role))

    def terminate(self) -> None:
        """Flight termination: the motors stop, in the air too."""
        self.terminated = True
        self.vehicle.say("terminated")

    def set_home(self, place: Place | None) -> None:
        """Home is `place`, or here."""
        origin = self.copter.origin
        self.home = origin.globe(origin.local(place)) if place else self.copter.place
        if self.personality.first_mission_item == 1:
            self.mission.set_home(self.home)
        self.vehicle.streams.send("HOME_POSITION")

    # -- tasks by command

    def take_off(self, up: float | None) -> None:
        """Climb to `up` metres in the local frame, or to the usual height."""
        if not self.copter.landed:
            raise RefusedError(self.vehicle.phrase("takeoff_flying"))
        if not self.position_ok:
            raise RefusedError(self.vehicle.phrase("takeoff_position"))
        self.personality.prepare_takeoff(self)
        task = self._take_off()
        if up is not None:
            task = Takeoff(self.copter.local._replace(up=up))
        self.task = task

    def go_to(self, target: Local, speed: float | None = None, yaw: float | None = None) -> None:
        """Fly to a point."""
        self.task = Goto(target, speed, yaw)

    def orbit(self, centre: Local, radius: float, speed: float) -> None:
        """Circle around a point."""
        self.task = Orbit(centre, radius, speed)

    # -- the mission

    def start_mission(self) -> None:
        """Begin to fly the mission; RefusedError when not armed or without a mission."""
        self.set_role(Role.MISSION)
        if isinstance(self.task, FlyMission):
            self.task.waiting = False

    def set_mission_current(self, seq: int) -> None:
        """Continue the mission at `seq`; RefusedError when there is no such item."""
        if not 0 <= seq < len(self.mission):
            raise RefusedError(f"no mission item {seq}")
        self.mission.current = seq
        self.mission.complete = False
        if isinstance(self.task, FlyMission):
            self.task.restart()
        self.vehicle.streams.send("MISSION_CURRENT")

    def mission_changed(self) -> None:
        """There is a new mission: one that is being flown starts anew."""
        if self.mode.role is Role.MISSION:
            self._start_task()


_TASKS: dict[Role, Callable[[Autopilot], Task]] = {
    Role.MANUAL: lambda pilot: pilot.sticks,
    Role.HOLD: Autopilot._stay,
    Role.GUIDED: Autopilot._stay,
    Role.OFFBOARD: Autopilot._stay,
    Role.MISSION: Autopilot._mission,
    Role.RETURN: lambda pilot: Return(pilot.home_local, pilot.copter, pilot.tuning),
    Role.LAND: lambda pilot: Land(pilot.copter.local._replace(up=0.0)),
    Role.TAKEOFF: Autopilot._take_off,
    Role.CIRCLE: Autopilot._circle,
}
