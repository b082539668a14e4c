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
    def __init__(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int, zgyro: int,
        xmag: int, ymag: int, zmag: int) -> None: ...

class MAVLink_optical_flow_message(_dialect.MAVLink_message):  # 100
    time_usec: int  # us
    sensor_id: int
    flow_x: int  # rad/s
    flow_y: int  # rad/s
    flow_comp_m_x: float  # m/s
    flow_comp_m_y: float  # m/s
    quality: int
    ground_distance: float  # m
    def __init__(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int, flow_comp_m_x: float,
        flow_comp_m_y: float, quality: int, ground_distance: float) -> None: ...

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
    def __init__(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int, time_week: int,
        fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float, ve: float,
        vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int) -> None: ...

class _Methods:
    def set_mode_encode(self, target_system: int, base_mode: int,
        custom_mode: int) -> MAVLink_set_mode_message: ...
    def set_mode_send(self, target_system: int, base_mode: int, custom_mode: int,
        force_mavlink1: bool = False) -> None: ...
    def raw_imu_encode(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int,
        zgyro: int, xmag: int, ymag: int, zmag: int) -> MAVLink_raw_imu_message: ...
    def raw_imu_send(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int,
        zgyro: int, xmag: int, ymag: int, zmag: int, force_mavlink1: bool = False) -> None: ...
    def optical_flow_encode(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int,
        flow_comp_m_x: float, flow_comp_m_y: float, quality: int,
        ground_distance: float) -> MAVLink_optical_flow_message: ...
    def optical_flow_send(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int,
        flow_comp_m_x: float, flow_comp_m_y: float, quality: int, ground_distance: float,
        force_mavlink1: bool = False) -> None: ...
    def gps_input_encode(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int,
        time_week: int, fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float,
        ve: float, vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int) -> MAVLink_gps_input_message: ...
    def gps_input_send(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int,
        time_week: int, fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float,
        ve: float, vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int, force_mavlink1: bool = False) -> None: ...
