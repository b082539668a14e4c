"""The action of each command. An action raises RefusedError, or returns a MAV_RESULT, or None when done."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavwire.dialects.v20 import all as mavlink

from .autopilot import RefusedError
from .commands import DENIED, UNSUPPORTED, Action, Command, destination
from .geo import Local
from .personality.base import Role

if TYPE_CHECKING:
    from .vehicle import Vehicle

FORCE_ARM = 2989
FORCE = 21196
REBOOT = 1
REBOOT_ANYWAY = 20190226
ORBIT_SPEED = 3.0
RESET_PARAMETERS = 2


def _arm(vehicle: Vehicle, command: Command) -> int | None:
    force = command.integer(2) in (FORCE, FORCE_ARM)
    if command.param(1, -1) == 1:
        vehicle.autopilot.arm(force)
    elif command.param(1, -1) == 0:
        vehicle.autopilot.disarm(force)
    else:
        return UNSUPPORTED
    return None


def _take_off(vehicle: Vehicle, command: Command) -> None:
    has_height = math.isfinite(command.z) and command.z
    vehicle.autopilot.take_off(destination(vehicle, command).up if has_height else None)


def _enter(role: Role) -> Action:
    return lambda vehicle, command: vehicle.autopilot.set_role(role)


def _set_mode(vehicle: Vehicle, command: Command) -> int | None:
    mode = vehicle.personality.requested_mode(
        command.integer(1), command.integer(2), command.integer(3)
    )
    if mode is None:
        return DENIED
    vehicle.autopilot.set_mode(mode)
    return None


def _set_standard_mode(vehicle: Vehicle, command: Command) -> int | None:
    wanted = command.integer(1)
    for mode in vehicle.personality.modes.values():
        if wanted and mode.standard == wanted and mode.selectable:
            vehicle.autopilot.set_mode(mode)
            return None
    return UNSUPPORTED


def _change_speed(vehicle: Vehicle, command: Command) -> int | None:
    if command.param(2) <= 0:
        return DENIED
    kind, speed = command.integer(1), command.param(2)
    tuning = vehicle.tuning
    if kind == 2:
        tuning.climb_speed = speed
    elif kind == 3:
        tuning.descent_speed = speed
    else:
        tuning.cruise_speed = speed
    return None


def _set_home(vehicle: Vehicle, command: Command) -> None:
    pilot = vehicle.autopilot
    if command.integer(1) == 1:
        pilot.set_home(None)
        return
    there = destination(vehicle, command)
    place = vehicle.copter.origin.globe(Local(there.north, there.east, 0.0))
    # The altitude of a home is above sea level, in relative frames too.
    pilot.set_home(place._replace(alt=command.param(7, place.alt)))


def _reposition(vehicle: Vehicle, command: Command) -> None:
    pilot = vehicle.autopilot
    change_mode = command.integer(2) & 1 or vehicle.personality.reposition_changes_mode
    if pilot.mode.role is not Role.GUIDED:
        if not change_mode:
            raise RefusedError("Reposition: not in guided mode")
        pilot.set_role(Role.GUIDED)
    speed = command.param(1, -1)
    yaw = command.params[3]
    # Radians here, unlike the degrees of waypoints; ArduPilot turns the nose along the way.
    heading = yaw if vehicle.personality.waypoint_yaw and math.isfinite(yaw) else None
    pilot.go_to(destination(vehicle, command), speed if speed > 0 else None, heading)


def _orbit(vehicle: Vehicle, command: Command) -> None:
    pilot = vehicle.autopilot
    if vehicle.copter.landed:
        raise RefusedError("Orbit: not flying")
    radius = command.param(1, 10.0)
    speed = command.param(2, ORBIT_SPEED) or ORBIT_SPEED
    centre = destination(vehicle, command)
    pilot.set_role(Role.CIRCLE)
    pilot.orbit(centre, radius, speed)


def _yaw(vehicle: Vehicle, command: Command) -> int | None:
    pilot = vehicle.autopilot
    if pilot.mode.role is not Role.GUIDED:
        return vehicle.personality.refusal
    angle = math.radians(command.param(1))
    if command.integer(4) == 1:
        angle = vehicle.copter.yaw + math.copysign(1, command.param(3, 1) or 1) * angle
    here = vehicle.copter.local
    pilot.go_to(pilot.task.target or here, yaw=angle)
    return None


def _pause(vehicle: Vehicle, command: Command) -> None:
    vehicle.autopilot.set_role(Role.HOLD if command.integer(1) == 0 else Role.MISSION)


def _mission_start(vehicle: Vehicle, command: Command) -> None:
    if vehicle.personality.mission_needs_arming and not vehicle.autopilot.armed:
        raise RefusedError("Mission start: not armed")
    vehicle.autopilot.start_mission()


def _mission_current(vehicle: Vehicle, command: Command) -> None:
    seq = command.integer(1)
    vehicle.autopilot.set_mission_current(vehicle.plans[0].current if seq < 0 else seq)


def _set_servo(vehicle: Vehicle, command: Command) -> int | None:
    channel, pulse = command.integer(1), command.integer(2)
    if not (1 <= channel <= 16 and 0 <= pulse <= 2500):
        return DENIED
    vehicle.servos[channel] = pulse
    return None


def _terminate(vehicle: Vehicle, command: Command) -> None:
    if command.param(1) > 0.5:
        vehicle.autopilot.terminate()


def _reboot(vehicle: Vehicle, command: Command) -> int | None:
    if command.integer(1) not in (REBOOT, 3):
        return DENIED if command.integer(1) else None
    if vehicle.autopilot.armed and command.integer(6) != REBOOT_ANYWAY:
        return vehicle.personality.refusal
    vehicle.reboot()
    return None


def _storage(vehicle: Vehicle, command: Command) -> None:
    if command.integer(1) == RESET_PARAMETERS:
        vehicle.params.reset()


def _calibrate(vehicle: Vehicle, command: Command) -> int | None:
    return vehicle.personality.refusal if vehicle.autopilot.armed else None


def _prearm(vehicle: Vehicle, command: Command) -> None:
    for failure in vehicle.personality.arming_failures(vehicle.autopilot):
        vehicle.text(mavlink.MAV_SEVERITY_CRITICAL, failure)


def _accept(vehicle: Vehicle, command: Command) -> None:
    """Nothing that could be seen from outside."""


# -- requests for messages


def _set_interval(vehicle: Vehicle, command: Command) -> int | None:
    known = vehicle.streams.set_interval(command.integer(1), command.param(2, -1.0))
    return None if known else vehicle.personality.unknown_interval


def _get_interval(vehicle: Vehicle, command: Command) -> None:
    vehicle.answers.request(mavlink.MAVLINK_MSG_ID_MESSAGE_INTERVAL, command.integer(1))


def _request_message(vehicle: Vehicle, command: Command) -> int | None:
    return None if vehicle.answers.request(command.integer(1), command.integer(2)) else UNSUPPORTED


def _protocol_version(vehicle: Vehicle, command: Command) -> None:
    vehicle.answers.send_protocol_version()


def _version(vehicle: Vehicle, command: Command) -> None:
    vehicle.streams.send("AUTOPILOT_VERSION")


def _home_position(vehicle: Vehicle, command: Command) -> int | None:
    if vehicle.autopilot.home is None:
        return vehicle.personality.refusal
    vehicle.streams.send("HOME_POSITION")
    return None


ACTIONS: dict[int, Action] = {
    mavlink.MAV_CMD_COMPONENT_ARM_DISARM: _arm,
    mavlink.MAV_CMD_NAV_TAKEOFF: _take_off,
    mavlink.MAV_CMD_NAV_LAND: _enter(Role.LAND),
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: _enter(Role.RETURN),
    mavlink.MAV_CMD_NAV_LOITER_UNLIM: _enter(Role.HOLD),
    mavlink.MAV_CMD_DO_SET_MODE: _set_mode,
    mavlink.MAV_CMD_DO_SET_STANDARD_MODE: _set_standard_mode,
    mavlink.MAV_CMD_DO_CHANGE_SPEED: _change_speed,
    mavlink.MAV_CMD_DO_SET_HOME: _set_home,
    mavlink.MAV_CMD_DO_REPOSITION: _reposition,
    mavlink.MAV_CMD_DO_ORBIT: _orbit,
    mavlink.MAV_CMD_CONDITION_YAW: _yaw,
    mavlink.MAV_CMD_DO_PAUSE_CONTINUE: _pause,
    mavlink.MAV_CMD_MISSION_START: _mission_start,
    mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: _mission_current,
    mavlink.MAV_CMD_DO_SET_SERVO: _set_servo,
    mavlink.MAV_CMD_DO_FLIGHTTERMINATION: _terminate,
    mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: _reboot,
    mavlink.MAV_CMD_PREFLIGHT_STORAGE: _storage,
    mavlink.MAV_CMD_PREFLIGHT_CALIBRATION: _calibrate,
    mavlink.MAV_CMD_RUN_PREARM_CHECKS: _prearm,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: _set_interval,
    mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: _get_interval,
    mavlink.MAV_CMD_REQUEST_MESSAGE: _request_message,
    mavlink.MAV_CMD_REQUEST_PROTOCOL_VERSION: _protocol_version,
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: _version,
    mavlink.MAV_CMD_GET_HOME_POSITION: _home_position,
    mavlink.MAV_CMD_DO_SET_RELAY: _accept,
    mavlink.MAV_CMD_DO_MOTOR_TEST: _accept,
    mavlink.MAV_CMD_DO_FENCE_ENABLE: _accept,
    mavlink.MAV_CMD_DO_SET_ROI: _accept,
    mavlink.MAV_CMD_DO_SET_ROI_LOCATION: _accept,
    mavlink.MAV_CMD_DO_SET_ROI_NONE: _accept,
}
"""MAV_CMD -> action; which of them a vehicle knows is its personality's business."""
