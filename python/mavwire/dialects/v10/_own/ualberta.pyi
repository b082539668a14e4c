"""What dialect ualberta itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_NAV_FILTER_BIAS: int = 220
MAVLINK_MSG_ID_RADIO_CALIBRATION: int = 221
MAVLINK_MSG_ID_UALBERTA_SYS_STATUS: int = 222
MODE_MANUAL_DIRECT: int = 1
MODE_MANUAL_SCALED: int = 2
MODE_AUTO_PID_ATT: int = 3
MODE_AUTO_PID_VEL: int = 4
MODE_AUTO_PID_POS: int = 5
UALBERTA_AUTOPILOT_MODE_ENUM_END: int
NAV_AHRS_INIT: int = 1
NAV_AHRS: int = 2
NAV_INS_GPS_INIT: int = 3
NAV_INS_GPS: int = 4
UALBERTA_NAV_MODE_ENUM_END: int
PILOT_MANUAL: int = 1
PILOT_AUTO: int = 2
PILOT_ROTO: int = 3
UALBERTA_PILOT_MODE_ENUM_END: int

class MAVLink_nav_filter_bias_message(_dialect.MAVLink_message):  # 220
    usec: int
    accel_0: float
    accel_1: float
    accel_2: float
    gyro_0: float
    gyro_1: float
    gyro_2: float
    def __init__(self, usec: int, accel_0: float, accel_1: float, accel_2: float, gyro_0: float,
        gyro_1: float, gyro_2: float) -> None: ...

class MAVLink_radio_calibration_message(_dialect.MAVLink_message):  # 221
    aileron: list[int]
    elevator: list[int]
    rudder: list[int]
    gyro: list[int]
    pitch: list[int]
    throttle: list[int]
    def __init__(self, aileron: _Sequence[int], elevator: _Sequence[int], rudder: _Sequence[int],
        gyro: _Sequence[int], pitch: _Sequence[int], throttle: _Sequence[int]) -> None: ...

class MAVLink_ualberta_sys_status_message(_dialect.MAVLink_message):  # 222
    mode: int
    nav_mode: int
    pilot: int
    def __init__(self, mode: int, nav_mode: int, pilot: int) -> None: ...

class _Methods:
    def nav_filter_bias_encode(self, usec: int, accel_0: float, accel_1: float, accel_2: float, gyro_0: float,
        gyro_1: float, gyro_2: float) -> MAVLink_nav_filter_bias_message: ...
    def nav_filter_bias_send(self, usec: int, accel_0: float, accel_1: float, accel_2: float, gyro_0: float,
        gyro_1: float, gyro_2: float, force_mavlink1: bool = False) -> None: ...
    def radio_calibration_encode(self, aileron: _Sequence[int], elevator: _Sequence[int],
        rudder: _Sequence[int], gyro: _Sequence[int], pitch: _Sequence[int],
        throttle: _Sequence[int]) -> MAVLink_radio_calibration_message: ...
    def radio_calibration_send(self, aileron: _Sequence[int], elevator: _Sequence[int],
        rudder: _Sequence[int], gyro: _Sequence[int], pitch: _Sequence[int], throttle: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def ualberta_sys_status_encode(self, mode: int, nav_mode: int,
        pilot: int) -> MAVLink_ualberta_sys_status_message: ...
    def ualberta_sys_status_send(self, mode: int, nav_mode: int, pilot: int,
        force_mavlink1: bool = False) -> None: ...
