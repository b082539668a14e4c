"""An ArduCopter: modes by number, parameters as floats, home as mission item 0, talkative."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, ClassVar

from mavwire.dialects.v20 import all as mavlink

from ..geo import Place
from ..plans import ABSOLUTE
from ..steering import Tuning
from .ardupilot_params import PARAMS
from .base import Mode, Personality, Role
from .common import (
    CAPABILITIES,
    COMMANDS,
    CUSTOM,
    GUIDED,
    MANUAL_INPUT,
    MISSION_COMMANDS,
    STABILIZE,
    mav_commands,
)

if TYPE_CHECKING:
    from ..autopilot import Autopilot
    from ..vehicle import Vehicle

CRITICAL = mavlink.MAV_SEVERITY_CRITICAL
WARNING = mavlink.MAV_SEVERITY_WARNING
INFO = mavlink.MAV_SEVERITY_INFO

BY_HAND = CUSTOM | STABILIZE | MANUAL_INPUT
BY_ITSELF = BY_HAND | GUIDED
AUTO_ALLOW_ARMING = 1
AUTO_ALLOW_TAKEOFF = 2
LOW_MAH_PER_CENT = 20.0


def _modes() -> dict[str, Mode]:
    modes = [
        Mode("STABILIZE", 0, Role.MANUAL, BY_HAND, position=False),
        Mode("ACRO", 1, Role.MANUAL, CUSTOM | MANUAL_INPUT, position=False),
        Mode("ALT_HOLD", 2, Role.MANUAL, BY_HAND, position=False,
             standard=mavlink.MAV_STANDARD_MODE_ALTITUDE_HOLD),
        Mode("AUTO", 3, Role.MISSION, BY_ITSELF, armable=False,
             standard=mavlink.MAV_STANDARD_MODE_MISSION),
        Mode("GUIDED", 4, Role.GUIDED, BY_ITSELF),
        Mode("LOITER", 5, Role.MANUAL, BY_ITSELF,
             standard=mavlink.MAV_STANDARD_MODE_POSITION_HOLD),
        Mode("RTL", 6, Role.RETURN, BY_ITSELF, armable=False,
             standard=mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY),
        Mode("CIRCLE", 7, Role.CIRCLE, BY_ITSELF, armable=False),
        Mode("LAND", 9, Role.LAND, BY_HAND, position=False, armable=False,
             standard=mavlink.MAV_STANDARD_MODE_LAND),
        Mode("POSHOLD", 16, Role.MANUAL, BY_ITSELF),
        Mode("BRAKE", 17, Role.HOLD, BY_HAND, armable=False),
        Mode("SMART_RTL", 21, Role.RETURN, BY_ITSELF, armable=False),
    ]  # fmt: skip
    return {mode.name: mode for mode in modes}


class ArduPilot(Personality):
    """ArduCopter 4.5."""

    name = "ardupilot"
    autopilot = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    home = Place(-35.363262, 149.165237, 584.0)
    initial_mode = "STABILIZE"
    modes = _modes()
    roles: ClassVar = {
        Role.MANUAL: "STABILIZE",
        Role.HOLD: "LOITER",
        Role.GUIDED: "GUIDED",
        Role.OFFBOARD: "GUIDED",
        Role.MISSION: "AUTO",
        Role.RETURN: "RTL",
        Role.LAND: "LAND",
        Role.TAKEOFF: "GUIDED",
        Role.CIRCLE: "CIRCLE",
    }
    phrases: ClassVar = {
        "position_ok": (INFO, "EKF3 IMU0 is using GPS"),
        "armed": (INFO, "Arming motors"),
        "disarmed": (INFO, "Disarming motors"),
        "disarmed_landing": (INFO, "Disarming motors"),
        "disarmed_idle": (INFO, "Disarming motors"),
        "disarm_flying": (CRITICAL, "Disarm: vehicle is flying"),
        "took_off": (INFO, "Takeoff"),
        "landed": (INFO, "Land complete"),
        "terminated": (CRITICAL, "Terminating due to GCS request"),
        "takeoff_flying": (CRITICAL, "Takeoff: already flying"),
        "takeoff_position": (CRITICAL, "Takeoff: requires position"),
        "mode_position": (CRITICAL, "Mode change to {mode} failed: requires position"),
        "mode_failed": (CRITICAL, "Mode change to {mode} failed: {reason}"),
        "mission_done": (INFO, "Mission complete"),
        "mission_new": (INFO, "Flight plan received"),
        "mission_reached": (INFO, "Reached command #{seq}"),
        "offboard_lost": (WARNING, "Guided: no setpoints"),
        "battery_low": (CRITICAL, "Battery 1 is low {volts:.2f}V used {used:.0f} mAh"),
        "battery_critical": (CRITICAL, "Battery 1 is critical {volts:.2f}V used {used:.0f} mAh"),
        "param_unknown": (WARNING, "Unknown parameter {name}"),
        "param_type": (WARNING, "Type of {name} does not match"),
        "rebooting": (INFO, "Rebooting"),
    }
    params = PARAMS
    bytewise_params = False
    sysid_param = "SYSID_THISMAV"
    capabilities = (
        CAPABILITIES
        | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
        | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
        | mavlink.MAV_PROTOCOL_CAPABILITY_COMPASS_CALIBRATION
    )
    version = (4, 5, 7)
    version_text = "ArduCopter V4.5.7 (mavwire)"
    commands = COMMANDS | mav_commands("""
        CONDITION_YAW DO_PAUSE_CONTINUE DO_SET_SERVO DO_SET_RELAY DO_MOTOR_TEST
        DO_FENCE_ENABLE
    """)
    mission_commands = MISSION_COMMANDS | mav_commands("""
        NAV_SPLINE_WAYPOINT NAV_LOITER_TURNS CONDITION_DISTANCE CONDITION_YAW
        DO_SET_RELAY
    """)
    streams: ClassVar = {"HEARTBEAT": 1.0}
    stream_groups: ClassVar = {
        mavlink.MAV_DATA_STREAM_RAW_SENSORS: ("RAW_IMU", "SCALED_IMU2", "SCALED_PRESSURE"),
        mavlink.MAV_DATA_STREAM_EXTENDED_STATUS: (
            "SYS_STATUS", "POWER_STATUS", "MEMINFO", "MISSION_CURRENT", "GPS_RAW_INT",
            "NAV_CONTROLLER_OUTPUT", "POSITION_TARGET_GLOBAL_INT",
        ),
        mavlink.MAV_DATA_STREAM_RC_CHANNELS: ("SERVO_OUTPUT_RAW", "RC_CHANNELS"),
        mavlink.MAV_DATA_STREAM_POSITION: ("GLOBAL_POSITION_INT", "LOCAL_POSITION_NED"),
        mavlink.MAV_DATA_STREAM_EXTRA1: ("ATTITUDE", "SIMSTATE", "AHRS2"),
        mavlink.MAV_DATA_STREAM_EXTRA2: ("VFR_HUD",),
        mavlink.MAV_DATA_STREAM_EXTRA3: (
            "AHRS", "HWSTATUS", "SYSTEM_TIME", "WIND", "BATTERY_STATUS", "EKF_STATUS_REPORT",
            "VIBRATION",
        ),
    }  # fmt: skip
    stream_params: ClassVar = {
        mavlink.MAV_DATA_STREAM_RAW_SENSORS: "SR0_RAW_SENS",
        mavlink.MAV_DATA_STREAM_EXTENDED_STATUS: "SR0_EXT_STAT",
        mavlink.MAV_DATA_STREAM_RC_CHANNELS: "SR0_RC_CHAN",
        mavlink.MAV_DATA_STREAM_POSITION: "SR0_POSITION",
        mavlink.MAV_DATA_STREAM_EXTRA1: "SR0_EXTRA1",
        mavlink.MAV_DATA_STREAM_EXTRA2: "SR0_EXTRA2",
        mavlink.MAV_DATA_STREAM_EXTRA3: "SR0_EXTRA3",
    }
    first_mission_item = 1
    guided_items = True
    mission_needs_arming = True
    targets_lift = False
    reposition_changes_mode = False
    set_mode_ack = mavlink.MAVLINK_MSG_ID_SET_MODE
    packed_params = True
    mission_request_int = False
    waypoint_yaw = False
    ftp_client_sessions = True
    refusal = mavlink.MAV_RESULT_FAILED
    unknown_interval = mavlink.MAV_RESULT_DENIED

    def requested_mode(self, base_mode: int, custom: int, sub: int) -> Mode | None:
        return self.mode_by_custom(custom) if base_mode & CUSTOM else None

    def system_status(self, autopilot: Autopilot) -> int:
        if autopilot.terminated:
            return mavlink.MAV_STATE_FLIGHT_TERMINATION
        if autopilot.battery_low and autopilot.armed:
            return mavlink.MAV_STATE_CRITICAL
        if autopilot.copter.landed:
            return mavlink.MAV_STATE_STANDBY
        return mavlink.MAV_STATE_ACTIVE

    def prepare_takeoff(self, autopilot: Autopilot) -> None:
        from ..autopilot import RefusedError

        if autopilot.mode.role is not Role.GUIDED:
            raise RefusedError("Takeoff: only in GUIDED mode")
        if not autopilot.armed:
            raise RefusedError("Takeoff: not armed")

    def mission_refusal(self, autopilot: Autopilot) -> str | None:
        items = autopilot.mission.items
        if len(items) <= self.first_mission_item:
            return "no mission"
        flown = items[self.first_mission_item :]
        lifts = any(item.command == mavlink.MAV_CMD_NAV_TAKEOFF for item in flown)
        return "missing takeoff command" if autopilot.copter.landed and not lifts else None

    def mission_waits(self, autopilot: Autopilot) -> bool:
        options = int(autopilot.vehicle.params["AUTO_OPTIONS"])
        return not options & AUTO_ALLOW_TAKEOFF and not autopilot.sticks.throttle > 0

    def arming_failures(self, autopilot: Autopilot) -> list[str]:
        params, mode = autopilot.vehicle.params, autopilot.mode
        failures = []
        if params["ARMING_CHECK"]:
            if autopilot.sensors.gps_fix < mavlink.GPS_FIX_TYPE_3D_FIX:
                failures.append("PreArm: GPS 1: Bad fix")
            if not autopilot.position_ok:
                failures.append("PreArm: Need Position Estimate")
            if autopilot.battery_low:
                failures.append("PreArm: Battery 1 below minimum arming capacity")
        options = int(params["AUTO_OPTIONS"])
        allowed = mode.role is Role.MISSION and options & AUTO_ALLOW_ARMING
        if not mode.armable and not allowed:
            failures.append(f"Arm: {mode.name} mode not armable")
        return failures

    def command_altitude(self, autopilot: Autopilot, altitude: float, frame: int | None) -> float:
        if not math.isfinite(altitude):
            return autopilot.copter.place.alt
        return altitude if frame in ABSOLUTE else altitude + autopilot.home_place.alt

    def tuning(self, params: Mapping[str, float], tuning: Tuning) -> None:
        tuning.cruise_speed = params["WPNAV_SPEED"] / 100
        tuning.climb_speed = params["WPNAV_SPEED_UP"] / 100
        tuning.descent_speed = params["WPNAV_SPEED_DN"] / 100
        tuning.land_speed = params["LAND_SPEED"] / 100
        tuning.slow_below = params["LAND_ALT_LOW"] / 100
        tuning.arrival_radius = params["WPNAV_RADIUS"] / 100
        tuning.return_height = params["RTL_ALT"] / 100
        tuning.return_loiter = params["RTL_LOIT_TIME"] / 1000
        tuning.disarm_delay = params["DISARM_DELAY"] or -1.0
        tuning.battery_capacity = params["BATT_CAPACITY"]
        low = params["BATT_LOW_MAH"]
        tuning.battery_low = 100 * low / max(tuning.battery_capacity, 1) or LOW_MAH_PER_CENT

    def files(self, vehicle: Vehicle) -> Mapping[str, bytes]:
        return {
            "/APM/LOGS/LASTLOG.TXT": b"0\n",
            "/APM/scripts/readme.txt": b"Scripts of the simulated vehicle go here.\n",
            "/APM/TERRAIN/readme.txt": b"The simulated world is flat.\n",
            "@SYS/uarts.txt": b"UARTV1\nSERIAL0 TX=1 RX=1\n",
        }

    def banner(self, vehicle: Vehicle) -> Iterable[str]:
        return (self.version_text, "Frame: QUAD/X", f"Simulated vehicle {vehicle.sysid}")
