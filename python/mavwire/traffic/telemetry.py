"""The messages of an ArduCopter vehicle and its ground station, their rates, and the source of each value.

Every entry is a message name, a period in ticks of 0.1 s, and a function from the flight to the
values in definition order (extension fields last, left out where a vehicle without that sensor
leaves them zero).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .flight import BATTERY_MAH, Flight

Values = Callable[[Flight], tuple[Any, ...]]

TICK = 0.1
START_US = 1_704_067_200_000_000  # 2024-01-01, so that a log's bytes do not depend on today
SENSORS = 0x1361FC2F
PARAMETERS = (
    (b"ARMING_CHECK", 1.0),
    (b"ATC_ANG_PIT_P", 4.5),
    (b"ATC_ANG_RLL_P", 4.5),
    (b"ATC_RAT_PIT_P", 0.135),
    (b"ATC_RAT_RLL_P", 0.135),
    (b"BATT_CAPACITY", BATTERY_MAH),
    (b"COMPASS_OFS_X", 5.0),
    (b"EK3_ENABLE", 1.0),
    (b"FENCE_ENABLE", 0.0),
    (b"FRAME_CLASS", 1.0),
    (b"GPS_TYPE", 1.0),
    (b"LOG_BITMASK", 176126.0),
    (b"MOT_SPIN_ARM", 0.1),
    (b"PSC_POSXY_P", 1.0),
    (b"RTL_ALT", 1500.0),
    (b"WPNAV_SPEED", 500.0),
)
TEXTS = (
    b"Leg finished, turning", b"Battery is fine", b"Holding position", b"Wind estimate updated",
    b"Next leg of the track", b"Link check passed",
)  # fmt: skip


def _e7(degrees: float) -> int:
    return int(degrees * 1e7)


def _sys_status(f: Flight) -> tuple[Any, ...]:
    load = 300 + int(40 * f.noise[0])
    volts, amps = int(f.voltage * 1e3), int(f.current * 1e2)
    return (SENSORS, SENSORS, SENSORS, load, volts, amps, f.remaining, 0, 0, 0, 0, 0, 0)


def _gps_raw_int(f: Flight) -> tuple[Any, ...]:
    course = int(f.heading * 100)
    speed = int(f.groundspeed * 100)
    satellites = 14 + (f.ticks // 300) % 3
    place = (_e7(f.lat), _e7(f.lon), int(f.alt * 1e3))
    return (f.us, 6, *place, 80, 140, speed, course, satellites)


def _gps2_raw(f: Flight) -> tuple[Any, ...]:
    place = (_e7(f.lat) + 3, _e7(f.lon) - 2, int(f.alt * 1e3))
    return (f.us, 3, *place, 110, 180, int(f.groundspeed * 100), int(f.heading * 100), 11, 0, 0)


def _imu(f: Flight, offset: int) -> tuple[int, ...]:
    return tuple(value + offset for value in (*f.accel, *f.gyro, *f.mag))


def _global_position_int(f: Flight) -> tuple[Any, ...]:
    place = (_e7(f.lat), _e7(f.lon), int(f.alt * 1e3), int(f.height * 1e3))
    speed = (int(f.vn * 100), int(f.ve * 100), int(-f.climb * 100))
    return (f.ms, *place, *speed, int(f.heading * 100))


def _rc_channels(f: Flight) -> tuple[Any, ...]:
    sticks = tuple(1500 + int(120 * f.noise[index]) for index in range(4))
    return (f.ms, 16, *sticks, 1900, 1100, 1500, 1500, *(1000,) * 4, 0, 0, 0, 0, 0, 0, 220)


def _servo_output_raw(f: Flight) -> tuple[Any, ...]:
    return (f.us & 0xFFFFFFFF, 0, *f.motors, 0, 0, 0, 0)


def _position_target(f: Flight) -> tuple[Any, ...]:
    place = (_e7(f.lat + f.vn * 1e-5), _e7(f.lon + f.ve * 1e-5), f.alt)
    return (f.ms, 5, 0x0DF8, *place, f.vn, f.ve, -f.climb, f.an, f.ae, 0.0, f.yaw, f.rates[2])


def _nav_controller_output(f: Flight) -> tuple[Any, ...]:
    bearing = int(f.heading) - 180
    away = min(int(abs(f.north) + abs(f.east)), 65535)
    lean = (f.roll * 57.29578, f.pitch * 57.29578)
    return (*lean, bearing, bearing, away, f.noise[0], 0.0, f.noise[1])


def _battery_status(f: Flight) -> tuple[Any, ...]:
    cells = [int(f.voltage * 250)] * 4 + [65535] * 6
    used = int(f.consumed_mah)
    return (0, 0, 1, 2710, cells, int(f.current * 100), used, int(used * 5.3), f.remaining)


def _ekf_status(f: Flight) -> tuple[Any, ...]:
    small = tuple(0.02 + 0.01 * abs(value) for value in f.noise[:4])
    return (831, *small, 0.0)


def _esc_telemetry(f: Flight) -> tuple[Any, ...]:
    rpm = [motor * 4 for motor in f.motors]
    volts, amps = [int(f.voltage * 100)] * 4, [int(f.current * 25)] * 4
    total = [int(f.consumed_mah / 4)] * 4
    return ([41, 42, 41, 43], volts, amps, total, rpm, [f.ticks & 0xFFFF] * 4)


def _param_value(f: Flight) -> tuple[Any, ...]:
    index = (f.ticks // 10) % len(PARAMETERS)
    name, value = PARAMETERS[index]
    return (name, value, 9, len(PARAMETERS), index)


def _statustext(f: Flight) -> tuple[Any, ...]:
    return (6, TEXTS[(f.ticks // 150) % len(TEXTS)])


def _home_position(f: Flight) -> tuple[Any, ...]:
    home = (_e7(f.home_lat), _e7(f.home_lon), int(f.home_alt * 1e3))
    return (*home, 0.0, 0.0, 0.0, [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0, f.us)


def _terrain_report(f: Flight) -> tuple[Any, ...]:
    ground = f.home_alt + 2.0 * f.noise[0]
    return (_e7(f.lat), _e7(f.lon), 100, ground, f.alt - ground, 0, 504)


VEHICLE: tuple[tuple[str, int, Values], ...] = (
    ("ATTITUDE", 1, lambda f: (f.ms, f.roll, f.pitch, f.yaw, *f.rates)),
    ("GLOBAL_POSITION_INT", 1, _global_position_int),
    ("LOCAL_POSITION_NED", 2, lambda f: (f.ms, f.north, f.east, -f.height, f.vn, f.ve, -f.climb)),
    (
        "VFR_HUD",
        1,
        lambda f: (f.groundspeed, f.groundspeed, int(f.heading), f.throttle, f.alt, f.climb),
    ),
    ("RAW_IMU", 2, lambda f: (f.us, *_imu(f, 0), 0, 4500)),
    ("SCALED_IMU2", 5, lambda f: (f.ms, *_imu(f, 3), 4480)),
    ("SCALED_IMU3", 5, lambda f: (f.ms, *_imu(f, -4), 4510)),
    ("SCALED_PRESSURE", 2, lambda f: (f.ms, f.pressure, 0.0, 3512)),
    ("SCALED_PRESSURE2", 5, lambda f: (f.ms, f.pressure + 0.2, 0.0, 3490)),
    ("SERVO_OUTPUT_RAW", 2, _servo_output_raw),
    ("RC_CHANNELS", 2, _rc_channels),
    ("SYS_STATUS", 5, _sys_status),
    ("POWER_STATUS", 5, lambda f: (5020 + int(8 * f.noise[1]), 0, 3)),
    ("MEMINFO", 5, lambda f: (0, 65535, 132_000 + int(500 * f.noise[2]))),
    ("MISSION_CURRENT", 10, lambda f: (f.ticks // 300 % 12, 12, 3, 1)),
    ("NAV_CONTROLLER_OUTPUT", 5, _nav_controller_output),
    ("GPS_RAW_INT", 2, _gps_raw_int),
    ("GPS2_RAW", 10, _gps2_raw),
    ("SYSTEM_TIME", 5, lambda f: (START_US + f.us, f.ms)),
    ("AHRS", 5, lambda f: (*f.noise[:3], 0.0, 0.0, 0.01, 0.02)),
    ("AHRS2", 5, lambda f: (f.roll, f.pitch, f.yaw, f.alt, _e7(f.lat), _e7(f.lon))),
    ("WIND", 5, lambda f: (140.0 + f.noise[0], 3.2 + 0.2 * f.noise[1], 0.1)),
    ("RANGEFINDER", 5, lambda f: (f.height, 0.0)),
    ("EKF_STATUS_REPORT", 5, _ekf_status),
    ("VIBRATION", 2, lambda f: (f.us, *(1.5 + abs(value) for value in f.noise[:3]), 0, 0, 0)),
    ("HWSTATUS", 5, lambda f: (5020 + int(8 * f.noise[1]), 0)),
    ("TERRAIN_REPORT", 5, _terrain_report),
    ("BATTERY_STATUS", 5, _battery_status),
    ("POSITION_TARGET_GLOBAL_INT", 10, _position_target),
    ("MCU_STATUS", 10, lambda f: (0, 4150, 3300, 3290, 3310)),
    ("ESC_TELEMETRY_1_TO_4", 10, _esc_telemetry),
    ("HEARTBEAT", 10, lambda f: (2, 3, 217, 3, 4, 3)),
    ("PARAM_VALUE", 10, _param_value),
    ("TIMESYNC", 100, lambda f: (0, f.us * 1000)),
    ("STATUSTEXT", 150, _statustext),
    ("HOME_POSITION", 300, _home_position),
)

GROUND_STATION: tuple[tuple[str, int, Values], ...] = (
    ("HEARTBEAT", 10, lambda f: (6, 8, 192, 0, 4, 3)),
    ("TIMESYNC", 100, lambda f: (f.us * 1000, 0)),
    ("REQUEST_DATA_STREAM", 300, lambda f: (1, 1, 0, 4, 1)),
)
