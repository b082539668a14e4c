"""What a vehicle reports of itself: one function for each message."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink

from .geo import bearing, distance, e7
from .personality.common import values
from .physics import GRAVITY, Copter

if TYPE_CHECKING:
    from .vehicle import Vehicle

NAN = math.nan
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
MICROS = 1_000_000


def heartbeat(v: Vehicle) -> Any:
    pilot = v.autopilot
    base = pilot.mode.flags | (mavlink.MAV_MODE_FLAG_SAFETY_ARMED if pilot.armed else 0)
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR, v.personality.autopilot, base, pilot.mode.custom_mode,
        v.personality.system_status(pilot), MAVLINK_VERSION,
    )  # fmt: skip


def sys_status(v: Vehicle) -> Any:
    present = SENSORS | POSITION_SENSORS | PREARM
    health = SENSORS | FENCE_KEPT
    if v.autopilot.position_ok:
        health |= POSITION_SENSORS
    if v.autopilot.armed or not v.personality.arming_failures(v.autopilot):
        health |= PREARM
    volts, amps = round(v.battery.voltage * 1e3), round(v.battery.current * 1e2)
    load = 250 + round(30 * v.sensors.noise[0])
    return mavlink.MAVLink_sys_status_message(
        present, present, health, load, volts, amps, v.battery.remaining, 0, 0, 0, 0, 0, 0
    )


def system_time(v: Vehicle) -> Any:
    return mavlink.MAVLink_system_time_message(v.unix_us, v.time_ms)


def ping(v: Vehicle) -> Any:
    return mavlink.MAVLink_ping_message(v.time_us, v.ticks & 0xFFFFFFFF, 0, 0)


def gps_raw_int(v: Vehicle) -> Any:
    sensors, copter = v.sensors, v.copter
    if sensors.gps_fix < mavlink.GPS_FIX_TYPE_3D_FIX:
        return mavlink.MAVLink_gps_raw_int_message(
            v.time_us, sensors.gps_fix, 0, 0, 0, 9999, 9999, UNKNOWN_16, UNKNOWN_16,
            sensors.satellites,
        )  # fmt: skip
    place = sensors.gps_place()
    course = round(math.degrees(math.atan2(copter.ve, copter.vn)) * 100) % 36000
    return mavlink.MAVLink_gps_raw_int_message(
        v.time_us, sensors.gps_fix, e7(place.lat), e7(place.lon), round(place.alt * 1e3), 80, 120,
        round(copter.groundspeed * 100), course, sensors.satellites,
        round(place.alt * 1e3), 400, 700, 200, 0, 0,
    )  # fmt: skip


def _imu(v: Vehicle) -> list[int]:
    """Accelerations in thousandths of g, rates in mrad/s, field in milligauss."""
    accel = [round(value / GRAVITY * 1e3) for value in v.sensors.accel()]
    gyro = [round(value * 1e3) for value in v.sensors.gyro()]
    return accel + gyro + [round(value) for value in v.sensors.mag()]


def _small(v: Vehicle, count: int) -> list[float]:
    """Variances of a filter that is content."""
    return [0.02 + 0.01 * abs(value) for value in v.sensors.noise[:count]]


def raw_imu(v: Vehicle) -> Any:
    return mavlink.MAVLink_raw_imu_message(v.time_us, *[*_imu(v), 0, SENSOR_TEMPERATURE])


def scaled_imu(v: Vehicle) -> Any:
    return mavlink.MAVLink_scaled_imu_message(v.time_ms, *[*_imu(v), SENSOR_TEMPERATURE])


def scaled_imu2(v: Vehicle) -> Any:
    return mavlink.MAVLink_scaled_imu2_message(v.time_ms, *[*_imu(v), SENSOR_TEMPERATURE])


def scaled_pressure(v: Vehicle) -> Any:
    return mavlink.MAVLink_scaled_pressure_message(
        v.time_ms, v.sensors.pressure(), 0.0, SENSOR_TEMPERATURE
    )


def highres_imu(v: Vehicle) -> Any:
    x, y, z = v.sensors.mag()
    return mavlink.MAVLink_highres_imu_message(
        v.time_us, *v.sensors.accel(), *v.sensors.gyro(), x / 1e3, y / 1e3, z / 1e3,
        v.sensors.pressure(), 0.0, v.copter.place.alt, SENSOR_TEMPERATURE / 100, 0x1BFF,
    )  # fmt: skip


def _rates(copter: Copter) -> tuple[float, float, float]:
    """Turn rates in the body frame; the yaw rate is about the vertical."""
    sin, cos = math.sin(copter.pitch), math.cos(copter.pitch)
    roll_sin, roll_cos = math.sin(copter.roll), math.cos(copter.roll)
    return (
        copter.roll_rate - copter.yaw_rate * sin,
        copter.pitch_rate * roll_cos + copter.yaw_rate * roll_sin * cos,
        copter.yaw_rate * roll_cos * cos - copter.pitch_rate * roll_sin,
    )


def attitude(v: Vehicle) -> Any:
    copter = v.copter
    return mavlink.MAVLink_attitude_message(
        v.time_ms, copter.roll, copter.pitch, copter.yaw, *_rates(copter)
    )


def attitude_quaternion(v: Vehicle) -> Any:
    return mavlink.MAVLink_attitude_quaternion_message(
        v.time_ms, *v.copter.quaternion(), *_rates(v.copter)
    )


def local_position_ned(v: Vehicle) -> Any:
    c = v.copter
    return mavlink.MAVLink_local_position_ned_message(
        v.time_ms, c.north, c.east, -c.up, c.vn, c.ve, -c.climb
    )


def global_position_int(v: Vehicle) -> Any:
    copter, place = v.copter, v.copter.place
    lat, lon = (e7(place.lat), e7(place.lon)) if v.sensors.gps_fix >= 3 else (0, 0)
    return mavlink.MAVLink_global_position_int_message(
        v.time_ms, lat, lon, round(place.alt * 1e3), round(v.autopilot.height * 1e3),
        round(copter.vn * 100), round(copter.ve * 100), round(-copter.climb * 100),
        _heading(copter) * 100 % 36000,
    )  # fmt: skip


def _heading(copter: Copter) -> int:
    return round(math.degrees(copter.yaw)) % 360


def _throttle(v: Vehicle) -> int:
    """Per cent: 39 hovers."""
    if not v.autopilot.armed:
        return 0
    return 10 if v.copter.landed else max(0, min(100, round(39 + 4 * v.copter.au)))


def servo_output_raw(v: Vehicle) -> Any:
    middle = 1000 + 10 * _throttle(v)
    sensors, copter = v.sensors, v.copter
    roll, pitch = round(60 * copter.roll_rate), round(60 * copter.pitch_rate)
    if not v.autopilot.armed or copter.landed:
        motors = [middle] * 4
    else:
        motors = [
            middle - roll + pitch, middle + roll - pitch, middle + roll + pitch,
            middle - roll - pitch + round(10 * sensors.noise[3]),
        ]  # fmt: skip
    pulses = [max(1000, min(2000, motor)) for motor in motors]
    pulses += [v.servos.get(channel, 0) for channel in range(5, 9)]
    return mavlink.MAVLink_servo_output_raw_message(v.time_us & 0xFFFFFFFF, 0, *pulses)


def rc_channels(v: Vehicle) -> Any:
    channels = v.guided.channels
    return mavlink.MAVLink_rc_channels_message(v.time_ms, 16, *[*channels, 255])


def mission_current(v: Vehicle) -> Any:
    plan, pilot = v.plans[0], v.autopilot
    if not plan.items:
        state = mavlink.MISSION_STATE_NO_MISSION
    elif plan.complete:
        state = mavlink.MISSION_STATE_COMPLETE
    elif pilot.task.name == "mission":
        state = mavlink.MISSION_STATE_ACTIVE
    else:
        state = mavlink.MISSION_STATE_PAUSED if plan.current else mavlink.MISSION_STATE_NOT_STARTED
    total = max(len(plan) - v.personality.first_mission_item, 0)
    in_mission = 1 if pilot.task.name == "mission" else 2
    return mavlink.MAVLink_mission_current_message(plan.current, total, state, in_mission)


def nav_controller_output(v: Vehicle) -> Any:
    copter, target = v.copter, v.autopilot.task.target
    roll, pitch = math.degrees(copter.roll), math.degrees(copter.pitch)
    if target is None:
        heading = _heading(copter)
        heading = heading - 360 if heading > 180 else heading
        return mavlink.MAVLink_nav_controller_output_message(roll, pitch, heading, 0, 0, 0, 0, 0)
    way = round(math.degrees(bearing(copter.local, target)))
    away = min(round(distance(copter.local, target)), 65535)
    above = target.up - copter.up
    return mavlink.MAVLink_nav_controller_output_message(roll, pitch, way, way, away, above, 0, 0)


def position_target_global_int(v: Vehicle) -> Any:
    target = v.autopilot.task.target or v.copter.local
    place = v.copter.origin.globe(target)
    return mavlink.MAVLink_position_target_global_int_message(
        v.time_ms, mavlink.MAV_FRAME_GLOBAL, POSITION_ONLY, e7(place.lat), e7(place.lon), place.alt,
        0, 0, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip


def position_target_local_ned(v: Vehicle) -> Any:
    target = v.autopilot.task.target or v.copter.local
    return mavlink.MAVLink_position_target_local_ned_message(
        v.time_ms, mavlink.MAV_FRAME_LOCAL_NED, POSITION_ONLY, target.north, target.east,
        -target.up, 0, 0, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip


def vfr_hud(v: Vehicle) -> Any:
    copter = v.copter
    return mavlink.MAVLink_vfr_hud_message(
        copter.airspeed, copter.groundspeed, _heading(copter), _throttle(v), copter.place.alt,
        copter.climb,
    )  # fmt: skip


def power_status(v: Vehicle) -> Any:
    return mavlink.MAVLink_power_status_message(5000 + round(10 * v.sensors.noise[1]), 0, 1)


def battery_status(v: Vehicle) -> Any:
    battery = v.battery
    cells = [round(battery.voltage * 250)] * 4 + [UNKNOWN_16] * 6
    used = round(battery.used)
    low = v.autopilot.battery_low
    return mavlink.MAVLink_battery_status_message(
        0, 0, 1, SENSOR_TEMPERATURE, cells, round(battery.current * 100), used,
        round(used * 0.0532), battery.remaining, 0, 2 if low else 1,
    )  # fmt: skip


def estimator_status(v: Vehicle) -> Any:
    flags = WITH_POSITION if v.autopilot.position_ok else NO_POSITION
    return mavlink.MAVLink_estimator_status_message(v.time_us, flags, *[*_small(v, 6), 0.4, 0.6])


def ekf_status_report(v: Vehicle) -> Any:
    flags = WITH_POSITION if v.autopilot.position_ok else NO_POSITION
    return mavlink.MAVLink_ekf_status_report_message(flags, *[*_small(v, 4), 0.0])


def vibration(v: Vehicle) -> Any:
    share = 0.3 if v.autopilot.armed else 0.01
    x, y, z = (share * (1 + 0.2 * value) for value in v.sensors.noise[:3])
    return mavlink.MAVLink_vibration_message(v.time_us, x, y, z, 0, 0, 0)


def home_position(v: Vehicle) -> Any:
    home, local = v.autopilot.home_place, v.autopilot.home_local
    return mavlink.MAVLink_home_position_message(
        e7(home.lat), e7(home.lon), round(home.alt * 1e3), local.north, local.east, -local.up,
        [1, 0, 0, 0], 0, 0, 0, v.time_us,
    )  # fmt: skip


def gps_global_origin(v: Vehicle) -> Any:
    place = v.copter.origin.place
    return mavlink.MAVLink_gps_global_origin_message(
        e7(place.lat), e7(place.lon), round(place.alt * 1e3), v.time_us
    )


def extended_sys_state(v: Vehicle) -> Any:
    return mavlink.MAVLink_extended_sys_state_message(0, v.autopilot.landed_state)


def altitude(v: Vehicle) -> Any:
    copter, above = v.copter, v.copter.place.alt
    return mavlink.MAVLink_altitude_message(
        v.time_us, above, above, copter.up, v.autopilot.height, copter.up, NAN
    )


def meminfo(v: Vehicle) -> Any:
    return mavlink.MAVLink_meminfo_message(0, UNKNOWN_16, 131072)


def ahrs(v: Vehicle) -> Any:
    x, y, z = (0.0005 * value for value in v.sensors.noise[:3])
    return mavlink.MAVLink_ahrs_message(x, y, z, 0.0, 0.0, 0.002, 0.003)


def ahrs2(v: Vehicle) -> Any:
    copter, place = v.copter, v.copter.place
    tilt = (copter.roll, copter.pitch, copter.yaw)
    return mavlink.MAVLink_ahrs2_message(*tilt, place.alt, e7(place.lat), e7(place.lon))


def simstate(v: Vehicle) -> Any:
    copter, place = v.copter, v.copter.place
    return mavlink.MAVLink_simstate_message(
        copter.roll, copter.pitch, copter.yaw, *copter.specific_force(), *_rates(copter),
        e7(place.lat), e7(place.lon),
    )  # fmt: skip


def hwstatus(v: Vehicle) -> Any:
    return mavlink.MAVLink_hwstatus_message(5000, 0)


def wind(v: Vehicle) -> Any:
    copter = v.copter
    comes_from = math.degrees(math.atan2(-copter.wind_east, -copter.wind_north))
    speed = math.hypot(copter.wind_north, copter.wind_east)
    return mavlink.MAVLink_wind_message(comes_from, speed, 0.0)


def current_mode(v: Vehicle) -> Any:
    mode = v.autopilot.mode
    return mavlink.MAVLink_current_mode_message(mode.standard, mode.custom_mode, mode.custom_mode)


def fence_status(v: Vehicle) -> Any:
    return mavlink.MAVLink_fence_status_message(0, 0, 0, 0)


def flight_information(v: Vehicle) -> Any:
    return mavlink.MAVLink_flight_information_message(
        v.time_ms, v.armed_unix_us, v.takeoff_unix_us, v.sysid
    )


def autopilot_version(v: Vehicle) -> Any:
    major, minor, patch = v.personality.version
    version = major << 24 | minor << 16 | patch << 8 | 0xFF
    commit = list(b"mavwire\0")
    return mavlink.MAVLink_autopilot_version_message(
        v.personality.capabilities, version, version, version, 0, commit, commit, commit,
        0, 0, 0x6D617677_00000000 | v.sysid,
    )  # fmt: skip


_FUNCTIONS: tuple[Callable[[Vehicle], Any], ...] = (
    heartbeat, sys_status, system_time, ping, gps_raw_int, raw_imu, scaled_imu, scaled_imu2,
    scaled_pressure, highres_imu, attitude, attitude_quaternion, local_position_ned,
    global_position_int, servo_output_raw, rc_channels, mission_current, nav_controller_output,
    position_target_global_int, position_target_local_ned, vfr_hud, power_status, battery_status,
    estimator_status, ekf_status_report, vibration, home_position, gps_global_origin,
    extended_sys_state, altitude, meminfo, ahrs, ahrs2, simstate, hwstatus, wind, current_mode,
    fence_status, flight_information, autopilot_version,
)  # fmt: skip
TELEMETRY: dict[str, Callable[[Vehicle], Any]] = {
    function.__name__.upper(): function for function in _FUNCTIONS
}
"""Message name -> function that makes it."""
