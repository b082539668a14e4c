"""A PX4 multicopter: modes in two bytes, parameters byte by byte, altitudes above sea level."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, ClassVar

from mavwire.dialects.v20 import all as mavlink

from ..geo import Place
from ..plans import RELATIVE
from ..steering import Tuning
from . import px4_events
from .base import Mode, Personality, Role
from .common import (
    AUTO,
    CAPABILITIES,
    COMMANDS,
    CUSTOM,
    GUIDED,
    MANUAL_INPUT,
    MISSION_COMMANDS,
    STABILIZE,
)
from .px4_params import PARAMS

if TYPE_CHECKING:
    from ..autopilot import Autopilot
    from ..vehicle import Vehicle

CRITICAL = mavlink.MAV_SEVERITY_CRITICAL
WARNING = mavlink.MAV_SEVERITY_WARNING
INFO = mavlink.MAV_SEVERITY_INFO

BY_HAND = CUSTOM | STABILIZE | MANUAL_INPUT
BY_ITSELF = CUSTOM | STABILIZE | GUIDED | AUTO
MAIN_AUTO = 4
SUB_LOITER = 3


def _custom(main: int, sub: int = 0) -> int:
    """The number of a mode: the main mode in the third byte, the sub mode in the fourth."""
    return main << 16 | sub << 24


def _modes() -> dict[str, Mode]:
    modes = [
        Mode("MANUAL", _custom(1), Role.MANUAL, BY_HAND, position=False),
        Mode("ALTCTL", _custom(2), Role.MANUAL, BY_HAND, position=False,
             standard=mavlink.MAV_STANDARD_MODE_ALTITUDE_HOLD),
        Mode("POSCTL", _custom(3), Role.MANUAL, BY_HAND,
             standard=mavlink.MAV_STANDARD_MODE_POSITION_HOLD),
        Mode("ACRO", _custom(5), Role.MANUAL, CUSTOM | MANUAL_INPUT, position=False),
        Mode("OFFBOARD", _custom(6), Role.OFFBOARD, CUSTOM | STABILIZE | GUIDED),
        Mode("STABILIZED", _custom(7), Role.MANUAL, BY_HAND, position=False),
        Mode("TAKEOFF", _custom(MAIN_AUTO, 2), Role.TAKEOFF, BY_ITSELF,
             standard=mavlink.MAV_STANDARD_MODE_TAKEOFF),
        Mode("LOITER", _custom(MAIN_AUTO, SUB_LOITER), Role.GUIDED, BY_ITSELF, position=False),
        Mode("MISSION", _custom(MAIN_AUTO, 4), Role.MISSION, BY_ITSELF,
             standard=mavlink.MAV_STANDARD_MODE_MISSION),
        Mode("RTL", _custom(MAIN_AUTO, 5), Role.RETURN, BY_ITSELF, armable=False,
             standard=mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY),
        Mode("LAND", _custom(MAIN_AUTO, 6), Role.LAND, BY_ITSELF, position=False, armable=False,
             standard=mavlink.MAV_STANDARD_MODE_LAND),
        Mode("ORBIT", _custom(3, 1), Role.CIRCLE, BY_HAND, selectable=False,
             standard=mavlink.MAV_STANDARD_MODE_ORBIT),
    ]  # fmt: skip
    return {mode.name: mode for mode in modes}


class Px4(Personality):
    """PX4 1.15."""

    name = "px4"
    autopilot = mavlink.MAV_AUTOPILOT_PX4
    home = Place(47.397742, 8.545594, 488.0)
    initial_mode = "LOITER"
    modes = _modes()
    roles: ClassVar = {
        Role.MANUAL: "POSCTL",
        Role.HOLD: "LOITER",
        Role.GUIDED: "LOITER",
        Role.OFFBOARD: "OFFBOARD",
        Role.MISSION: "MISSION",
        Role.RETURN: "RTL",
        Role.LAND: "LAND",
        Role.TAKEOFF: "TAKEOFF",
        Role.CIRCLE: "ORBIT",
    }
    sends_events = True
    phrases: ClassVar = {
        "position_ok": (INFO, "Ready for takeoff!"),
        "armed": (INFO, "Armed by external command"),
        "disarmed": (INFO, "Disarmed by external command"),
        "disarmed_landing": (INFO, "Disarmed by landing"),
        "disarmed_idle": (INFO, "Disarmed by auto preflight disarming"),
        "disarm_flying": (CRITICAL, "Disarming denied: not landed"),
        "took_off": (INFO, "Takeoff detected"),
        "landed": (INFO, "Landing detected"),
        "terminated": (CRITICAL, "Flight termination active"),
        "takeoff_flying": (CRITICAL, "Already flying"),
        "takeoff_position": (CRITICAL, "Takeoff denied: no global position"),
        "mode_position": (CRITICAL, "Switching to mode '{mode}' is currently not available"),
        "mode_failed": (CRITICAL, "Switching to mode '{mode}' is not available: {reason}"),
        "mission_done": (INFO, "Mission finished, loitering"),
        "mission_new": (INFO, "New mission received"),
        "offboard_lost": (CRITICAL, "Offboard control lost"),
        "battery_low": (WARNING, "Low battery level, return advised"),
        "battery_critical": (CRITICAL, "Emergency battery level, landing"),
        "param_unknown": (WARNING, "unknown param: {name}"),
        "param_type": (CRITICAL, "param types mismatch param: {name}"),
        "rebooting": (INFO, "Rebooting"),
    }
    params = PARAMS
    bytewise_params = True
    sysid_param = "MAV_SYS_ID"
    capabilities = CAPABILITIES | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    version = (1, 15, 4)
    version_text = "PX4 1.15.4 (mavwire)"
    commands = COMMANDS | {mavlink.MAV_CMD_DO_ORBIT, mavlink.MAV_CMD_DO_SET_STANDARD_MODE}
    mission_commands = MISSION_COMMANDS | {mavlink.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL}
    streams: ClassVar = {
        "HEARTBEAT": 1.0, "ATTITUDE": 10.0, "ATTITUDE_QUATERNION": 10.0, "ALTITUDE": 1.0,
        "GLOBAL_POSITION_INT": 5.0, "LOCAL_POSITION_NED": 5.0, "GPS_RAW_INT": 1.0,
        "VFR_HUD": 4.0, "SYS_STATUS": 1.0, "EXTENDED_SYS_STATE": 1.0, "BATTERY_STATUS": 0.5,
        "HOME_POSITION": 0.5, "ESTIMATOR_STATUS": 0.5, "VIBRATION": 0.1,
        "POSITION_TARGET_GLOBAL_INT": 1.0, "POSITION_TARGET_LOCAL_NED": 1.0,
        "SERVO_OUTPUT_RAW": 1.0, "SYSTEM_TIME": 1.0, "MISSION_CURRENT": 1.0,
        "NAV_CONTROLLER_OUTPUT": 1.0, "CURRENT_MODE": 0.5, "SCALED_IMU": 1.0, "PING": 0.1,
    }  # fmt: skip
    first_mission_item = 0
    guided_items = False
    mission_needs_arming = False
    targets_lift = True
    reposition_changes_mode = True
    set_mode_ack = mavlink.MAV_CMD_DO_SET_MODE
    packed_params = False
    mission_request_int = True
    waypoint_yaw = True
    ftp_client_sessions = False
    refusal = mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    unknown_interval = mavlink.MAV_RESULT_FAILED

    def requested_mode(self, base_mode: int, custom: int, sub: int) -> Mode | None:
        if not base_mode & CUSTOM:
            return None
        if custom == MAIN_AUTO and sub == 0:
            sub = SUB_LOITER
        return self.mode_by_custom(_custom(custom & 0xFF, sub & 0xFF))

    def system_status(self, autopilot: Autopilot) -> int:
        if autopilot.terminated:
            return mavlink.MAV_STATE_FLIGHT_TERMINATION
        return mavlink.MAV_STATE_ACTIVE if autopilot.armed else mavlink.MAV_STATE_STANDBY

    def after(self, role: Role, landed: bool) -> Role | None:
        if role is Role.TAKEOFF:
            return Role.HOLD
        return Role.HOLD if role is Role.MISSION and not landed else None

    def after_disarming(self, role: Role) -> Role | None:
        ended = (Role.TAKEOFF, Role.LAND, Role.RETURN, Role.MISSION, Role.OFFBOARD)
        return Role.HOLD if role in ended else None

    def prepare_takeoff(self, autopilot: Autopilot) -> None:
        autopilot.set_role(Role.TAKEOFF)

    def mission_refusal(self, autopilot: Autopilot) -> str | None:
        return None if autopilot.mission.items else "no valid mission"

    def arming_failures(self, autopilot: Autopilot) -> list[str]:
        failures = []
        if not autopilot.position_ok and not autopilot.vehicle.params["COM_ARM_WO_GPS"]:
            failures.append("Arming denied: Resolve system health failures first")
        if not autopilot.mode.armable:
            failures.append(f"Arming denied: not in mode {autopilot.mode.name}")
        if autopilot.battery_low:
            failures.append("Arming denied: low battery")
        return failures

    def command_altitude(self, autopilot: Autopilot, altitude: float, frame: int | None) -> float:
        if not math.isfinite(altitude):
            return autopilot.copter.place.alt
        return altitude + autopilot.home_place.alt if frame in RELATIVE else altitude

    def tuning(self, params: Mapping[str, float], tuning: Tuning) -> None:
        tuning.cruise_speed = params["MPC_XY_CRUISE"]
        tuning.climb_speed = params["MPC_Z_VEL_MAX_UP"]
        tuning.descent_speed = params["MPC_Z_VEL_MAX_DN"]
        tuning.land_speed = params["MPC_LAND_SPEED"]
        tuning.slow_below = params["MPC_LAND_ALT2"]
        tuning.arrival_radius = params["NAV_ACC_RAD"]
        tuning.return_height = params["RTL_RETURN_ALT"]
        tuning.return_loiter = max(params["RTL_LAND_DELAY"], 0.0)
        tuning.takeoff_height = params["MIS_TAKEOFF_ALT"]
        tuning.disarm_delay = params["COM_DISARM_PRFLT"] or -1.0
        tuning.landed_disarm_delay = params["COM_DISARM_LAND"] or -1.0
        tuning.battery_capacity = params["BAT1_CAPACITY"]
        tuning.battery_low = 100 * params["BAT_LOW_THR"]

    def files(self, vehicle: Vehicle) -> Mapping[str, bytes]:
        return {
            "/fs/microsd/etc/readme.txt": b"Settings of the simulated vehicle go here.\n",
            "/fs/microsd/log/readme.txt": b"The simulated vehicle keeps no logs.\n",
            "/fs/microsd/parameters.bson": b"\x05\x00\x00\x00\x00",
            **px4_events.files(self.phrases),
            "/etc/version.txt": self.version_text.encode() + b"\n",
        }

    def banner(self, vehicle: Vehicle) -> Iterable[str]:
        return ()
