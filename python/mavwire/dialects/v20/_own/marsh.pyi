"""What dialect marsh itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_CONTROL_LOADING_AXIS: int = 52501
MAVLINK_MSG_ID_MOTION_PLATFORM_STATE: int = 52502
MAVLINK_MSG_ID_REXROTH_MOTION_PLATFORM: int = 52503
MAVLINK_MSG_ID_MOTION_CUE_EXTRA: int = 52504
MAVLINK_MSG_ID_EYE_TRACKING_DATA: int = 52505
MARSH_TYPE_MANAGER: int = 100
MARSH_TYPE_FLIGHT_MODEL: int = 101
MARSH_TYPE_CONTROLS: int = 102
MARSH_TYPE_VISUALISATION: int = 103
MARSH_TYPE_INSTRUMENTS: int = 104
MARSH_TYPE_MOTION_PLATFORM: int = 105
MARSH_TYPE_GSEAT: int = 106
MARSH_TYPE_EYE_TRACKER: int = 107
MARSH_TYPE_CONTROL_LOADING: int = 108
MARSH_TYPE_VIBRATION_SOURCE: int = 109
MARSH_TYPE_PILOT_TARGET: int = 110
MARSH_TYPE_EXPERIMENT_DIRECTOR: int = 111
MARSH_TYPE_ENUM_END: int
MARSH_MODE_SINGLE_MESSAGE: int = 16777216
MARSH_MODE_ALL_MESSAGES: int = 33554432
MARSH_MODE_FLAGS_ENUM_END: int
CONTROL_AXIS_ROLL: int = 0
CONTROL_AXIS_PITCH: int = 1
CONTROL_AXIS_THRUST: int = 2
CONTROL_AXIS_YAW: int = 3
CONTROL_AXIS_ENUM_END: int
MARSH_MANUAL_SETPOINT_MODE_TARGET: int = 0
MARSH_MANUAL_SETPOINT_MODE_TRIM: int = 1
MARSH_MANUAL_SETPOINT_MODE_ENUM_END: int
MOTION_PLATFORM_MODE_UNKNOWN: int = 0
MOTION_PLATFORM_MODE_UNINITIALIZED: int = 1
MOTION_PLATFORM_MODE_OFF: int = 2
MOTION_PLATFORM_MODE_SETTLED: int = 3
MOTION_PLATFORM_MODE_NEUTRAL: int = 4
MOTION_PLATFORM_MODE_FROZEN: int = 5
MOTION_PLATFORM_MODE_ENGAGED: int = 6
MOTION_PLATFORM_MODE_ENUM_END: int
MOTION_PLATFORM_HEALTH_OK: int = 0
MOTION_PLATFORM_HEALTH_WARNING: int = 1
MOTION_PLATFORM_HEALTH_ERROR: int = 2
MOTION_PLATFORM_HEALTH_CRITICAL: int = 3
MOTION_PLATFORM_HEALTH_ENUM_END: int

class MAVLink_control_loading_axis_message(_dialect.MAVLink_message):  # 52501
    time_boot_ms: int  # ms
    axis: int  # CONTROL_AXIS
    position: float  # deg
    velocity: float  # deg/s
    force: float
    def __init__(self, time_boot_ms: int, axis: int, position: float, velocity: float,
        force: float) -> None: ...

class MAVLink_motion_platform_state_message(_dialect.MAVLink_message):  # 52502
    time_boot_ms: int  # ms
    health: int  # MOTION_PLATFORM_HEALTH
    mode: int  # MOTION_PLATFORM_MODE
    x: float  # m
    y: float  # m
    z: float  # m
    roll: float  # rad
    pitch: float  # rad
    yaw: float  # rad
    vel_x: float  # m/s
    vel_y: float  # m/s
    vel_z: float  # m/s
    vel_roll: float  # rad/s
    vel_pitch: float  # rad/s
    vel_yaw: float  # rad/s
    acc_x: float  # m/s/s
    acc_y: float  # m/s/s
    acc_z: float  # m/s/s
    acc_roll: float
    acc_pitch: float
    acc_yaw: float
    def __init__(self, time_boot_ms: int, health: int, mode: int, x: float, y: float, z: float, roll: float,
        pitch: float, yaw: float, vel_x: float, vel_y: float, vel_z: float, vel_roll: float, vel_pitch: float,
        vel_yaw: float, acc_x: float, acc_y: float, acc_z: float, acc_roll: float, acc_pitch: float,
        acc_yaw: float) -> None: ...

class MAVLink_rexroth_motion_platform_message(_dialect.MAVLink_message):  # 52503
    time_boot_ms: int  # ms
    frame_count: int
    motion_status: int
    error_code: int
    actuator1: float  # m
    actuator2: float  # m
    actuator3: float  # m
    actuator4: float  # m
    actuator5: float  # m
    actuator6: float  # m
    platform_setpoint_x: float  # m
    platform_setpoint_y: float  # m
    platform_setpoint_z: float  # m
    platform_setpoint_roll: float  # rad
    platform_setpoint_pitch: float  # rad
    platform_setpoint_yaw: float  # rad
    effect_setpoint_x: float  # m
    effect_setpoint_y: float  # m
    effect_setpoint_z: float  # m
    effect_setpoint_roll: float  # rad
    effect_setpoint_pitch: float  # rad
    effect_setpoint_yaw: float  # rad
    def __init__(self, time_boot_ms: int, frame_count: int, motion_status: int, error_code: int,
        actuator1: float, actuator2: float, actuator3: float, actuator4: float, actuator5: float,
        actuator6: float, platform_setpoint_x: float, platform_setpoint_y: float, platform_setpoint_z: float,
        platform_setpoint_roll: float, platform_setpoint_pitch: float, platform_setpoint_yaw: float,
        effect_setpoint_x: float, effect_setpoint_y: float, effect_setpoint_z: float,
        effect_setpoint_roll: float, effect_setpoint_pitch: float, effect_setpoint_yaw: float) -> None: ...

class MAVLink_motion_cue_extra_message(_dialect.MAVLink_message):  # 52504
    time_boot_ms: int  # ms
    vel_roll: float  # rad/s
    vel_pitch: float  # rad/s
    vel_yaw: float  # rad/s
    acc_x: float  # m/s/s
    acc_y: float  # m/s/s
    acc_z: float  # m/s/s
    def __init__(self, time_boot_ms: int, vel_roll: float, vel_pitch: float, vel_yaw: float, acc_x: float,
        acc_y: float, acc_z: float) -> None: ...

class MAVLink_eye_tracking_data_message(_dialect.MAVLink_message):  # 52505
    time_usec: int  # us
    sensor_id: int
    gaze_origin_x: float  # m
    gaze_origin_y: float  # m
    gaze_origin_z: float  # m
    gaze_direction_x: float
    gaze_direction_y: float
    gaze_direction_z: float
    video_gaze_x: float
    video_gaze_y: float
    surface_id: int
    surface_gaze_x: float
    surface_gaze_y: float
    def __init__(self, time_usec: int, sensor_id: int, gaze_origin_x: float, gaze_origin_y: float,
        gaze_origin_z: float, gaze_direction_x: float, gaze_direction_y: float, gaze_direction_z: float,
        video_gaze_x: float, video_gaze_y: float, surface_id: int, surface_gaze_x: float,
        surface_gaze_y: float) -> None: ...

class _Methods:
    def control_loading_axis_encode(self, time_boot_ms: int, axis: int, position: float, velocity: float,
        force: float) -> MAVLink_control_loading_axis_message: ...
    def control_loading_axis_send(self, time_boot_ms: int, axis: int, position: float, velocity: float,
        force: float, force_mavlink1: bool = False) -> None: ...
    def motion_platform_state_encode(self, time_boot_ms: int, health: int, mode: int, x: float, y: float,
        z: float, roll: float, pitch: float, yaw: float, vel_x: float, vel_y: float, vel_z: float,
        vel_roll: float, vel_pitch: float, vel_yaw: float, acc_x: float, acc_y: float, acc_z: float,
        acc_roll: float, acc_pitch: float, acc_yaw: float) -> MAVLink_motion_platform_state_message: ...
    def motion_platform_state_send(self, time_boot_ms: int, health: int, mode: int, x: float, y: float,
        z: float, roll: float, pitch: float, yaw: float, vel_x: float, vel_y: float, vel_z: float,
        vel_roll: float, vel_pitch: float, vel_yaw: float, acc_x: float, acc_y: float, acc_z: float,
        acc_roll: float, acc_pitch: float, acc_yaw: float, force_mavlink1: bool = False) -> None: ...
    def rexroth_motion_platform_encode(self, time_boot_ms: int, frame_count: int, motion_status: int,
        error_code: int, actuator1: float, actuator2: float, actuator3: float, actuator4: float,
        actuator5: float, actuator6: float, platform_setpoint_x: float, platform_setpoint_y: float,
        platform_setpoint_z: float, platform_setpoint_roll: float, platform_setpoint_pitch: float,
        platform_setpoint_yaw: float, effect_setpoint_x: float, effect_setpoint_y: float,
        effect_setpoint_z: float, effect_setpoint_roll: float, effect_setpoint_pitch: float,
        effect_setpoint_yaw: float) -> MAVLink_rexroth_motion_platform_message: ...
    def rexroth_motion_platform_send(self, time_boot_ms: int, frame_count: int, motion_status: int,
        error_code: int, actuator1: float, actuator2: float, actuator3: float, actuator4: float,
        actuator5: float, actuator6: float, platform_setpoint_x: float, platform_setpoint_y: float,
        platform_setpoint_z: float, platform_setpoint_roll: float, platform_setpoint_pitch: float,
        platform_setpoint_yaw: float, effect_setpoint_x: float, effect_setpoint_y: float,
        effect_setpoint_z: float, effect_setpoint_roll: float, effect_setpoint_pitch: float,
        effect_setpoint_yaw: float, force_mavlink1: bool = False) -> None: ...
    def motion_cue_extra_encode(self, time_boot_ms: int, vel_roll: float, vel_pitch: float, vel_yaw: float,
        acc_x: float, acc_y: float, acc_z: float) -> MAVLink_motion_cue_extra_message: ...
    def motion_cue_extra_send(self, time_boot_ms: int, vel_roll: float, vel_pitch: float, vel_yaw: float,
        acc_x: float, acc_y: float, acc_z: float, force_mavlink1: bool = False) -> None: ...
    def eye_tracking_data_encode(self, time_usec: int, sensor_id: int, gaze_origin_x: float,
        gaze_origin_y: float, gaze_origin_z: float, gaze_direction_x: float, gaze_direction_y: float,
        gaze_direction_z: float, video_gaze_x: float, video_gaze_y: float, surface_id: int,
        surface_gaze_x: float, surface_gaze_y: float) -> MAVLink_eye_tracking_data_message: ...
    def eye_tracking_data_send(self, time_usec: int, sensor_id: int, gaze_origin_x: float,
        gaze_origin_y: float, gaze_origin_z: float, gaze_direction_x: float, gaze_direction_y: float,
        gaze_direction_z: float, video_gaze_x: float, video_gaze_y: float, surface_id: int,
        surface_gaze_x: float, surface_gaze_y: float, force_mavlink1: bool = False) -> None: ...
