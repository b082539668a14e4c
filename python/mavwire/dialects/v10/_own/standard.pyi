"""What dialect standard itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_GLOBAL_POSITION_INT: int = 33
MAVLINK_MSG_ID_AUTOPILOT_VERSION: int = 148
MAV_BOOL_FALSE: int = 0
MAV_BOOL_TRUE: int = 1
MAV_BOOL_ENUM_END: int
MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT: int = 1
MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT: int = 2
MAV_PROTOCOL_CAPABILITY_MISSION_INT: int = 4
MAV_PROTOCOL_CAPABILITY_COMMAND_INT: int = 8
MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE: int = 16
MAV_PROTOCOL_CAPABILITY_FTP: int = 32
MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET: int = 64
MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED: int = 128
MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT: int = 256
MAV_PROTOCOL_CAPABILITY_TERRAIN: int = 512
MAV_PROTOCOL_CAPABILITY_RESERVED3: int = 1024
MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION: int = 2048
MAV_PROTOCOL_CAPABILITY_COMPASS_CALIBRATION: int = 4096
MAV_PROTOCOL_CAPABILITY_MAVLINK2: int = 8192
MAV_PROTOCOL_CAPABILITY_MISSION_FENCE: int = 16384
MAV_PROTOCOL_CAPABILITY_MISSION_RALLY: int = 32768
MAV_PROTOCOL_CAPABILITY_RESERVED2: int = 65536
MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST: int = 131072
MAV_PROTOCOL_CAPABILITY_COMPONENT_IMPLEMENTS_GIMBAL_MANAGER: int = 262144
MAV_PROTOCOL_CAPABILITY_COMPONENT_ACCEPTS_GCS_CONTROL: int = 524288
MAV_PROTOCOL_CAPABILITY_GRIPPER: int = 1048576
MAV_PROTOCOL_CAPABILITY_ENUM_END: int
FIRMWARE_VERSION_TYPE_DEV: int = 0
FIRMWARE_VERSION_TYPE_ALPHA: int = 64
FIRMWARE_VERSION_TYPE_BETA: int = 128
FIRMWARE_VERSION_TYPE_RC: int = 192
FIRMWARE_VERSION_TYPE_OFFICIAL: int = 255
FIRMWARE_VERSION_TYPE_ENUM_END: int

class MAVLink_global_position_int_message(_dialect.MAVLink_message):  # 33
    time_boot_ms: int  # ms
    lat: int  # degE7
    lon: int  # degE7
    alt: int  # mm
    relative_alt: int  # mm
    vx: int  # cm/s
    vy: int  # cm/s
    vz: int  # cm/s
    hdg: int  # cdeg
    def __init__(self, time_boot_ms: int, lat: int, lon: int, alt: int, relative_alt: int, vx: int, vy: int,
        vz: int, hdg: int) -> None: ...

class MAVLink_autopilot_version_message(_dialect.MAVLink_message):  # 148
    capabilities: int  # MAV_PROTOCOL_CAPABILITY
    flight_sw_version: int
    middleware_sw_version: int
    os_sw_version: int
    board_version: int
    flight_custom_version: list[int]
    middleware_custom_version: list[int]
    os_custom_version: list[int]
    vendor_id: int
    product_id: int
    uid: int
    def __init__(self, capabilities: int, flight_sw_version: int, middleware_sw_version: int,
        os_sw_version: int, board_version: int, flight_custom_version: _Sequence[int],
        middleware_custom_version: _Sequence[int], os_custom_version: _Sequence[int], vendor_id: int,
        product_id: int, uid: int) -> None: ...

class _Methods:
    def global_position_int_encode(self, time_boot_ms: int, lat: int, lon: int, alt: int, relative_alt: int,
        vx: int, vy: int, vz: int, hdg: int) -> MAVLink_global_position_int_message: ...
    def global_position_int_send(self, time_boot_ms: int, lat: int, lon: int, alt: int, relative_alt: int,
        vx: int, vy: int, vz: int, hdg: int, force_mavlink1: bool = False) -> None: ...
    def autopilot_version_encode(self, capabilities: int, flight_sw_version: int, middleware_sw_version: int,
        os_sw_version: int, board_version: int, flight_custom_version: _Sequence[int],
        middleware_custom_version: _Sequence[int], os_custom_version: _Sequence[int], vendor_id: int,
        product_id: int, uid: int) -> MAVLink_autopilot_version_message: ...
    def autopilot_version_send(self, capabilities: int, flight_sw_version: int, middleware_sw_version: int,
        os_sw_version: int, board_version: int, flight_custom_version: _Sequence[int],
        middleware_custom_version: _Sequence[int], os_custom_version: _Sequence[int], vendor_id: int,
        product_id: int, uid: int, force_mavlink1: bool = False) -> None: ...
