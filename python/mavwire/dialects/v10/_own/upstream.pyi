"""What dialect upstream itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_LINK_NODE_STATUS: int = 8
MAVLINK_MSG_ID_COMMAND_CANCEL: int = 80
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
    def __init__(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int, zgyro: int,
        xmag: int, ymag: int, zmag: int) -> None: ...

class MAVLink_command_cancel_message(_dialect.MAVLink_message):  # 80
    target_system: int
    target_component: int
    command: int  # MAV_CMD
    def __init__(self, target_system: int, target_component: int, command: int) -> None: ...

class MAVLink_optical_flow_message(_dialect.MAVLink_message):  # 100
    time_usec: int  # us
    sensor_id: int
    flow_x: int  # dpix
    flow_y: int  # dpix
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
    def __init__(self, time_usec: int, gps_id: int, ignore_flags: int, time_week_ms: int, time_week: int,
        fix_type: int, lat: int, lon: int, alt: float, hdop: float, vdop: float, vn: float, ve: float,
        vd: float, speed_accuracy: float, horiz_accuracy: float, vert_accuracy: float,
        satellites_visible: int) -> None: ...

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
        zgyro: int, xmag: int, ymag: int, zmag: int) -> MAVLink_raw_imu_message: ...
    def raw_imu_send(self, time_usec: int, xacc: int, yacc: int, zacc: int, xgyro: int, ygyro: int,
        zgyro: int, xmag: int, ymag: int, zmag: int, force_mavlink1: bool = False) -> None: ...
    def command_cancel_encode(self, target_system: int, target_component: int,
        command: int) -> MAVLink_command_cancel_message: ...
    def command_cancel_send(self, target_system: int, target_component: int, command: int,
        force_mavlink1: bool = False) -> None: ...
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
