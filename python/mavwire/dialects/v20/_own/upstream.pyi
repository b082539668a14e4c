"""What dialect upstream itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_LINK_NODE_STATUS: int = 8
MAVLINK_MSG_ID_COMMAND_CANCEL: int = 80
MAVLINK_MSG_ID_ESC_INFO: int = 290
MAVLINK_MSG_ID_ESC_STATUS: int = 291
MAVLINK_MSG_ID_ESC_EEPROM: int = 292
MAVLINK_MSG_ID_PROTOCOL_VERSION: int = 300
MAVLINK_MSG_ID_CELLULAR_STATUS: int = 334
MAVLINK_MSG_ID_CELLULAR_CONFIG: int = 336
MAVLINK_MSG_ID_SET_VELOCITY_LIMITS: int = 354
MAVLINK_MSG_ID_VELOCITY_LIMITS: int = 355
MAVLINK_MSG_ID_FIGURE_EIGHT_EXECUTION_STATUS: int = 361
MAVLINK_MSG_ID_BATTERY_STATUS_V2: int = 369
MAVLINK_MSG_ID_FUEL_STATUS: int = 371
MAVLINK_MSG_ID_BATTERY_INFO: int = 372
MAVLINK_MSG_ID_TIME_ESTIMATE_TO_TARGET: int = 380
MAVLINK_MSG_ID_COMPONENT_INFORMATION: int = 395
MAVLINK_MSG_ID_COMPONENT_INFORMATION_BASIC: int = 396
MAVLINK_MSG_ID_COMPONENT_METADATA: int = 397
MAVLINK_MSG_ID_PLAY_TUNE_V2: int = 400
MAVLINK_MSG_ID_SUPPORTED_TUNES: int = 401
MAVLINK_MSG_ID_EVENT: int = 410
MAVLINK_MSG_ID_CURRENT_EVENT_SEQUENCE: int = 411
MAVLINK_MSG_ID_REQUEST_EVENT: int = 412
MAVLINK_MSG_ID_RESPONSE_EVENT_ERROR: int = 413
MAVLINK_MSG_ID_GROUP_START: int = 414
MAVLINK_MSG_ID_GROUP_END: int = 415
MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE_V2: int = 421
MAVLINK_MSG_ID_ILLUMINATOR_STATUS: int = 440
MAVLINK_MSG_ID_TARGET_ABSOLUTE: int = 510
MAVLINK_MSG_ID_TARGET_RELATIVE: int = 511
MAVLINK_MSG_ID_CONTROL_STATUS: int = 512
MAVLINK_MSG_ID_ESTIMATOR_SENSOR_FUSION_STATUS: int = 514
MAVLINK_MSG_ID_CONTROL_LOADING_AXIS: int = 52501
MAVLINK_MSG_ID_MOTION_PLATFORM_STATE: int = 52502
MAVLINK_MSG_ID_REXROTH_MOTION_PLATFORM: int = 52503
MAVLINK_MSG_ID_MOTION_CUE_EXTRA: int = 52504
MAVLINK_MSG_ID_EYE_TRACKING_DATA: int = 52505
MAVLINK_MSG_ID_LED_STRIP_CONFIG: int = 52600
MAVLINK_MSG_ID_LED_STRIP_STATE: int = 52601
ACTUATOR_TEST_GROUP_ROLL_TORQUE: int = 0
ACTUATOR_TEST_GROUP_PITCH_TORQUE: int = 1
ACTUATOR_TEST_GROUP_YAW_TORQUE: int = 2
ACTUATOR_TEST_GROUP_COLLECTIVE_TILT: int = 3
ACTUATOR_TEST_GROUP_X_THRUST: int = 4
ACTUATOR_TEST_GROUP_Y_THRUST: int = 5
ACTUATOR_TEST_GROUP_Z_THRUST: int = 6
ACTUATOR_TEST_GROUP_ENUM_END: int
ATTITUDE_TARGET_TYPEMASK_THRUST_BODY_SET: int = 32
CELLULAR_CONFIG_RESPONSE_ACCEPTED: int = 0
CELLULAR_CONFIG_RESPONSE_APN_ERROR: int = 1
CELLULAR_CONFIG_RESPONSE_PIN_ERROR: int = 2
CELLULAR_CONFIG_RESPONSE_REJECTED: int = 3
CELLULAR_CONFIG_BLOCKED_PUK_REQUIRED: int = 4
CELLULAR_CONFIG_RESPONSE_ENUM_END: int
CELLULAR_NETWORK_FAILED_REASON_NONE: int = 0
CELLULAR_NETWORK_FAILED_REASON_UNKNOWN: int = 1
CELLULAR_NETWORK_FAILED_REASON_SIM_MISSING: int = 2
CELLULAR_NETWORK_FAILED_REASON_SIM_ERROR: int = 3
CELLULAR_NETWORK_FAILED_REASON_ENUM_END: int
CELLULAR_NETWORK_RADIO_TYPE_NONE: int = 0
CELLULAR_NETWORK_RADIO_TYPE_GSM: int = 1
CELLULAR_NETWORK_RADIO_TYPE_CDMA: int = 2
CELLULAR_NETWORK_RADIO_TYPE_WCDMA: int = 3
CELLULAR_NETWORK_RADIO_TYPE_LTE: int = 4
CELLULAR_NETWORK_RADIO_TYPE_ENUM_END: int
CELLULAR_STATUS_FLAG_UNKNOWN: int = 0
CELLULAR_STATUS_FLAG_FAILED: int = 1
CELLULAR_STATUS_FLAG_INITIALIZING: int = 2
CELLULAR_STATUS_FLAG_LOCKED: int = 3
CELLULAR_STATUS_FLAG_DISABLED: int = 4
CELLULAR_STATUS_FLAG_DISABLING: int = 5
CELLULAR_STATUS_FLAG_ENABLING: int = 6
CELLULAR_STATUS_FLAG_ENABLED: int = 7
CELLULAR_STATUS_FLAG_SEARCHING: int = 8
CELLULAR_STATUS_FLAG_REGISTERED: int = 9
CELLULAR_STATUS_FLAG_DISCONNECTING: int = 10
CELLULAR_STATUS_FLAG_CONNECTING: int = 11
CELLULAR_STATUS_FLAG_CONNECTED: int = 12
CELLULAR_STATUS_FLAG_ENUM_END: int
COMP_METADATA_TYPE_GENERAL: int = 0
COMP_METADATA_TYPE_PARAMETER: int = 1
COMP_METADATA_TYPE_COMMANDS: int = 2
COMP_METADATA_TYPE_PERIPHERALS: int = 3
COMP_METADATA_TYPE_EVENTS: int = 4
COMP_METADATA_TYPE_ACTUATORS: int = 5
COMP_METADATA_TYPE_ENUM_END: int
CONTROL_AXIS_ROLL: int = 0
CONTROL_AXIS_PITCH: int = 1
CONTROL_AXIS_THRUST: int = 2
CONTROL_AXIS_YAW: int = 3
CONTROL_AXIS_ENUM_END: int
COPTER_MODE_RATE_ACRO: int = 29
ESC_CONNECTION_TYPE_PPM: int = 0
ESC_CONNECTION_TYPE_SERIAL: int = 1
ESC_CONNECTION_TYPE_ONESHOT: int = 2
ESC_CONNECTION_TYPE_I2C: int = 3
ESC_CONNECTION_TYPE_CAN: int = 4
ESC_CONNECTION_TYPE_DSHOT: int = 5
ESC_CONNECTION_TYPE_ENUM_END: int
ESC_FAILURE_OVER_CURRENT: int = 1
ESC_FAILURE_OVER_VOLTAGE: int = 2
ESC_FAILURE_OVER_TEMPERATURE: int = 4
ESC_FAILURE_OVER_RPM: int = 8
ESC_FAILURE_INCONSISTENT_CMD: int = 16
ESC_FAILURE_MOTOR_STUCK: int = 32
ESC_FAILURE_GENERIC: int = 64
ESC_FAILURE_FLAGS_ENUM_END: int
ESC_FIRMWARE_UNKNOWN: int = 0
ESC_FIRMWARE_AM32: int = 1
ESC_FIRMWARE_BLUEJAY: int = 2
ESC_FIRMWARE_BLHELI32: int = 3
ESC_FIRMWARE_ENUM_END: int
ESTIMATOR_SENSOR_FUSION_SOURCE_GPS: int = 0
ESTIMATOR_SENSOR_FUSION_SOURCE_OF: int = 1
ESTIMATOR_SENSOR_FUSION_SOURCE_EV: int = 2
ESTIMATOR_SENSOR_FUSION_SOURCE_AGP: int = 3
ESTIMATOR_SENSOR_FUSION_SOURCE_BARO: int = 4
ESTIMATOR_SENSOR_FUSION_SOURCE_RNG: int = 5
ESTIMATOR_SENSOR_FUSION_SOURCE_MAG: int = 6
ESTIMATOR_SENSOR_FUSION_SOURCE_ASPD: int = 7
ESTIMATOR_SENSOR_FUSION_SOURCE_RANGING_BEACON: int = 8
ESTIMATOR_SENSOR_FUSION_SOURCE_ENUM_END: int
FAILURE_TYPE_DRIFT: int = 8
FAILURE_UNIT_SYSTEM_ESC: int = 106
FAILURE_UNIT_SYSTEM_TRAFFIC_AVOIDANCE: int = 107
GCS_CONTROL_STATUS_FLAGS_SYSTEM_MANAGER: int = 1
GCS_CONTROL_STATUS_FLAGS_TAKEOVER_ALLOWED: int = 2
GCS_CONTROL_STATUS_FLAGS_ENUM_END: int
GLOBAL_POSITION_SRC_LEO: int = 7
LED_CONFIG_MODE_ALL: int = 0
LED_CONFIG_MODE_INDEX: int = 1
LED_CONFIG_MODE_FOLLOW_FLIGHT_MODE: int = 2
LED_CONFIG_MODE_CLEAR: int = 3
LED_CONFIG_MODE_ENUM_END: int
MARSH_MANUAL_SETPOINT_MODE_TARGET: int = 0
MARSH_MANUAL_SETPOINT_MODE_TRIM: int = 1
MARSH_MANUAL_SETPOINT_MODE_ENUM_END: int
MARSH_MODE_SINGLE_MESSAGE: int = 16777216
MARSH_MODE_ALL_MESSAGES: int = 33554432
MARSH_MODE_FLAGS_ENUM_END: int
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
MAV_BATTERY_STATUS_FLAGS_NOT_READY_TO_USE: int = 1
MAV_BATTERY_STATUS_FLAGS_CHARGING: int = 2
MAV_BATTERY_STATUS_FLAGS_CELL_BALANCING: int = 4
MAV_BATTERY_STATUS_FLAGS_FAULT_CELL_IMBALANCE: int = 8
MAV_BATTERY_STATUS_FLAGS_AUTO_DISCHARGING: int = 16
MAV_BATTERY_STATUS_FLAGS_REQUIRES_SERVICE: int = 32
MAV_BATTERY_STATUS_FLAGS_BAD_BATTERY: int = 64
MAV_BATTERY_STATUS_FLAGS_PROTECTIONS_ENABLED: int = 128
MAV_BATTERY_STATUS_FLAGS_FAULT_PROTECTION_SYSTEM: int = 256
MAV_BATTERY_STATUS_FLAGS_FAULT_OVER_VOLT: int = 512
MAV_BATTERY_STATUS_FLAGS_FAULT_UNDER_VOLT: int = 1024
MAV_BATTERY_STATUS_FLAGS_FAULT_OVER_TEMPERATURE: int = 2048
MAV_BATTERY_STATUS_FLAGS_FAULT_UNDER_TEMPERATURE: int = 4096
MAV_BATTERY_STATUS_FLAGS_FAULT_OVER_CURRENT: int = 8192
MAV_BATTERY_STATUS_FLAGS_FAULT_SHORT_CIRCUIT: int = 16384
MAV_BATTERY_STATUS_FLAGS_FAULT_INCOMPATIBLE_VOLTAGE: int = 32768
MAV_BATTERY_STATUS_FLAGS_FAULT_INCOMPATIBLE_FIRMWARE: int = 65536
MAV_BATTERY_STATUS_FLAGS_FAULT_INCOMPATIBLE_CELLS_CONFIGURATION: int = 131072
MAV_BATTERY_STATUS_FLAGS_CAPACITY_RELATIVE_TO_FULL: int = 262144
MAV_BATTERY_STATUS_FLAGS_EXTENDED: int = 2147483648
MAV_BATTERY_STATUS_FLAGS_ENUM_END: int
MAV_CMD_ACTUATOR_GROUP_TEST: int = 309
MAV_CMD_DUMMY_ALL: int = 393
MAV_CMD_EXTERNAL_ATTITUDE_ESTIMATE: int = 620
MAV_CMD_ODID_SET_EMERGENCY: int = 12900
MAV_CMD_REQUEST_OPERATOR_CONTROL: int = 32100
MAV_CMD_ESTIMATOR_SENSOR_ENABLE: int = 43006
MAV_COMP_ID_RADIO: int = 110
MAV_COMP_ID_RADIO2: int = 111
MAV_COMP_ID_RADIO3: int = 112
MAV_EVENT_CURRENT_SEQUENCE_FLAGS_RESET: int = 1
MAV_EVENT_CURRENT_SEQUENCE_FLAGS_ENUM_END: int
MAV_EVENT_ERROR_REASON_UNAVAILABLE: int = 0
MAV_EVENT_ERROR_REASON_ENUM_END: int
MAV_FTP_OPCODE_LISTDIRECTORYWITHTIME: int = 16
MAV_FUEL_TYPE_UNKNOWN: int = 0
MAV_FUEL_TYPE_LIQUID: int = 1
MAV_FUEL_TYPE_GAS: int = 2
MAV_FUEL_TYPE_ENUM_END: int
MAV_MODE_PROPERTY_AUTO_MODE: int = 4
MAV_PARAM_ERROR_TYPE_UNSUPPORTED: int = 6
MAV_PARAM_ERROR_TYPE_MISMATCH: int = 7
MAV_PARAM_ERROR_READ_FAIL: int = 8
MAV_RESULT_CANCELLED: int = 6
MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME: int = 9
MAV_RESULT_NOT_IN_CONTROL: int = 10
MAV_SYS_STATUS_SENSOR_3D_GYRO3: int = 4
MAV_SYS_STATUS_SENSOR_3D_ACCEL3: int = 8
MAV_SYS_STATUS_SENSOR_3D_GYRO4: int = 16
MAV_SYS_STATUS_SENSOR_3D_ACCEL4: int = 32
MAV_TYPE_VTOL_TAILSITTER_DUOROTOR: int = 19
MAV_TYPE_VTOL_TAILSITTER_QUADROTOR: int = 20
MAV_TYPE_VTOL_FIXEDROTOR: int = 22
MAV_TYPE_VTOL_TAILSITTER: int = 23
MAV_TYPE_VTOL_TILTWING: int = 24
MAV_TYPE_RADIO: int = 49
MAV_WINCH_STATUS_LOCKED: int = 16
MAV_WINCH_STATUS_DROPPING: int = 32
MAV_WINCH_STATUS_ARRESTING: int = 64
MAV_WINCH_STATUS_GROUND_SENSE: int = 128
MAV_WINCH_STATUS_RETRACTING: int = 256
MAV_WINCH_STATUS_REDELIVER: int = 512
MAV_WINCH_STATUS_ABANDON_LINE: int = 1024
MAV_WINCH_STATUS_LOCKING: int = 2048
MAV_WINCH_STATUS_LOAD_LINE: int = 4096
MAV_WINCH_STATUS_LOAD_PAYLOAD: int = 8192
MOTION_PLATFORM_HEALTH_OK: int = 0
MOTION_PLATFORM_HEALTH_WARNING: int = 1
MOTION_PLATFORM_HEALTH_ERROR: int = 2
MOTION_PLATFORM_HEALTH_CRITICAL: int = 3
MOTION_PLATFORM_HEALTH_ENUM_END: int
MOTION_PLATFORM_MODE_UNKNOWN: int = 0
MOTION_PLATFORM_MODE_UNINITIALIZED: int = 1
MOTION_PLATFORM_MODE_OFF: int = 2
MOTION_PLATFORM_MODE_SETTLED: int = 3
MOTION_PLATFORM_MODE_NEUTRAL: int = 4
MOTION_PLATFORM_MODE_FROZEN: int = 5
MOTION_PLATFORM_MODE_ENGAGED: int = 6
MOTION_PLATFORM_MODE_ENUM_END: int
SERIAL_CONTROL_DEV_TELEM3: int = 4
SERIAL_CONTROL_DEV_TELEM4: int = 5
SERIAL_CONTROL_DEV_ESC0: int = 20
SERIAL_CONTROL_DEV_ESC1: int = 21
SERIAL_CONTROL_DEV_ESC2: int = 22
SERIAL_CONTROL_DEV_ESC3: int = 23
SERIAL_CONTROL_DEV_ESC4: int = 24
SERIAL_CONTROL_DEV_ESC5: int = 25
SERIAL_CONTROL_DEV_ESC6: int = 26
SERIAL_CONTROL_DEV_ESC7: int = 27
TARGET_ABSOLUTE_SENSOR_CAPABILITY_POSITION: int = 1
TARGET_ABSOLUTE_SENSOR_CAPABILITY_VELOCITY: int = 2
TARGET_ABSOLUTE_SENSOR_CAPABILITY_ACCELERATION: int = 4
TARGET_ABSOLUTE_SENSOR_CAPABILITY_ATTITUDE: int = 8
TARGET_ABSOLUTE_SENSOR_CAPABILITY_RATES: int = 16
TARGET_ABSOLUTE_SENSOR_CAPABILITY_FLAGS_ENUM_END: int
TARGET_OBS_FRAME_LOCAL_NED: int = 0
TARGET_OBS_FRAME_BODY_FRD: int = 1
TARGET_OBS_FRAME_LOCAL_OFFSET_NED: int = 2
TARGET_OBS_FRAME_OTHER: int = 3
TARGET_OBS_FRAME_ENUM_END: int
TUNE_FORMAT_QBASIC1_1: int = 1
TUNE_FORMAT_MML_MODERN: int = 2
TUNE_FORMAT_ENUM_END: int
WIFI_CONFIG_AP_MODE_UNDEFINED: int = 0
WIFI_CONFIG_AP_MODE_AP: int = 1
WIFI_CONFIG_AP_MODE_STATION: int = 2
WIFI_CONFIG_AP_MODE_DISABLED: int = 3
WIFI_CONFIG_AP_MODE_ENUM_END: int
WIFI_CONFIG_AP_RESPONSE_UNDEFINED: int = 0
WIFI_CONFIG_AP_RESPONSE_ACCEPTED: int = 1
WIFI_CONFIG_AP_RESPONSE_REJECTED: int = 2
WIFI_CONFIG_AP_RESPONSE_MODE_ERROR: int = 3
WIFI_CONFIG_AP_RESPONSE_SSID_ERROR: int = 4
WIFI_CONFIG_AP_RESPONSE_PASSWORD_ERROR: int = 5
WIFI_CONFIG_AP_RESPONSE_ENUM_END: int

class MAVLink_link_node_status_message(_dialect.MAVLink_message):  # 8
    timestamp: int  # ms
    tx_buf: int  # %
    rx_buf: int  # %
    tx_rate: int  # bytes/s
    rx_rate: int  # bytes/s
    rx_parse_err: int  # bytes
    tx_overflows: int  # bytes
    rx_overflows: int  # bytes
    messages_sent: int
    messages_received: int
    messages_lost: int
    def __init__(self, timestamp: int, tx_buf: int, rx_buf: int, tx_rate: int, rx_rate: int,
        rx_parse_err: int, tx_overflows: int, rx_overflows: int, messages_sent: int, messages_received: int,
        messages_lost: int) -> None: ...

class MAVLink_set_mode_message(_dialect.MAVLink_message):  # 11
    target_system: int
    base_mode: int  # MAV_MODE_FLAG
    custom_mode: int
    def __init__(self, target_system: int, base_mode: int, custom_mode: int) -> None: ...

class MAVLink_raw_imu_message(_dialect.MAVLink_message):  # 27
    time_usec: int  # us
    xacc: int
    yacc: int
    zacc: int
    xgyro: int
    ygyro: int
    zgyro: int
    xmag: int
    ymag: int
    zmag: int
    id: int
    temperature: int  # cdegC
    def __init__(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int, zgyro: int,
        xmag: int, ymag: int, zmag: int, id: int = 0, temperature: int = 0) -> None: ...

class MAVLink_mission_current_message(_dialect.MAVLink_message):  # 42
    seq: int
    total: int
    mission_state: int  # MISSION_STATE
    mission_mode: int
    mission_id: int
    fence_id: int
    rally_points_id: int
    def __init__(self, seq: int, total: int = 0, mission_state: int = 0, mission_mode: int = 0,
        mission_id: int = 0, fence_id: int = 0, rally_points_id: int = 0) -> None: ...

class MAVLink_mission_count_message(_dialect.MAVLink_message):  # 44
    target_system: int
    target_component: int
    count: int
    mission_type: int  # MAV_MISSION_TYPE
    opaque_id: int
    def __init__(self, target_system: int, target_component: int, count: int, mission_type: int = 0,
        opaque_id: int = 0) -> None: ...

class MAVLink_mission_ack_message(_dialect.MAVLink_message):  # 47
    target_system: int
    target_component: int
    type: int  # MAV_MISSION_RESULT
    mission_type: int  # MAV_MISSION_TYPE
    opaque_id: int
    def __init__(self, target_system: int, target_component: int, type: int, mission_type: int = 0,
        opaque_id: int = 0) -> None: ...

class MAVLink_command_ack_message(_dialect.MAVLink_message):  # 77
    command: int  # MAV_CMD
    result: int  # MAV_RESULT
    progress: int  # %
    result_param2: int
    target_system: int
    target_component: int
    def __init__(self, command: int, result: int, progress: int = 0, result_param2: int = 0,
        target_system: int = 0, target_component: int = 0) -> None: ...

class MAVLink_command_cancel_message(_dialect.MAVLink_message):  # 80
    target_system: int
    target_component: int
    command: int  # MAV_CMD
    def __init__(self, target_system: int, target_component: int, command: int) -> None: ...

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
    thrust_body: list[float]
    def __init__(self, time_boot_ms: int, target_system: int, target_component: int, type_mask: int,
        q: _Sequence[float], body_roll_rate: float, body_pitch_rate: float, body_yaw_rate: float,
        thrust: float, thrust_body: _Sequence[float] = ...) -> None: ...

class MAVLink_optical_flow_message(_dialect.MAVLink_message):  # 100
    time_usec: int  # us
    sensor_id: int
    flow_x: int  # dpix
    flow_y: int  # dpix
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
    target_system: int
    target_component: int
    def __init__(self, tc1: int, ts1: int, target_system: int = 0, target_component: int = 0) -> None: ...

class MAVLink_serial_control_message(_dialect.MAVLink_message):  # 126
    device: int  # SERIAL_CONTROL_DEV
    flags: int  # SERIAL_CONTROL_FLAG
    timeout: int  # ms
    baudrate: int  # bits/s
    count: int  # bytes
    data: list[int]
    target_system: int
    target_component: int
    def __init__(self, device: int, flags: int, timeout: int, baudrate: int, count: int, data: _Sequence[int],
        target_system: int = 0, target_component: int = 0) -> None: ...

class MAVLink_gps_input_message(_dialect.MAVLink_message):  # 232
    time_usec: int  # us
    gps_id: int
    ignore_flags: int  # GPS_INPUT_IGNORE_FLAGS
    time_week_ms: int  # ms
    time_week: int
    fix_type: int  # GPS_FIX_TYPE
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

class MAVLink_esc_info_message(_dialect.MAVLink_message):  # 290
    index: int
    time_usec: int  # us
    counter: int
    count: int
    connection_type: int  # ESC_CONNECTION_TYPE
    info: int
    failure_flags: list[int]  # ESC_FAILURE_FLAGS
    error_count: list[int]
    temperature: list[int]  # cdegC
    def __init__(self, index: int, time_usec: int, counter: int, count: int, connection_type: int, info: int,
        failure_flags: _Sequence[int], error_count: _Sequence[int], temperature: _Sequence[int]) -> None: ...

class MAVLink_esc_status_message(_dialect.MAVLink_message):  # 291
    index: int
    time_usec: int  # us
    rpm: list[int]  # rpm
    voltage: list[float]  # V
    current: list[float]  # A
    def __init__(self, index: int, time_usec: int, rpm: _Sequence[int], voltage: _Sequence[float],
        current: _Sequence[float]) -> None: ...

class MAVLink_esc_eeprom_message(_dialect.MAVLink_message):  # 292
    target_system: int
    target_component: int
    firmware: int  # ESC_FIRMWARE
    msg_index: int
    msg_count: int
    esc_index: int
    write_mask: list[int]
    length: int
    data: list[int]
    def __init__(self, target_system: int, target_component: int, firmware: int, msg_index: int,
        msg_count: int, esc_index: int, write_mask: _Sequence[int], length: int,
        data: _Sequence[int]) -> None: ...

class MAVLink_wifi_config_ap_message(_dialect.MAVLink_message):  # 299
    ssid: str
    _ssid_raw: bytes
    password: str
    _password_raw: bytes
    mode: int  # WIFI_CONFIG_AP_MODE
    response: int  # WIFI_CONFIG_AP_RESPONSE
    def __init__(self, ssid: bytes, password: bytes, mode: int = 0, response: int = 0) -> None: ...

class MAVLink_protocol_version_message(_dialect.MAVLink_message):  # 300
    version: int
    min_version: int
    max_version: int
    spec_version_hash: list[int]
    library_version_hash: list[int]
    def __init__(self, version: int, min_version: int, max_version: int, spec_version_hash: _Sequence[int],
        library_version_hash: _Sequence[int]) -> None: ...

class MAVLink_cellular_status_message(_dialect.MAVLink_message):  # 334
    status: int  # CELLULAR_STATUS_FLAG
    failure_reason: int  # CELLULAR_NETWORK_FAILED_REASON
    type: int  # CELLULAR_NETWORK_RADIO_TYPE
    quality: int
    mcc: int
    mnc: int
    lac: int
    id: int
    link_tx_rate: int  # KiB/s
    link_rx_rate: int  # KiB/s
    cell_tower_id: str
    _cell_tower_id_raw: bytes
    band_number: int
    band_frequency: float  # MHz
    channel_number: int
    rx_level: float  # dBm
    tx_level: float  # dBm
    rx_quality: float  # dBm
    sinr: float  # dB
    def __init__(self, status: int, failure_reason: int, type: int, quality: int, mcc: int, mnc: int,
        lac: int, id: int = 0, link_tx_rate: int = 0, link_rx_rate: int = 0, cell_tower_id: bytes = b"",
        band_number: int = 0, band_frequency: float = 0, channel_number: int = 0, rx_level: float = 0,
        tx_level: float = 0, rx_quality: float = 0, sinr: float = 0) -> None: ...

class MAVLink_cellular_config_message(_dialect.MAVLink_message):  # 336
    enable_lte: int
    enable_pin: int
    pin: str
    _pin_raw: bytes
    new_pin: str
    _new_pin_raw: bytes
    apn: str
    _apn_raw: bytes
    puk: str
    _puk_raw: bytes
    roaming: int
    response: int  # CELLULAR_CONFIG_RESPONSE
    def __init__(self, enable_lte: int, enable_pin: int, pin: bytes, new_pin: bytes, apn: bytes, puk: bytes,
        roaming: int, response: int) -> None: ...

class MAVLink_set_velocity_limits_message(_dialect.MAVLink_message):  # 354
    target_system: int
    target_component: int
    horizontal_speed_limit: float  # m/s
    vertical_speed_limit: float  # m/s
    yaw_rate_limit: float  # rad/s
    def __init__(self, target_system: int, target_component: int, horizontal_speed_limit: float,
        vertical_speed_limit: float, yaw_rate_limit: float) -> None: ...

class MAVLink_velocity_limits_message(_dialect.MAVLink_message):  # 355
    horizontal_speed_limit: float  # m/s
    vertical_speed_limit: float  # m/s
    yaw_rate_limit: float  # rad/s
    def __init__(self, horizontal_speed_limit: float, vertical_speed_limit: float,
        yaw_rate_limit: float) -> None: ...

class MAVLink_figure_eight_execution_status_message(_dialect.MAVLink_message):  # 361
    time_usec: int  # us
    major_radius: float  # m
    minor_radius: float  # m
    orientation: float  # rad
    frame: int  # MAV_FRAME
    x: int
    y: int
    z: float  # m
    def __init__(self, time_usec: int, major_radius: float, minor_radius: float, orientation: float,
        frame: int, x: int, y: int, z: float) -> None: ...

class MAVLink_battery_status_v2_message(_dialect.MAVLink_message):  # 369
    id: int
    temperature: int  # cdegC
    voltage: float  # V
    current: float  # A
    capacity_consumed: float  # Ah
    capacity_remaining: float  # Ah
    state_of_charge: float  # %
    status_flags: int  # MAV_BATTERY_STATUS_FLAGS
    def __init__(self, id: int, temperature: int, voltage: float, current: float, capacity_consumed: float,
        capacity_remaining: float, state_of_charge: float, status_flags: int) -> None: ...

class MAVLink_fuel_status_message(_dialect.MAVLink_message):  # 371
    id: int
    maximum_fuel: float
    consumed_fuel: float
    remaining_fuel: float
    percent_remaining: int  # %
    flow_rate: float
    temperature: float  # K
    fuel_type: int  # MAV_FUEL_TYPE
    def __init__(self, id: int, maximum_fuel: float, consumed_fuel: float, remaining_fuel: float,
        percent_remaining: int, flow_rate: float, temperature: float, fuel_type: int) -> None: ...

class MAVLink_battery_info_message(_dialect.MAVLink_message):  # 372
    id: int
    battery_function: int  # MAV_BATTERY_FUNCTION
    type: int  # MAV_BATTERY_TYPE
    state_of_health: int  # %
    cells_in_series: int
    cycle_count: int
    weight: int  # g
    discharge_minimum_voltage: float  # V
    charging_minimum_voltage: float  # V
    resting_minimum_voltage: float  # V
    charging_maximum_voltage: float  # V
    charging_maximum_current: float  # A
    nominal_voltage: float  # V
    discharge_maximum_current: float  # A
    discharge_maximum_burst_current: float  # A
    design_capacity: float  # Ah
    full_charge_capacity: float  # Ah
    manufacture_date: str
    _manufacture_date_raw: bytes
    serial_number: str
    _serial_number_raw: bytes
    name: str
    _name_raw: bytes
    def __init__(self, id: int, battery_function: int, type: int, state_of_health: int, cells_in_series: int,
        cycle_count: int, weight: int, discharge_minimum_voltage: float, charging_minimum_voltage: float,
        resting_minimum_voltage: float, charging_maximum_voltage: float, charging_maximum_current: float,
        nominal_voltage: float, discharge_maximum_current: float, discharge_maximum_burst_current: float,
        design_capacity: float, full_charge_capacity: float, manufacture_date: bytes, serial_number: bytes,
        name: bytes) -> None: ...

class MAVLink_time_estimate_to_target_message(_dialect.MAVLink_message):  # 380
    safe_return: int  # s
    land: int  # s
    mission_next_item: int  # s
    mission_end: int  # s
    commanded_action: int  # s
    def __init__(self, safe_return: int, land: int, mission_next_item: int, mission_end: int,
        commanded_action: int) -> None: ...

class MAVLink_component_information_message(_dialect.MAVLink_message):  # 395
    time_boot_ms: int  # ms
    general_metadata_file_crc: int
    general_metadata_uri: str
    _general_metadata_uri_raw: bytes
    peripherals_metadata_file_crc: int
    peripherals_metadata_uri: str
    _peripherals_metadata_uri_raw: bytes
    def __init__(self, time_boot_ms: int, general_metadata_file_crc: int, general_metadata_uri: bytes,
        peripherals_metadata_file_crc: int, peripherals_metadata_uri: bytes) -> None: ...

class MAVLink_component_information_basic_message(_dialect.MAVLink_message):  # 396
    time_boot_ms: int  # ms
    capabilities: int  # MAV_PROTOCOL_CAPABILITY
    time_manufacture_s: int  # s
    vendor_name: str
    _vendor_name_raw: bytes
    model_name: str
    _model_name_raw: bytes
    software_version: str
    _software_version_raw: bytes
    hardware_version: str
    _hardware_version_raw: bytes
    serial_number: str
    _serial_number_raw: bytes
    def __init__(self, time_boot_ms: int, capabilities: int, time_manufacture_s: int, vendor_name: bytes,
        model_name: bytes, software_version: bytes, hardware_version: bytes,
        serial_number: bytes) -> None: ...

class MAVLink_component_metadata_message(_dialect.MAVLink_message):  # 397
    time_boot_ms: int  # ms
    file_crc: int
    uri: str
    _uri_raw: bytes
    def __init__(self, time_boot_ms: int, file_crc: int, uri: bytes) -> None: ...

class MAVLink_play_tune_v2_message(_dialect.MAVLink_message):  # 400
    target_system: int
    target_component: int
    format: int  # TUNE_FORMAT
    tune: str
    _tune_raw: bytes
    def __init__(self, target_system: int, target_component: int, format: int, tune: bytes) -> None: ...

class MAVLink_supported_tunes_message(_dialect.MAVLink_message):  # 401
    target_system: int
    target_component: int
    format: int  # TUNE_FORMAT
    def __init__(self, target_system: int, target_component: int, format: int) -> None: ...

class MAVLink_event_message(_dialect.MAVLink_message):  # 410
    destination_component: int
    destination_system: int
    id: int
    event_time_boot_ms: int  # ms
    sequence: int
    log_levels: int
    arguments: list[int]
    def __init__(self, destination_component: int, destination_system: int, id: int, event_time_boot_ms: int,
        sequence: int, log_levels: int, arguments: _Sequence[int]) -> None: ...

class MAVLink_current_event_sequence_message(_dialect.MAVLink_message):  # 411
    sequence: int
    flags: int  # MAV_EVENT_CURRENT_SEQUENCE_FLAGS
    def __init__(self, sequence: int, flags: int) -> None: ...

class MAVLink_request_event_message(_dialect.MAVLink_message):  # 412
    target_system: int
    target_component: int
    first_sequence: int
    last_sequence: int
    def __init__(self, target_system: int, target_component: int, first_sequence: int,
        last_sequence: int) -> None: ...

class MAVLink_response_event_error_message(_dialect.MAVLink_message):  # 413
    target_system: int
    target_component: int
    sequence: int
    sequence_oldest_available: int
    reason: int  # MAV_EVENT_ERROR_REASON
    def __init__(self, target_system: int, target_component: int, sequence: int,
        sequence_oldest_available: int, reason: int) -> None: ...

class MAVLink_group_start_message(_dialect.MAVLink_message):  # 414
    group_id: int
    mission_checksum: int
    time_usec: int  # us
    def __init__(self, group_id: int, mission_checksum: int, time_usec: int) -> None: ...

class MAVLink_group_end_message(_dialect.MAVLink_message):  # 415
    group_id: int
    mission_checksum: int
    time_usec: int  # us
    def __init__(self, group_id: int, mission_checksum: int, time_usec: int) -> None: ...

class MAVLink_rc_channels_override_v2_message(_dialect.MAVLink_message):  # 421
    target_system: int
    target_component: int
    active_mask: int
    channels: list[int]
    def __init__(self, target_system: int, target_component: int, active_mask: int,
        channels: _Sequence[int] = ...) -> None: ...

class MAVLink_illuminator_status_message(_dialect.MAVLink_message):  # 440
    uptime_ms: int  # ms
    enable: int
    mode_bitmask: int  # ILLUMINATOR_MODE
    error_status: int  # ILLUMINATOR_ERROR_FLAGS
    mode: int  # ILLUMINATOR_MODE
    brightness: float  # %
    strobe_period: float  # s
    strobe_duty_cycle: float  # %
    temp_c: float
    min_strobe_period: float  # s
    max_strobe_period: float  # s
    def __init__(self, uptime_ms: int, enable: int, mode_bitmask: int, error_status: int, mode: int,
        brightness: float, strobe_period: float, strobe_duty_cycle: float, temp_c: float,
        min_strobe_period: float, max_strobe_period: float) -> None: ...

class MAVLink_target_absolute_message(_dialect.MAVLink_message):  # 510
    timestamp: int  # us
    id: int
    sensor_capabilities: int  # TARGET_ABSOLUTE_SENSOR_CAPABILITY_FLAGS
    lat: int  # degE7
    lon: int  # degE7
    alt: float  # m
    vel: list[float]  # m/s
    acc: list[float]  # m/s/s
    q_target: list[float]
    rates: list[float]  # rad/s
    position_std: list[float]  # m
    vel_std: list[float]  # m/s
    acc_std: list[float]  # m/s/s
    def __init__(self, timestamp: int, id: int, sensor_capabilities: int, lat: int, lon: int, alt: float,
        vel: _Sequence[float], acc: _Sequence[float], q_target: _Sequence[float], rates: _Sequence[float],
        position_std: _Sequence[float], vel_std: _Sequence[float], acc_std: _Sequence[float]) -> None: ...

class MAVLink_target_relative_message(_dialect.MAVLink_message):  # 511
    timestamp: int  # us
    id: int
    frame: int  # TARGET_OBS_FRAME
    x: float  # m
    y: float  # m
    z: float  # m
    pos_std: list[float]  # m
    yaw_std: float  # rad
    q_target: list[float]
    q_sensor: list[float]
    type: int  # LANDING_TARGET_TYPE
    def __init__(self, timestamp: int, id: int, frame: int, x: float, y: float, z: float,
        pos_std: _Sequence[float], yaw_std: float, q_target: _Sequence[float], q_sensor: _Sequence[float],
        type: int) -> None: ...

class MAVLink_control_status_message(_dialect.MAVLink_message):  # 512
    flags: int  # GCS_CONTROL_STATUS_FLAGS
    gcs_main: int
    gcs_secondary: list[int]
    def __init__(self, flags: int, gcs_main: int, gcs_secondary: _Sequence[int]) -> None: ...

class MAVLink_estimator_sensor_fusion_status_message(_dialect.MAVLink_message):  # 514
    intended: list[int]
    active: list[int]
    test_ratio: list[float]
    def __init__(self, intended: _Sequence[int], active: _Sequence[int],
        test_ratio: _Sequence[float]) -> None: ...

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

class MAVLink_led_strip_config_message(_dialect.MAVLink_message):  # 52600
    target_system: int
    target_component: int
    mode: int  # LED_CONFIG_MODE
    index: int
    length: int
    id: int
    colors: list[int]
    def __init__(self, target_system: int, target_component: int, mode: int, index: int, length: int, id: int,
        colors: _Sequence[int]) -> None: ...

class MAVLink_led_strip_state_message(_dialect.MAVLink_message):  # 52601
    length: int
    index: int
    id: int
    following_flight_mode: int
    colors: list[int]
    def __init__(self, length: int, index: int, id: int, following_flight_mode: int,
        colors: _Sequence[int]) -> None: ...

class _Methods:
    def link_node_status_encode(self, timestamp: int, tx_buf: int, rx_buf: int, tx_rate: int, rx_rate: int,
        rx_parse_err: int, tx_overflows: int, rx_overflows: int, messages_sent: int, messages_received: int,
        messages_lost: int) -> MAVLink_link_node_status_message: ...
    def link_node_status_send(self, timestamp: int, tx_buf: int, rx_buf: int, tx_rate: int, rx_rate: int,
        rx_parse_err: int, tx_overflows: int, rx_overflows: int, messages_sent: int, messages_received: int,
        messages_lost: int, force_mavlink1: bool = False) -> None: ...
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
    def mission_current_encode(self, seq: int, total: int = 0, mission_state: int = 0, mission_mode: int = 0,
        mission_id: int = 0, fence_id: int = 0,
        rally_points_id: int = 0) -> MAVLink_mission_current_message: ...
    def mission_current_send(self, seq: int, total: int = 0, mission_state: int = 0, mission_mode: int = 0,
        mission_id: int = 0, fence_id: int = 0, rally_points_id: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def mission_count_encode(self, target_system: int, target_component: int, count: int,
        mission_type: int = 0, opaque_id: int = 0) -> MAVLink_mission_count_message: ...
    def mission_count_send(self, target_system: int, target_component: int, count: int, mission_type: int = 0,
        opaque_id: int = 0, force_mavlink1: bool = False) -> None: ...
    def mission_ack_encode(self, target_system: int, target_component: int, type: int, mission_type: int = 0,
        opaque_id: int = 0) -> MAVLink_mission_ack_message: ...
    def mission_ack_send(self, target_system: int, target_component: int, type: int, mission_type: int = 0,
        opaque_id: int = 0, force_mavlink1: bool = False) -> None: ...
    def command_ack_encode(self, command: int, result: int, progress: int = 0, result_param2: int = 0,
        target_system: int = 0, target_component: int = 0) -> MAVLink_command_ack_message: ...
    def command_ack_send(self, command: int, result: int, progress: int = 0, result_param2: int = 0,
        target_system: int = 0, target_component: int = 0, force_mavlink1: bool = False) -> None: ...
    def command_cancel_encode(self, target_system: int, target_component: int,
        command: int) -> MAVLink_command_cancel_message: ...
    def command_cancel_send(self, target_system: int, target_component: int, command: int,
        force_mavlink1: bool = False) -> None: ...
    def set_attitude_target_encode(self, time_boot_ms: int, target_system: int, target_component: int,
        type_mask: int, q: _Sequence[float], body_roll_rate: float, body_pitch_rate: float,
        body_yaw_rate: float, thrust: float,
        thrust_body: _Sequence[float] = ...) -> MAVLink_set_attitude_target_message: ...
    def set_attitude_target_send(self, time_boot_ms: int, target_system: int, target_component: int,
        type_mask: int, q: _Sequence[float], body_roll_rate: float, body_pitch_rate: float,
        body_yaw_rate: float, thrust: float, thrust_body: _Sequence[float] = ...,
        force_mavlink1: bool = False) -> None: ...
    def optical_flow_encode(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int,
        flow_comp_m_x: float, flow_comp_m_y: float, quality: int, ground_distance: float,
        flow_rate_x: float = 0, flow_rate_y: float = 0) -> MAVLink_optical_flow_message: ...
    def optical_flow_send(self, time_usec: int, sensor_id: int, flow_x: int, flow_y: int,
        flow_comp_m_x: float, flow_comp_m_y: float, quality: int, ground_distance: float,
        flow_rate_x: float = 0, flow_rate_y: float = 0, force_mavlink1: bool = False) -> None: ...
    def timesync_encode(self, tc1: int, ts1: int, target_system: int = 0,
        target_component: int = 0) -> MAVLink_timesync_message: ...
    def timesync_send(self, tc1: int, ts1: int, target_system: int = 0, target_component: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def serial_control_encode(self, device: int, flags: int, timeout: int, baudrate: int, count: int,
        data: _Sequence[int], target_system: int = 0,
        target_component: int = 0) -> MAVLink_serial_control_message: ...
    def serial_control_send(self, device: int, flags: int, timeout: int, baudrate: int, count: int,
        data: _Sequence[int], target_system: int = 0, target_component: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def gps_input_encode(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int,
        time_week: int, fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float,
        ve: float, vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int, yaw: int = 0) -> MAVLink_gps_input_message: ...
    def gps_input_send(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int,
        time_week: int, fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float,
        ve: float, vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int, yaw: int = 0, force_mavlink1: bool = False) -> None: ...
    def esc_info_encode(self, index: int, time_usec: int, counter: int, count: int, connection_type: int,
        info: int, failure_flags: _Sequence[int], error_count: _Sequence[int],
        temperature: _Sequence[int]) -> MAVLink_esc_info_message: ...
    def esc_info_send(self, index: int, time_usec: int, counter: int, count: int, connection_type: int,
        info: int, failure_flags: _Sequence[int], error_count: _Sequence[int], temperature: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def esc_status_encode(self, index: int, time_usec: int, rpm: _Sequence[int], voltage: _Sequence[float],
        current: _Sequence[float]) -> MAVLink_esc_status_message: ...
    def esc_status_send(self, index: int, time_usec: int, rpm: _Sequence[int], voltage: _Sequence[float],
        current: _Sequence[float], force_mavlink1: bool = False) -> None: ...
    def esc_eeprom_encode(self, target_system: int, target_component: int, firmware: int, msg_index: int,
        msg_count: int, esc_index: int, write_mask: _Sequence[int], length: int,
        data: _Sequence[int]) -> MAVLink_esc_eeprom_message: ...
    def esc_eeprom_send(self, target_system: int, target_component: int, firmware: int, msg_index: int,
        msg_count: int, esc_index: int, write_mask: _Sequence[int], length: int, data: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def wifi_config_ap_encode(self, ssid: bytes, password: bytes, mode: int = 0,
        response: int = 0) -> MAVLink_wifi_config_ap_message: ...
    def wifi_config_ap_send(self, ssid: bytes, password: bytes, mode: int = 0, response: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def protocol_version_encode(self, version: int, min_version: int, max_version: int,
        spec_version_hash: _Sequence[int],
        library_version_hash: _Sequence[int]) -> MAVLink_protocol_version_message: ...
    def protocol_version_send(self, version: int, min_version: int, max_version: int,
        spec_version_hash: _Sequence[int], library_version_hash: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def cellular_status_encode(self, status: int, failure_reason: int, type: int, quality: int, mcc: int,
        mnc: int, lac: int, id: int = 0, link_tx_rate: int = 0, link_rx_rate: int = 0,
        cell_tower_id: bytes = b"", band_number: int = 0, band_frequency: float = 0, channel_number: int = 0,
        rx_level: float = 0, tx_level: float = 0, rx_quality: float = 0,
        sinr: float = 0) -> MAVLink_cellular_status_message: ...
    def cellular_status_send(self, status: int, failure_reason: int, type: int, quality: int, mcc: int,
        mnc: int, lac: int, id: int = 0, link_tx_rate: int = 0, link_rx_rate: int = 0,
        cell_tower_id: bytes = b"", band_number: int = 0, band_frequency: float = 0, channel_number: int = 0,
        rx_level: float = 0, tx_level: float = 0, rx_quality: float = 0, sinr: float = 0,
        force_mavlink1: bool = False) -> None: ...
    def cellular_config_encode(self, enable_lte: int, enable_pin: int, pin: bytes, new_pin: bytes, apn: bytes,
        puk: bytes, roaming: int, response: int) -> MAVLink_cellular_config_message: ...
    def cellular_config_send(self, enable_lte: int, enable_pin: int, pin: bytes, new_pin: bytes, apn: bytes,
        puk: bytes, roaming: int, response: int, force_mavlink1: bool = False) -> None: ...
    def set_velocity_limits_encode(self, target_system: int, target_component: int,
        horizontal_speed_limit: float, vertical_speed_limit: float,
        yaw_rate_limit: float) -> MAVLink_set_velocity_limits_message: ...
    def set_velocity_limits_send(self, target_system: int, target_component: int,
        horizontal_speed_limit: float, vertical_speed_limit: float, yaw_rate_limit: float,
        force_mavlink1: bool = False) -> None: ...
    def velocity_limits_encode(self, horizontal_speed_limit: float, vertical_speed_limit: float,
        yaw_rate_limit: float) -> MAVLink_velocity_limits_message: ...
    def velocity_limits_send(self, horizontal_speed_limit: float, vertical_speed_limit: float,
        yaw_rate_limit: float, force_mavlink1: bool = False) -> None: ...
    def figure_eight_execution_status_encode(self, time_usec: int, major_radius: float, minor_radius: float,
        orientation: float, frame: int, x: int, y: int,
        z: float) -> MAVLink_figure_eight_execution_status_message: ...
    def figure_eight_execution_status_send(self, time_usec: int, major_radius: float, minor_radius: float,
        orientation: float, frame: int, x: int, y: int, z: float, force_mavlink1: bool = False) -> None: ...
    def battery_status_v2_encode(self, id: int, temperature: int, voltage: float, current: float,
        capacity_consumed: float, capacity_remaining: float, state_of_charge: float,
        status_flags: int) -> MAVLink_battery_status_v2_message: ...
    def battery_status_v2_send(self, id: int, temperature: int, voltage: float, current: float,
        capacity_consumed: float, capacity_remaining: float, state_of_charge: float, status_flags: int,
        force_mavlink1: bool = False) -> None: ...
    def fuel_status_encode(self, id: int, maximum_fuel: float, consumed_fuel: float, remaining_fuel: float,
        percent_remaining: int, flow_rate: float, temperature: float,
        fuel_type: int) -> MAVLink_fuel_status_message: ...
    def fuel_status_send(self, id: int, maximum_fuel: float, consumed_fuel: float, remaining_fuel: float,
        percent_remaining: int, flow_rate: float, temperature: float, fuel_type: int,
        force_mavlink1: bool = False) -> None: ...
    def battery_info_encode(self, id: int, battery_function: int, type: int, state_of_health: int,
        cells_in_series: int, cycle_count: int, weight: int, discharge_minimum_voltage: float,
        charging_minimum_voltage: float, resting_minimum_voltage: float, charging_maximum_voltage: float,
        charging_maximum_current: float, nominal_voltage: float, discharge_maximum_current: float,
        discharge_maximum_burst_current: float, design_capacity: float, full_charge_capacity: float,
        manufacture_date: bytes, serial_number: bytes, name: bytes) -> MAVLink_battery_info_message: ...
    def battery_info_send(self, id: int, battery_function: int, type: int, state_of_health: int,
        cells_in_series: int, cycle_count: int, weight: int, discharge_minimum_voltage: float,
        charging_minimum_voltage: float, resting_minimum_voltage: float, charging_maximum_voltage: float,
        charging_maximum_current: float, nominal_voltage: float, discharge_maximum_current: float,
        discharge_maximum_burst_current: float, design_capacity: float, full_charge_capacity: float,
        manufacture_date: bytes, serial_number: bytes, name: bytes, force_mavlink1: bool = False) -> None: ...
    def time_estimate_to_target_encode(self, safe_return: int, land: int, mission_next_item: int,
        mission_end: int, commanded_action: int) -> MAVLink_time_estimate_to_target_message: ...
    def time_estimate_to_target_send(self, safe_return: int, land: int, mission_next_item: int,
        mission_end: int, commanded_action: int, force_mavlink1: bool = False) -> None: ...
    def component_information_encode(self, time_boot_ms: int, general_metadata_file_crc: int,
        general_metadata_uri: bytes, peripherals_metadata_file_crc: int,
        peripherals_metadata_uri: bytes) -> MAVLink_component_information_message: ...
    def component_information_send(self, time_boot_ms: int, general_metadata_file_crc: int,
        general_metadata_uri: bytes, peripherals_metadata_file_crc: int, peripherals_metadata_uri: bytes,
        force_mavlink1: bool = False) -> None: ...
    def component_information_basic_encode(self, time_boot_ms: int, capabilities: int,
        time_manufacture_s: int, vendor_name: bytes, model_name: bytes, software_version: bytes,
        hardware_version: bytes, serial_number: bytes) -> MAVLink_component_information_basic_message: ...
    def component_information_basic_send(self, time_boot_ms: int, capabilities: int, time_manufacture_s: int,
        vendor_name: bytes, model_name: bytes, software_version: bytes, hardware_version: bytes,
        serial_number: bytes, force_mavlink1: bool = False) -> None: ...
    def component_metadata_encode(self, time_boot_ms: int, file_crc: int,
        uri: bytes) -> MAVLink_component_metadata_message: ...
    def component_metadata_send(self, time_boot_ms: int, file_crc: int, uri: bytes,
        force_mavlink1: bool = False) -> None: ...
    def play_tune_v2_encode(self, target_system: int, target_component: int, format: int,
        tune: bytes) -> MAVLink_play_tune_v2_message: ...
    def play_tune_v2_send(self, target_system: int, target_component: int, format: int, tune: bytes,
        force_mavlink1: bool = False) -> None: ...
    def supported_tunes_encode(self, target_system: int, target_component: int,
        format: int) -> MAVLink_supported_tunes_message: ...
    def supported_tunes_send(self, target_system: int, target_component: int, format: int,
        force_mavlink1: bool = False) -> None: ...
    def event_encode(self, destination_component: int, destination_system: int, id: int,
        event_time_boot_ms: int, sequence: int, log_levels: int,
        arguments: _Sequence[int]) -> MAVLink_event_message: ...
    def event_send(self, destination_component: int, destination_system: int, id: int,
        event_time_boot_ms: int, sequence: int, log_levels: int, arguments: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def current_event_sequence_encode(self, sequence: int,
        flags: int) -> MAVLink_current_event_sequence_message: ...
    def current_event_sequence_send(self, sequence: int, flags: int,
        force_mavlink1: bool = False) -> None: ...
    def request_event_encode(self, target_system: int, target_component: int, first_sequence: int,
        last_sequence: int) -> MAVLink_request_event_message: ...
    def request_event_send(self, target_system: int, target_component: int, first_sequence: int,
        last_sequence: int, force_mavlink1: bool = False) -> None: ...
    def response_event_error_encode(self, target_system: int, target_component: int, sequence: int,
        sequence_oldest_available: int, reason: int) -> MAVLink_response_event_error_message: ...
    def response_event_error_send(self, target_system: int, target_component: int, sequence: int,
        sequence_oldest_available: int, reason: int, force_mavlink1: bool = False) -> None: ...
    def group_start_encode(self, group_id: int, mission_checksum: int,
        time_usec: int) -> MAVLink_group_start_message: ...
    def group_start_send(self, group_id: int, mission_checksum: int, time_usec: int,
        force_mavlink1: bool = False) -> None: ...
    def group_end_encode(self, group_id: int, mission_checksum: int,
        time_usec: int) -> MAVLink_group_end_message: ...
    def group_end_send(self, group_id: int, mission_checksum: int, time_usec: int,
        force_mavlink1: bool = False) -> None: ...
    def rc_channels_override_v2_encode(self, target_system: int, target_component: int, active_mask: int,
        channels: _Sequence[int] = ...) -> MAVLink_rc_channels_override_v2_message: ...
    def rc_channels_override_v2_send(self, target_system: int, target_component: int, active_mask: int,
        channels: _Sequence[int] = ..., force_mavlink1: bool = False) -> None: ...
    def illuminator_status_encode(self, uptime_ms: int, enable: int, mode_bitmask: int, error_status: int,
        mode: int, brightness: float, strobe_period: float, strobe_duty_cycle: float, temp_c: float,
        min_strobe_period: float, max_strobe_period: float) -> MAVLink_illuminator_status_message: ...
    def illuminator_status_send(self, uptime_ms: int, enable: int, mode_bitmask: int, error_status: int,
        mode: int, brightness: float, strobe_period: float, strobe_duty_cycle: float, temp_c: float,
        min_strobe_period: float, max_strobe_period: float, force_mavlink1: bool = False) -> None: ...
    def target_absolute_encode(self, timestamp: int, id: int, sensor_capabilities: int, lat: int, lon: int,
        alt: float, vel: _Sequence[float], acc: _Sequence[float], q_target: _Sequence[float],
        rates: _Sequence[float], position_std: _Sequence[float], vel_std: _Sequence[float],
        acc_std: _Sequence[float]) -> MAVLink_target_absolute_message: ...
    def target_absolute_send(self, timestamp: int, id: int, sensor_capabilities: int, lat: int, lon: int,
        alt: float, vel: _Sequence[float], acc: _Sequence[float], q_target: _Sequence[float],
        rates: _Sequence[float], position_std: _Sequence[float], vel_std: _Sequence[float],
        acc_std: _Sequence[float], force_mavlink1: bool = False) -> None: ...
    def target_relative_encode(self, timestamp: int, id: int, frame: int, x: float, y: float, z: float,
        pos_std: _Sequence[float], yaw_std: float, q_target: _Sequence[float], q_sensor: _Sequence[float],
        type: int) -> MAVLink_target_relative_message: ...
    def target_relative_send(self, timestamp: int, id: int, frame: int, x: float, y: float, z: float,
        pos_std: _Sequence[float], yaw_std: float, q_target: _Sequence[float], q_sensor: _Sequence[float],
        type: int, force_mavlink1: bool = False) -> None: ...
    def control_status_encode(self, flags: int, gcs_main: int,
        gcs_secondary: _Sequence[int]) -> MAVLink_control_status_message: ...
    def control_status_send(self, flags: int, gcs_main: int, gcs_secondary: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def estimator_sensor_fusion_status_encode(self, intended: _Sequence[int], active: _Sequence[int],
        test_ratio: _Sequence[float]) -> MAVLink_estimator_sensor_fusion_status_message: ...
    def estimator_sensor_fusion_status_send(self, intended: _Sequence[int], active: _Sequence[int],
        test_ratio: _Sequence[float], force_mavlink1: bool = False) -> None: ...
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
    def led_strip_config_encode(self, target_system: int, target_component: int, mode: int, index: int,
        length: int, id: int, colors: _Sequence[int]) -> MAVLink_led_strip_config_message: ...
    def led_strip_config_send(self, target_system: int, target_component: int, mode: int, index: int,
        length: int, id: int, colors: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def led_strip_state_encode(self, length: int, index: int, id: int, following_flight_mode: int,
        colors: _Sequence[int]) -> MAVLink_led_strip_state_message: ...
    def led_strip_state_send(self, length: int, index: int, id: int, following_flight_mode: int,
        colors: _Sequence[int], force_mavlink1: bool = False) -> None: ...
