"""Telemetry of a simulated vehicle: for each message the values of its fields, in the order of the definition."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink

from .geo import Place, bearing, distance, e7
from .mission_flight import FlyMission
from .personality.common import values
from .physics import GRAVITY, Copter

if TYPE_CHECKING:
    from .vehicle import Vehicle

# Of a vehicle, which the type checker does not know yet when it comes to the table below.
Values = Callable[[Any], tuple[Any, ...]]

UNKNOWN_16 = 65535
MAVLINK_VERSION = 3
# MAV_SYS_STATUS_SENSOR: what a healthy copter has, GPS and arming checks apart.
SENSORS = sum(
    values(
        "MAV_SYS_STATUS_",
        "SENSOR_3D_GYRO SENSOR_3D_ACCEL SENSOR_3D_MAG SENSOR_ABSOLUTE_PRESSURE "
        "SENSOR_ANGULAR_RATE_CONTROL SENSOR_ATTITUDE_STABILIZATION SENSOR_YAW_POSITION "
        "SENSOR_MOTOR_OUTPUTS SENSOR_RC_RECEIVER AHRS SENSOR_BATTERY",
    )
)
POSITION_SENSORS = sum(
    values(
        "MAV_SYS_STATUS_",
        "SENSOR_GPS SENSOR_Z_ALTITUDE_CONTROL SENSOR_XY_POSITION_CONTROL",
    )
)
PREARM = mavlink.MAV_SYS_STATUS_PREARM_CHECK
# No fence is breached; without this, ground stations say that one is, even where there is none.
FENCE_KEPT = mavlink.MAV_SYS_STATUS_GEOFENCE
# Filter flags while there is no position: attitude, vertical, and a constant position.
NO_POSITION = 0x01 | 0x04 | 0x20 | 0x80
WITH_POSITION = 0x33F
SENSOR_TEMPERATURE = 3500
# Position targets: everything but position is left out.
POSITION_ONLY = 0x0DF8


def _lat_lon(place: Place) -> tuple[int, int]:
    return e7(place.lat), e7(place.lon)


def _global(place: Place) -> tuple[int, int, int]:
    """Degrees times 1e7, and millimetres."""
    return *_lat_lon(place), round(place.alt * 1e3)


def _heartbeat(v: Vehicle) -> tuple[Any, ...]:
    pilot = v.autopilot
    base = pilot.mode.flags | (mavlink.MAV_MODE_FLAG_SAFETY_ARMED if pilot.armed else 0)
    state = v.personality.system_status(pilot)
    kind = mavlink.MAV_TYPE_QUADROTOR
    return kind, v.personality.autopilot, base, pilot.mode.custom_mode, state, MAVLINK_VERSION


def _sys_status(v: Vehicle) -> tuple[Any, ...]:
    present = SENSORS | POSITION_SENSORS | PREARM
    health = SENSORS | FENCE_KEPT
    if v.autopilot.position_ok:
        health |= POSITION_SENSORS
    if v.autopilot.armed or not v.personality.arming_failures(v.autopilot):
        health |= PREARM
    volts, amps = round(v.battery.voltage * 1e3), round(v.battery.current * 1e2)
    load = 250 + round(30 * v.sensors.noise[0])
    return present, present, health, load, volts, amps, v.battery.remaining, 0, 0, 0, 0, 0, 0


def _gps_raw_int(v: Vehicle) -> tuple[Any, ...]:
    sensors, copter = v.sensors, v.copter
    head = v.time_us, sensors.gps_fix
    if sensors.gps_fix < mavlink.GPS_FIX_TYPE_3D_FIX:
        return *head, 0, 0, 0, 9999, 9999, UNKNOWN_16, UNKNOWN_16, sensors.satellites
    place = _global(sensors.gps_place())
    course = round(math.degrees(math.atan2(copter.ve, copter.vn)) * 100) % 36000
    motion = round(copter.groundspeed * 100), course
    return *head, *place, 80, 120, *motion, sensors.satellites, place[2], 400, 700, 200, 0, 0


def _imu(v: Vehicle) -> list[int]:
    """Accelerations in thousandths of g, rates in mrad/s, field in milligauss."""
    accel = [round(value / GRAVITY * 1e3) for value in v.sensors.accel()]
    gyro = [round(value * 1e3) for value in v.sensors.gyro()]
    return accel + gyro + [round(value) for value in v.sensors.mag()]


def _small(v: Vehicle, count: int) -> list[float]:
    """Variances of a filter that is content."""
    return [0.02 + 0.01 * abs(value) for value in v.sensors.noise[:count]]


def _filter_flags(v: Vehicle) -> int:
    return WITH_POSITION if v.autopilot.position_ok else NO_POSITION


def _highres_imu(v: Vehicle) -> tuple[Any, ...]:
    motion = *v.sensors.accel(), *v.sensors.gyro(), *(value / 1e3 for value in v.sensors.mag())
    air = v.sensors.pressure(), 0.0, v.copter.place.alt
    return v.time_us, *motion, *air, SENSOR_TEMPERATURE / 100, 0x1BFF


def _tilt(copter: Copter) -> tuple[float, float, float]:
    return copter.roll, copter.pitch, copter.yaw


def _rates(copter: Copter) -> tuple[float, float, float]:
    """Turn rates in the body frame; the yaw rate is about the vertical."""
    sin, cos = math.sin(copter.pitch), math.cos(copter.pitch)
    roll_sin, roll_cos = math.sin(copter.roll), math.cos(copter.roll)
    return (
        copter.roll_rate - copter.yaw_rate * sin,
        copter.pitch_rate * roll_cos + copter.yaw_rate * roll_sin * cos,
        copter.yaw_rate * roll_cos * cos - copter.pitch_rate * roll_sin,
    )


def _local_position_ned(v: Vehicle) -> tuple[Any, ...]:
    c = v.copter
    return v.time_ms, c.north, c.east, -c.up, c.vn, c.ve, -c.climb


def _global_position_int(v: Vehicle) -> tuple[Any, ...]:
    copter = v.copter
    lat, lon, alt = _global(copter.place)
    if v.sensors.gps_fix < mavlink.GPS_FIX_TYPE_3D_FIX:
        lat = lon = 0
    velocity = (round(value * 100) for value in (copter.vn, copter.ve, -copter.climb))
    height = round(v.autopilot.height * 1e3)
    return v.time_ms, lat, lon, alt, height, *velocity, _heading(copter) * 100 % 36000


def _heading(copter: Copter) -> int:
    return round(math.degrees(copter.yaw)) % 360


def _throttle(v: Vehicle) -> int:
    """Per cent: 39 hovers."""
    if not v.autopilot.armed:
        return 0
    return 10 if v.copter.landed else max(0, min(100, round(39 + 4 * v.copter.au)))


def _servo_output_raw(v: Vehicle) -> tuple[Any, ...]:
    middle = 1000 + 10 * _throttle(v)
    copter = v.copter
    motors = [middle] * 4
    if v.autopilot.armed and not copter.landed:
        roll, pitch = round(60 * copter.roll_rate), round(60 * copter.pitch_rate)
        last = middle - roll - pitch + round(10 * v.sensors.noise[3])
        motors = [middle - roll + pitch, middle + roll - pitch, middle + roll + pitch, last]
    pulses = (max(1000, min(2000, motor)) for motor in motors)
    servos = (v.servos.get(channel, 0) for channel in range(5, 9))
    return v.time_us & 0xFFFFFFFF, 0, *pulses, *servos


def _mission_current(v: Vehicle) -> tuple[Any, ...]:
    plan, pilot = v.plans[0], v.autopilot
    if not plan.items:
        state = mavlink.MISSION_STATE_NO_MISSION
    elif plan.complete:
        state = mavlink.MISSION_STATE_COMPLETE
    elif isinstance(pilot.task, FlyMission):
        state = mavlink.MISSION_STATE_ACTIVE
    else:
        state = mavlink.MISSION_STATE_PAUSED if plan.current else mavlink.MISSION_STATE_NOT_STARTED
    total = max(len(plan) - v.personality.first_mission_item, 0)
    in_mission = 1 if isinstance(pilot.task, FlyMission) else 2
    return plan.current, total, state, in_mission


def _nav_controller_output(v: Vehicle) -> tuple[Any, ...]:
    copter, target = v.copter, v.autopilot.task.target
    roll, pitch = math.degrees(copter.roll), math.degrees(copter.pitch)
    if target is None:
        heading = _heading(copter)
        return roll, pitch, heading - 360 if heading > 180 else heading, 0, 0, 0, 0, 0
    way = round(math.degrees(bearing(copter.local, target)))
    away = min(round(distance(copter.local, target)), UNKNOWN_16)
    return roll, pitch, way, way, away, target.up - copter.up, 0, 0


def _position_target_global_int(v: Vehicle) -> tuple[Any, ...]:
    place = v.copter.origin.globe(v.autopilot.task.target or v.copter.local)
    frame = mavlink.MAV_FRAME_GLOBAL
    return v.time_ms, frame, POSITION_ONLY, *_lat_lon(place), place.alt, *[0] * 8


def _position_target_local_ned(v: Vehicle) -> tuple[Any, ...]:
    target = v.autopilot.task.target or v.copter.local
    place = target.north, target.east, -target.up
    return v.time_ms, mavlink.MAV_FRAME_LOCAL_NED, POSITION_ONLY, *place, *[0] * 8


def _vfr_hud(v: Vehicle) -> tuple[Any, ...]:
    c = v.copter
    return c.airspeed, c.groundspeed, _heading(c), _throttle(v), c.place.alt, c.climb


def _battery_status(v: Vehicle) -> tuple[Any, ...]:
    battery = v.battery
    cells = [round(battery.voltage * 250)] * 4 + [UNKNOWN_16] * 6
    used = round(battery.used)
    drawn = round(battery.current * 100), used, round(used * 0.0532)
    state = 2 if v.autopilot.battery_low else 1
    return 0, 0, 1, SENSOR_TEMPERATURE, cells, *drawn, battery.remaining, 0, state


def _vibration(v: Vehicle) -> tuple[Any, ...]:
    share = 0.3 if v.autopilot.armed else 0.01
    return v.time_us, *(share * (1 + 0.2 * value) for value in v.sensors.noise[:3]), 0, 0, 0


def _home_position(v: Vehicle) -> tuple[Any, ...]:
    local = v.autopilot.home_local
    place = *_global(v.autopilot.home_place), local.north, local.east, -local.up
    return *place, [1, 0, 0, 0], 0, 0, 0, v.time_us


def _altitude(v: Vehicle) -> tuple[Any, ...]:
    above, up = v.copter.place.alt, v.copter.up
    return v.time_us, above, above, up, v.autopilot.height, up, math.nan


def _wind(v: Vehicle) -> tuple[Any, ...]:
    north, east = v.copter.wind_north, v.copter.wind_east
    return math.degrees(math.atan2(-east, -north)), math.hypot(north, east), 0.0


def _current_mode(v: Vehicle) -> tuple[Any, ...]:
    mode = v.autopilot.mode
    return mode.standard, mode.custom_mode, mode.custom_mode


def _autopilot_version(v: Vehicle) -> tuple[Any, ...]:
    major, minor, patch = v.personality.version
    version = major << 24 | minor << 16 | patch << 8 | 0xFF
    commit = list(b"mavwire\0")
    head = v.personality.capabilities, version, version, version, 0
    return *head, commit, commit, commit, 0, 0, 0x6D617677_00000000 | v.sysid


TELEMETRY: dict[str, Values] = {
    "HEARTBEAT": _heartbeat,
    "SYS_STATUS": _sys_status,
    "SYSTEM_TIME": lambda v: (v.unix_us, v.time_ms),
    "PING": lambda v: (v.time_us, v.ticks & 0xFFFFFFFF, 0, 0),
    "GPS_RAW_INT": _gps_raw_int,
    "RAW_IMU": lambda v: (v.time_us, *_imu(v), 0, SENSOR_TEMPERATURE),
    "SCALED_IMU": lambda v: (v.time_ms, *_imu(v), SENSOR_TEMPERATURE),
    "SCALED_IMU2": lambda v: (v.time_ms, *_imu(v), SENSOR_TEMPERATURE),
    "SCALED_PRESSURE": lambda v: (v.time_ms, v.sensors.pressure(), 0.0, SENSOR_TEMPERATURE),
    "HIGHRES_IMU": _highres_imu,
    "ATTITUDE": lambda v: (v.time_ms, *_tilt(v.copter), *_rates(v.copter)),
    "ATTITUDE_QUATERNION": lambda v: (v.time_ms, *v.copter.quaternion(), *_rates(v.copter)),
    "LOCAL_POSITION_NED": _local_position_ned,
    "GLOBAL_POSITION_INT": _global_position_int,
    "SERVO_OUTPUT_RAW": _servo_output_raw,
    "RC_CHANNELS": lambda v: (v.time_ms, 16, *v.guided.channels, 255),
    "MISSION_CURRENT": _mission_current,
    "NAV_CONTROLLER_OUTPUT": _nav_controller_output,
    "POSITION_TARGET_GLOBAL_INT": _position_target_global_int,
    "POSITION_TARGET_LOCAL_NED": _position_target_local_ned,
    "VFR_HUD": _vfr_hud,
    "POWER_STATUS": lambda v: (5000 + round(10 * v.sensors.noise[1]), 0, 1),
    "BATTERY_STATUS": _battery_status,
    "ESTIMATOR_STATUS": lambda v: (v.time_us, _filter_flags(v), *_small(v, 6), 0.4, 0.6),
    "EKF_STATUS_REPORT": lambda v: (_filter_flags(v), *_small(v, 4), 0.0),
    "VIBRATION": _vibration,
    "HOME_POSITION": _home_position,
    "GPS_GLOBAL_ORIGIN": lambda v: (*_global(v.copter.origin.place), v.time_us),
    "EXTENDED_SYS_STATE": lambda v: (0, v.autopilot.landed_state),
    "ALTITUDE": _altitude,
    "MEMINFO": lambda v: (0, UNKNOWN_16, 131072),
    "AHRS": lambda v: (*(0.0005 * one for one in v.sensors.noise[:3]), 0.0, 0.0, 0.002, 0.003),
    "AHRS2": lambda v: (*_tilt(v.copter), v.copter.place.alt, *_lat_lon(v.copter.place)),
    "SIMSTATE": lambda v: (
        *(*_tilt(v.copter), *v.copter.specific_force(), *_rates(v.copter)),
        *_lat_lon(v.copter.place),
    ),
    "HWSTATUS": lambda v: (5000, 0),
    "WIND": _wind,
    "CURRENT_MODE": _current_mode,
    "FENCE_STATUS": lambda v: (0, 0, 0, 0),
    "FLIGHT_INFORMATION": lambda v: (v.time_ms, v.armed_unix_us, v.takeoff_unix_us, v.sysid),
    "AUTOPILOT_VERSION": _autopilot_version,
}


def message(name: str, vehicle: Vehicle) -> Any:
    """The message `name` of the table, as `vehicle` sends it now."""
    return getattr(mavlink, f"MAVLink_{name.lower()}_message")(*TELEMETRY[name](vehicle))
