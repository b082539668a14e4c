"""Steering from outside: position and velocity targets, sticks, overridden channels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink

from .geo import Local, Place, turned, within_world
from .personality.base import Role
from .physics import Demand
from .plans import GLOBAL, RELATIVE
from .service import Handler, Service
from .tasks import Goto, Task, Velocity

if TYPE_CHECKING:
    from .vehicle import Vehicle

POSITION_IGNORED = 0b000_000_000_111
VELOCITY_IGNORED = 0b000_000_111_000
CLIMB_IGNORED = 0b000_000_100_000
YAW_IGNORED = mavlink.POSITION_TARGET_TYPEMASK_YAW_IGNORE
YAW_RATE_IGNORED = mavlink.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE
# Frames whose axes turn with the vehicle, and those that start where it is.
BODY = frozenset((mavlink.MAV_FRAME_BODY_NED, mavlink.MAV_FRAME_BODY_OFFSET_NED, 12))
OFFSET = BODY | {mavlink.MAV_FRAME_LOCAL_OFFSET_NED}
LOCAL = OFFSET | {mavlink.MAV_FRAME_LOCAL_NED}
# Pulses of untouched channels: sticks centred, throttle low on an ArduPilot.
CENTRE = 1500
LOW = 1000
CHANNELS = 18
RELEASE = 0
IGNORE = 65535


class Guided(Service):
    """The targets and sticks of one vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.last: Task | None = None
        self._overrides: dict[int, int] = {}

    def handlers(self) -> Mapping[str, Handler]:
        return {
            "SET_POSITION_TARGET_LOCAL_NED": self._on_local,
            "SET_POSITION_TARGET_GLOBAL_INT": self._on_global,
            "MANUAL_CONTROL": self._on_manual_control,
            "RC_CHANNELS_OVERRIDE": self._on_override,
        }

    @property
    def channels(self) -> list[int]:
        """Pulses of the RC channels, as overridden."""
        usual = [CENTRE, CENTRE, LOW, CENTRE, *[LOW] * 12, 0, 0]
        return [self._overrides.get(number, pulse) for number, pulse in enumerate(usual)][:CHANNELS]

    # -- targets

    def _on_local(self, msg: Any) -> None:
        if msg.coordinate_frame not in LOCAL:
            return
        copter = self.vehicle.copter
        north, east = msg.x, msg.y
        if msg.coordinate_frame in BODY:
            north, east = turned(msg.x, msg.y, copter.yaw)
        up = -msg.z
        if msg.coordinate_frame in OFFSET:
            north, east, up = copter.north + north, copter.east + east, copter.up + up
        self._target(msg, within_world(Local(north, east, up)))

    def _on_global(self, msg: Any) -> None:
        if msg.coordinate_frame not in GLOBAL:
            return
        alt = msg.alt
        if msg.coordinate_frame in RELATIVE:
            alt += self.vehicle.autopilot.home_place.alt
        place = Place(msg.lat_int / 1e7, msg.lon_int / 1e7, alt)
        self._target(msg, self.vehicle.copter.origin.local(place))

    def _target(self, msg: Any, target: Local) -> None:
        """Make the target the task, where the mode takes targets."""
        pilot, mask = self.vehicle.autopilot, msg.type_mask
        values = (*target, msg.vx, msg.vy, msg.vz, msg.yaw, msg.yaw_rate)
        if not all(map(math.isfinite, self._used(mask, values))):
            return
        yaw = None if mask & YAW_IGNORED else msg.yaw
        task: Task | None = None
        if mask & POSITION_IGNORED == 0:
            task = Goto(target, yaw=yaw, face=True, lift=pilot.personality.targets_lift)
        elif mask & VELOCITY_IGNORED != VELOCITY_IGNORED:
            north, east = msg.vx, msg.vy
            if msg.coordinate_frame in BODY:
                north, east = turned(msg.vx, msg.vy, self.vehicle.copter.yaw)
            rate = None if mask & YAW_RATE_IGNORED else msg.yaw_rate
            hold = target.up if mask & CLIMB_IGNORED else None
            task = Velocity(Demand(north, east, -msg.vz, yaw, rate), hold)
        if task is None:
            return
        self.last = task
        pilot.setpoint_age = 0.0
        if pilot.mode.role is pilot.personality.mode_of(Role.OFFBOARD).role:
            pilot.task = task

    @staticmethod
    def _used(mask: int, values: tuple[float, ...]) -> list[float]:
        """The values that the mask does not leave out."""
        bits = (1, 2, 4, 8, 16, 32, YAW_IGNORED, YAW_RATE_IGNORED)
        return [value for bit, value in zip(bits, values, strict=True) if not mask & bit]

    # -- sticks

    def _on_manual_control(self, msg: Any) -> None:
        throttle = msg.z / 500.0 - 1.0
        self._move(msg.y / 1000.0, -msg.x / 1000.0, throttle, msg.r / 1000.0)

    def _on_override(self, msg: Any) -> None:
        for number in range(CHANNELS):
            pulse = getattr(msg, f"chan{number + 1}_raw", 0)
            if pulse == IGNORE or (number >= 8 and pulse == 0):
                continue
            if pulse == RELEASE:
                self._overrides.pop(number, None)
            else:
                self._overrides[number] = pulse
        roll, pitch, throttle, yaw = (
            (self._overrides.get(number, CENTRE) - CENTRE) / 500.0 for number in range(4)
        )
        self._move(roll, pitch, throttle, yaw)

    def _move(self, roll: float, pitch: float, throttle: float, yaw: float) -> None:
        pilot = self.vehicle.autopilot
        pilot.sticks.move(roll, pitch, throttle, yaw)
        if pilot.mode.role is Role.MISSION and throttle > 0 and pilot.armed:
            pilot.start_mission()
