"""What dialect common_replaced itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect


class MAVLink_set_mode_message(_dialect.MAVLink_message):  # 11
    target_system: int
    base_mode: int  # MAV_MODE
    custom_mode: int
    def __init__(self, target_system: int, base_mode: int, custom_mode: int) -> None: ...

class MAVLink_raw_imu_message(_dialect.MAVLink_message):  # 27
    time_usec: int  # us
    xacc: int  # mG
    yacc: int  # mG
    zacc: int  # mG
    xgyro: int  # mrad/s
    ygyro: int  # mrad/s
    zgyro: int  # mrad/s
    xmag: int  # mgauss
    ymag: int  # mgauss
    zmag: int  # mgauss
    id: int
    temperature: int  # cdegC
    def __init__(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int, zgyro: int,
        xmag: int, ymag: int, zmag: int, id: int = 0, temperature: int = 0) -> None: ...

class MAVLink_mission_current_message(_dialect.MAVLink_message):  # 42
    seq: int
    total: int
    mission_state: int  # MISSION_STATE
    mission_mode: int
    def __init__(self, seq: int, total: int = 0, mission_state: int = 0, mission_mode: int = 0) -> None: ...

class MAVLink_mission_count_message(_dialect.MAVLink_message):  # 44
    target_system: int
    target_component: int
    count: int
    mission_type: int  # MAV_MISSION_TYPE
    def __init__(self, target_system: int, target_component: int, count: int,
        mission_type: int = 0) -> None: ...

class MAVLink_mission_ack_message(_dialect.MAVLink_message):  # 47
    target_system: int
    target_component: int
    type: int  # MAV_MISSION_RESULT
    mission_type: int  # MAV_MISSION_TYPE
    def __init__(self, target_system: int, target_component: int, type: int,
        mission_type: int = 0) -> None: ...

class MAVLink_command_ack_message(_dialect.MAVLink_message):  # 77
    command: int  # MAV_CMD
    result: int  # MAV_RESULT
    progress: int
    result_param2: int
    target_system: int
    target_component: int
    def __init__(self, command: int, result: int, progress: int = 0, result_param2: int = 0,
        target_system: int = 0, target_component: int = 0) -> None: ...

class MAVLink_set_attitude_target_message(_dialect.MAVLink_message):  # 82
    time_boot_ms: int  # ms
    target_system: int
    target_component: int
    type_mask: int  # ATTITUDE_TARGET_TYPEMASK
    q: list[float]
    body_roll_rate: float  # rad/s
    body_pitch_rate: float  # rad/s
    body_yaw_rate: float  # rad/s
    thrust: float
    def __init__(self, time_boot_ms: int, target_system: int, target_component: int, type_mask: int,
        q: _Sequence[float], body_roll_rate: float, body_pitch_rate: float, body_yaw_rate: float,
        thrust: float) -> None: ...

class MAVLink_optical_flow_message(_dialect.MAVLink_message):  # 100
    time_usec: int  # us
    sensor_id: int
    flow_x: int  # rad/s
    flow_y: int  # rad/s
    flow_comp_m_x: float  # m/s
    flow_comp_m_y: float  # m/s
    quality: int
    ground_distance: float  # m
    flow_rate_x: float  # rad/s
    flow_rate_y: float  # rad/s
    def __init__(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int, flow_comp_m_x: float,
        flow_comp_m_y: float, quality: int, ground_distance: float, flow_rate_x: float = 0,
        flow_rate_y: float = 0) -> None: ...

class MAVLink_timesync_message(_dialect.MAVLink_message):  # 111
    tc1: int  # ns
    ts1: int  # ns
    def __init__(self, tc1: int, ts1: int) -> None: ...

class MAVLink_serial_control_message(_dialect.MAVLink_message):  # 126
    device: int  # SERIAL_CONTROL_DEV
    flags: int  # SERIAL_CONTROL_FLAG
    timeout: int  # ms
    baudrate: int  # bits/s
    count: int  # bytes
    data: list[int]
    def __init__(self, device: int, flags: int, timeout: int, baudrate: int, count: int,
        data: _Sequence[int]) -> None: ...

class MAVLink_gps_input_message(_dialect.MAVLink_message):  # 232
    time_usec: int  # us
    gps_id: int
    ignore_flags: int  # GPS_INPUT_IGNORE_FLAGS
    time_week_ms: int  # ms
    time_week: int
    fix_type: int
    lat: int  # degE7
    lon: int  # degE7
    alt: float  # m
    hdop: float
    vdop: float
    vn: float  # m/s
    ve: float  # m/s
    vd: float  # m/s
    speed_accuracy: float  # m/s
    horiz_accuracy: float  # m
    vert_accuracy: float  # m
    satellites_visible: int
    yaw: int  # cdeg
    def __init__(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int, time_week: int,
        fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float, ve: float,
        vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int, yaw: int = 0) -> None: ...

class MAVLink_wifi_config_ap_message(_dialect.MAVLink_message):  # 299
    ssid: str
    _ssid_raw: bytes
    password: str
    _password_raw: bytes
    def __init__(self, ssid: bytes, password: bytes) -> None: ...

class _Methods:
    def set_mode_encode(self, target_system: int, base_mode: int,
        custom_mode: int) -> MAVLink_set_mode_message: ...
    def set_mode_send(self, target_system: int, base_mode: int, custom_mode: int,
        force_mavlink1: bool = False) -> None: ...
    def raw_imu_encode(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int,
        zgyro: int, xmag: int, ymag: int, zmag: int, id: int = 0,
        temperature: int = 0) -> MAVLink_raw_imu_message: ...
    def raw_imu_send(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int,
        zgyro: int, xmag: int, ymag: int, zmag: int, id: int = 0, temperature: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def mission_current_encode(self, seq: int, total: int = 0, mission_state: int = 0,
        mission_mode: int = 0) -> MAVLink_mission_current_message: ...
    def mission_current_send(self, seq: int, total: int = 0, mission_state: int = 0, mission_mode: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def mission_count_encode(self, target_system: int, target_component: int, count: int,
        mission_type: int = 0) -> MAVLink_mission_count_message: ...
    def mission_count_send(self, target_system: int, target_component: int, count: int, mission_type: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def mission_ack_encode(self, target_system: int, target_component: int, type: int,
        mission_type: int = 0) -> MAVLink_mission_ack_message: ...
    def mission_ack_send(self, target_system: int, target_component: int, type: int, mission_type: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def command_ack_encode(self, command: int, result: int, progress: int = 0, result_param2: int = 0,
        target_system: int = 0, target_component: int = 0) -> MAVLink_command_ack_message: ...
    def command_ack_send(self, command: int, result: int, progress: int = 0, result_param2: int = 0,
        target_system: int = 0, target_component: int = 0, force_mavlink1: bool = False) -> None: ...
    def set_attitude_target_encode(self, time_boot_ms: int, target_system: int, target_component: int,
        type_mask: int, q: _Sequence[float], body_roll_rate: float, body_pitch_rate: float,
        body_yaw_rate: float, thrust: float) -> MAVLink_set_attitude_target_message: ...
    def set_attitude_target_send(self, time_boot_ms: int, target_system: int, target_component: int,
        type_mask: int, q: _Sequence[float], body_roll_rate: float, body_pitch_rate: float,
        body_yaw_rate: float, thrust: float, force_mavlink1: bool = False) -> None: ...
    def optical_flow_encode(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int,
        flow_comp_m_x: float, flow_comp_m_y: float, quality: int, ground_distance: float,
        flow_rate_x: float = 0, flow_rate_y: float = 0) -> MAVLink_optical_flow_message: ...
    def optical_flow_send(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int,
        flow_comp_m_x: float, flow_comp_m_y: float, quality: int, ground_distance: float,
        flow_rate_x: float = 0, flow_rate_y: float = 0, force_mavlink1: bool = False) -> None: ...
    def timesync_encode(self, tc1: int, ts1: int) -> MAVLink_timesync_message: ...
    def timesync_send(self, tc1: int, ts1: int, force_mavlink1: bool = False) -> None: ...
    def serial_control_encode(self, device: int, flags: int, timeout: int, baudrate: int, count: int,
        data: _Sequence[int]) -> MAVLink_serial_control_message: ...
    def serial_control_send(self, device: int, flags: int, timeout: int, baudrate: int, count: int,
        data: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def gps_input_encode(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int,
        time_week: int, fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float,
        ve: float, vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int, yaw: int = 0) -> MAVLink_gps_input_message: ...
    def gps_input_send(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int,
        time_week: int, fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float,
        ve: float, vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int, yaw: int = 0, force_mavlink1: bool = False) -> None: ...
    def wifi_config_ap_encode(self, ssid: bytes, password: bytes) -> MAVLink_wifi_config_ap_message: ...
    def wifi_config_ap_send(self, ssid: bytes, password: bytes, force_mavlink1: bool = False) -> None: ...
