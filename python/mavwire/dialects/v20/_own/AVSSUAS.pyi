"""What dialect AVSSUAS itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_AVSS_PRS_SYS_STATUS: int = 60050
MAVLINK_MSG_ID_AVSS_DRONE_POSITION: int = 60051
MAVLINK_MSG_ID_AVSS_DRONE_IMU: int = 60052
MAVLINK_MSG_ID_AVSS_DRONE_OPERATION_MODE: int = 60053
MAV_CMD_PRS_SET_ARM: int = 60050
MAV_CMD_PRS_GET_ARM: int = 60051
MAV_CMD_PRS_GET_BATTERY: int = 60052
MAV_CMD_PRS_GET_ERR: int = 60053
MAV_CMD_PRS_SET_ARM_ALTI: int = 60070
MAV_CMD_PRS_GET_ARM_ALTI: int = 60071
MAV_CMD_PRS_SHUTDOWN: int = 60072
PRS_NOT_STEADY: int = 1
PRS_DTM_NOT_ARMED: int = 2
PRS_OTM_NOT_ARMED: int = 3
MAV_AVSS_COMMAND_FAILURE_REASON_ENUM_END: int
MODE_M300_MANUAL_CTRL: int = 0
MODE_M300_ATTITUDE: int = 1
MODE_M300_P_GPS: int = 6
MODE_M300_HOTPOINT_MODE: int = 9
MODE_M300_ASSISTED_TAKEOFF: int = 10
MODE_M300_AUTO_TAKEOFF: int = 11
MODE_M300_AUTO_LANDING: int = 12
MODE_M300_NAVI_GO_HOME: int = 15
MODE_M300_NAVI_SDK_CTRL: int = 17
MODE_M300_S_SPORT: int = 31
MODE_M300_FORCE_AUTO_LANDING: int = 33
MODE_M300_T_TRIPOD: int = 38
MODE_M300_SEARCH_MODE: int = 40
MODE_M300_ENGINE_START: int = 41
AVSS_M300_OPERATION_MODE_ENUM_END: int
MODE_HORSEFLY_MANUAL_CTRL: int = 0
MODE_HORSEFLY_AUTO_TAKEOFF: int = 1
MODE_HORSEFLY_AUTO_LANDING: int = 2
MODE_HORSEFLY_NAVI_GO_HOME: int = 3
MODE_HORSEFLY_DROP: int = 4
AVSS_HORSEFLY_OPERATION_MODE_ENUM_END: int

class MAVLink_avss_prs_sys_status_message(_dialect.MAVLink_message):  # 60050
    time_boot_ms: int  # ms
    error_status: int
    battery_status: int
    arm_status: int
    charge_status: int
    def __init__(self, time_boot_ms: int, error_status: int, battery_status: int, arm_status: int,
        charge_status: int) -> None: ...

class MAVLink_avss_drone_position_message(_dialect.MAVLink_message):  # 60051
    time_boot_ms: int  # ms
    lat: int  # degE7
    lon: int  # degE7
    alt: int  # mm
    ground_alt: float  # m
    barometer_alt: float  # m
    def __init__(self, time_boot_ms: int, lat: int, lon: int, alt: int, ground_alt: float,
        barometer_alt: float) -> None: ...

class MAVLink_avss_drone_imu_message(_dialect.MAVLink_message):  # 60052
    time_boot_ms: int  # ms
    q1: float
    q2: float
    q3: float
    q4: float
    xacc: float  # m/s/s
    yacc: float  # m/s/s
    zacc: float  # m/s/s
    xgyro: float  # rad/s
    ygyro: float  # rad/s
    zgyro: float  # rad/s
    def __init__(self, time_boot_ms: int, q1: float, q2: float, q3: float, q4: float, xacc: float,
        yacc: float, zacc: float, xgyro: float, ygyro: float, zgyro: float) -> None: ...

class MAVLink_avss_drone_operation_mode_message(_dialect.MAVLink_message):  # 60053
    time_boot_ms: int  # ms
    M300_operation_mode: int
    horsefly_operation_mode: int
    def __init__(self, time_boot_ms: int, M300_operation_mode: int, horsefly_operation_mode: int) -> None: ...

class _Methods:
    def avss_prs_sys_status_encode(self, time_boot_ms: int, error_status: int, battery_status: int,
        arm_status: int, charge_status: int) -> MAVLink_avss_prs_sys_status_message: ...
    def avss_prs_sys_status_send(self, time_boot_ms: int, error_status: int, battery_status: int,
        arm_status: int, charge_status: int, force_mavlink1: bool = False) -> None: ...
    def avss_drone_position_encode(self, time_boot_ms: int, lat: int, lon: int, alt: int, ground_alt: float,
        barometer_alt: float) -> MAVLink_avss_drone_position_message: ...
    def avss_drone_position_send(self, time_boot_ms: int, lat: int, lon: int, alt: int, ground_alt: float,
        barometer_alt: float, force_mavlink1: bool = False) -> None: ...
    def avss_drone_imu_encode(self, time_boot_ms: int, q1: float, q2: float, q3: float, q4: float,
        xacc: float, yacc: float, zacc: float, xgyro: float, ygyro: float,
        zgyro: float) -> MAVLink_avss_drone_imu_message: ...
    def avss_drone_imu_send(self, time_boot_ms: int, q1: float, q2: float, q3: float, q4: float, xacc: float,
        yacc: float, zacc: float, xgyro: float, ygyro: float, zgyro: float,
        force_mavlink1: bool = False) -> None: ...
    def avss_drone_operation_mode_encode(self, time_boot_ms: int, M300_operation_mode: int,
        horsefly_operation_mode: int) -> MAVLink_avss_drone_operation_mode_message: ...
    def avss_drone_operation_mode_send(self, time_boot_ms: int, M300_operation_mode: int,
        horsefly_operation_mode: int, force_mavlink1: bool = False) -> None: ...
