"""What dialect ardupilotmega itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_SENSOR_OFFSETS: int = 150
MAVLINK_MSG_ID_SET_MAG_OFFSETS: int = 151
MAVLINK_MSG_ID_MEMINFO: int = 152
MAVLINK_MSG_ID_AP_ADC: int = 153
MAVLINK_MSG_ID_DIGICAM_CONFIGURE: int = 154
MAVLINK_MSG_ID_DIGICAM_CONTROL: int = 155
MAVLINK_MSG_ID_MOUNT_CONFIGURE: int = 156
MAVLINK_MSG_ID_MOUNT_CONTROL: int = 157
MAVLINK_MSG_ID_MOUNT_STATUS: int = 158
MAVLINK_MSG_ID_FENCE_POINT: int = 160
MAVLINK_MSG_ID_FENCE_FETCH_POINT: int = 161
MAVLINK_MSG_ID_AHRS: int = 163
MAVLINK_MSG_ID_SIMSTATE: int = 164
MAVLINK_MSG_ID_HWSTATUS: int = 165
MAVLINK_MSG_ID_RADIO: int = 166
MAVLINK_MSG_ID_LIMITS_STATUS: int = 167
MAVLINK_MSG_ID_WIND: int = 168
MAVLINK_MSG_ID_DATA16: int = 169
MAVLINK_MSG_ID_DATA32: int = 170
MAVLINK_MSG_ID_DATA64: int = 171
MAVLINK_MSG_ID_DATA96: int = 172
MAVLINK_MSG_ID_RANGEFINDER: int = 173
MAVLINK_MSG_ID_AIRSPEED_AUTOCAL: int = 174
MAVLINK_MSG_ID_RALLY_POINT: int = 175
MAVLINK_MSG_ID_RALLY_FETCH_POINT: int = 176
MAVLINK_MSG_ID_COMPASSMOT_STATUS: int = 177
MAVLINK_MSG_ID_AHRS2: int = 178
MAVLINK_MSG_ID_CAMERA_STATUS: int = 179
MAVLINK_MSG_ID_CAMERA_FEEDBACK: int = 180
MAVLINK_MSG_ID_BATTERY2: int = 181
MAVLINK_MSG_ID_AHRS3: int = 182
MAVLINK_MSG_ID_AUTOPILOT_VERSION_REQUEST: int = 183
MAVLINK_MSG_ID_REMOTE_LOG_DATA_BLOCK: int = 184
MAVLINK_MSG_ID_REMOTE_LOG_BLOCK_STATUS: int = 185
MAVLINK_MSG_ID_LED_CONTROL: int = 186
MAVLINK_MSG_ID_MAG_CAL_PROGRESS: int = 191
MAVLINK_MSG_ID_EKF_STATUS_REPORT: int = 193
MAVLINK_MSG_ID_PID_TUNING: int = 194
MAVLINK_MSG_ID_DEEPSTALL: int = 195
MAVLINK_MSG_ID_GIMBAL_REPORT: int = 200
MAVLINK_MSG_ID_GIMBAL_CONTROL: int = 201
MAVLINK_MSG_ID_GIMBAL_TORQUE_CMD_REPORT: int = 214
MAVLINK_MSG_ID_GOPRO_HEARTBEAT: int = 215
MAVLINK_MSG_ID_GOPRO_GET_REQUEST: int = 216
MAVLINK_MSG_ID_GOPRO_GET_RESPONSE: int = 217
MAVLINK_MSG_ID_GOPRO_SET_REQUEST: int = 218
MAVLINK_MSG_ID_GOPRO_SET_RESPONSE: int = 219
MAVLINK_MSG_ID_RPM: int = 226
MAVLINK_MSG_ID_DEVICE_OP_READ: int = 11000
MAVLINK_MSG_ID_DEVICE_OP_READ_REPLY: int = 11001
MAVLINK_MSG_ID_DEVICE_OP_WRITE: int = 11002
MAVLINK_MSG_ID_DEVICE_OP_WRITE_REPLY: int = 11003
MAVLINK_MSG_ID_SECURE_COMMAND: int = 11004
MAVLINK_MSG_ID_SECURE_COMMAND_REPLY: int = 11005
MAVLINK_MSG_ID_ADAP_TUNING: int = 11010
MAVLINK_MSG_ID_VISION_POSITION_DELTA: int = 11011
MAVLINK_MSG_ID_AOA_SSA: int = 11020
MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4: int = 11030
MAVLINK_MSG_ID_ESC_TELEMETRY_5_TO_8: int = 11031
MAVLINK_MSG_ID_ESC_TELEMETRY_9_TO_12: int = 11032
MAVLINK_MSG_ID_OSD_PARAM_CONFIG: int = 11033
MAVLINK_MSG_ID_OSD_PARAM_CONFIG_REPLY: int = 11034
MAVLINK_MSG_ID_OSD_PARAM_SHOW_CONFIG: int = 11035
MAVLINK_MSG_ID_OSD_PARAM_SHOW_CONFIG_REPLY: int = 11036
MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D: int = 11037
MAVLINK_MSG_ID_WATER_DEPTH: int = 11038
MAVLINK_MSG_ID_MCU_STATUS: int = 11039
MAVLINK_MSG_ID_ESC_TELEMETRY_13_TO_16: int = 11040
MAVLINK_MSG_ID_ESC_TELEMETRY_17_TO_20: int = 11041
MAVLINK_MSG_ID_ESC_TELEMETRY_21_TO_24: int = 11042
MAVLINK_MSG_ID_ESC_TELEMETRY_25_TO_28: int = 11043
MAVLINK_MSG_ID_ESC_TELEMETRY_29_TO_32: int = 11044
MAVLINK_MSG_ID_NAMED_VALUE_STRING: int = 11060
ACCELCAL_VEHICLE_POS_LEVEL: int = 1
ACCELCAL_VEHICLE_POS_LEFT: int = 2
ACCELCAL_VEHICLE_POS_RIGHT: int = 3
ACCELCAL_VEHICLE_POS_NOSEDOWN: int = 4
ACCELCAL_VEHICLE_POS_NOSEUP: int = 5
ACCELCAL_VEHICLE_POS_BACK: int = 6
ACCELCAL_VEHICLE_POS_SUCCESS: int = 16777215
ACCELCAL_VEHICLE_POS_FAILED: int = 16777216
ACCELCAL_VEHICLE_POS_ENUM_END: int
MAV_CMD_NAV_ALTITUDE_WAIT: int = 83
MAV_CMD_DO_SET_RESUME_REPEAT_DIST: int = 215
MAV_CMD_DO_SPRAYER: int = 216
MAV_CMD_DO_SEND_SCRIPT_MESSAGE: int = 217
MAV_CMD_DO_AUX_FUNCTION: int = 218
MAV_CMD_POWER_OFF_INITIATED: int = 42000
MAV_CMD_SOLO_BTN_FLY_CLICK: int = 42001
MAV_CMD_SOLO_BTN_FLY_HOLD: int = 42002
MAV_CMD_SOLO_BTN_PAUSE_CLICK: int = 42003
MAV_CMD_FIXED_MAG_CAL: int = 42004
MAV_CMD_FIXED_MAG_CAL_FIELD: int = 42005
MAV_CMD_SET_EKF_SOURCE_SET: int = 42007
MAV_CMD_DO_START_MAG_CAL: int = 42424
MAV_CMD_DO_ACCEPT_MAG_CAL: int = 42425
MAV_CMD_DO_CANCEL_MAG_CAL: int = 42426
MAV_CMD_SET_FACTORY_TEST_MODE: int = 42427
MAV_CMD_DO_SEND_BANNER: int = 42428
MAV_CMD_ACCELCAL_VEHICLE_POS: int = 42429
MAV_CMD_GIMBAL_RESET: int = 42501
MAV_CMD_GIMBAL_AXIS_CALIBRATION_STATUS: int = 42502
MAV_CMD_GIMBAL_REQUEST_AXIS_CALIBRATION: int = 42503
MAV_CMD_GIMBAL_FULL_RESET: int = 42505
MAV_CMD_FLASH_BOOTLOADER: int = 42650
MAV_CMD_BATTERY_RESET: int = 42651
MAV_CMD_DEBUG_TRAP: int = 42700
MAV_CMD_SCRIPTING: int = 42701
MAV_CMD_NAV_SCRIPT_TIME: int = 42702
MAV_CMD_NAV_ATTITUDE_TIME: int = 42703
MAV_CMD_SET_HAGL: int = 43005
SCRIPTING_CMD_REPL_START: int = 0
SCRIPTING_CMD_REPL_STOP: int = 1
SCRIPTING_CMD_STOP: int = 2
SCRIPTING_CMD_STOP_AND_RESTART: int = 3
SCRIPTING_CMD_ENUM_END: int
SECURE_COMMAND_GET_SESSION_KEY: int = 0
SECURE_COMMAND_GET_REMOTEID_SESSION_KEY: int = 1
SECURE_COMMAND_REMOVE_PUBLIC_KEYS: int = 2
SECURE_COMMAND_GET_PUBLIC_KEYS: int = 3
SECURE_COMMAND_SET_PUBLIC_KEYS: int = 4
SECURE_COMMAND_GET_REMOTEID_CONFIG: int = 5
SECURE_COMMAND_SET_REMOTEID_CONFIG: int = 6
SECURE_COMMAND_FLASH_BOOTLOADER: int = 7
SECURE_COMMAND_OP_ENUM_END: int
LIMITS_INIT: int = 0
LIMITS_DISABLED: int = 1
LIMITS_ENABLED: int = 2
LIMITS_TRIGGERED: int = 3
LIMITS_RECOVERING: int = 4
LIMITS_RECOVERED: int = 5
LIMITS_STATE_ENUM_END: int
LIMIT_GPSLOCK: int = 1
LIMIT_GEOFENCE: int = 2
LIMIT_ALTITUDE: int = 4
LIMIT_MODULE_ENUM_END: int
FAVORABLE_WIND: int = 1
LAND_IMMEDIATELY: int = 2
ALT_FRAME_VALID: int = 4
ALT_FRAME: int = 24
RALLY_FLAGS_ENUM_END: int
CAMERA_STATUS_TYPE_HEARTBEAT: int = 0
CAMERA_STATUS_TYPE_TRIGGER: int = 1
CAMERA_STATUS_TYPE_DISCONNECT: int = 2
CAMERA_STATUS_TYPE_ERROR: int = 3
CAMERA_STATUS_TYPE_LOWBATT: int = 4
CAMERA_STATUS_TYPE_LOWSTORE: int = 5
CAMERA_STATUS_TYPE_LOWSTOREV: int = 6
CAMERA_STATUS_TYPES_ENUM_END: int
CAMERA_FEEDBACK_PHOTO: int = 0
CAMERA_FEEDBACK_VIDEO: int = 1
CAMERA_FEEDBACK_BADEXPOSURE: int = 2
CAMERA_FEEDBACK_CLOSEDLOOP: int = 3
CAMERA_FEEDBACK_OPENLOOP: int = 4
CAMERA_FEEDBACK_FLAGS_ENUM_END: int
MAV_MODE_GIMBAL_UNINITIALIZED: int = 0
MAV_MODE_GIMBAL_CALIBRATING_PITCH: int = 1
MAV_MODE_GIMBAL_CALIBRATING_ROLL: int = 2
MAV_MODE_GIMBAL_CALIBRATING_YAW: int = 3
MAV_MODE_GIMBAL_INITIALIZED: int = 4
MAV_MODE_GIMBAL_ACTIVE: int = 5
MAV_MODE_GIMBAL_RATE_CMD_TIMEOUT: int = 6
MAV_MODE_GIMBAL_ENUM_END: int
GIMBAL_AXIS_YAW: int = 0
GIMBAL_AXIS_PITCH: int = 1
GIMBAL_AXIS_ROLL: int = 2
GIMBAL_AXIS_ENUM_END: int
GIMBAL_AXIS_CALIBRATION_STATUS_IN_PROGRESS: int = 0
GIMBAL_AXIS_CALIBRATION_STATUS_SUCCEEDED: int = 1
GIMBAL_AXIS_CALIBRATION_STATUS_FAILED: int = 2
GIMBAL_AXIS_CALIBRATION_STATUS_ENUM_END: int
GIMBAL_AXIS_CALIBRATION_REQUIRED_UNKNOWN: int = 0
GIMBAL_AXIS_CALIBRATION_REQUIRED_TRUE: int = 1
GIMBAL_AXIS_CALIBRATION_REQUIRED_FALSE: int = 2
GIMBAL_AXIS_CALIBRATION_REQUIRED_ENUM_END: int
GOPRO_HEARTBEAT_STATUS_DISCONNECTED: int = 0
GOPRO_HEARTBEAT_STATUS_INCOMPATIBLE: int = 1
GOPRO_HEARTBEAT_STATUS_CONNECTED: int = 2
GOPRO_HEARTBEAT_STATUS_ERROR: int = 3
GOPRO_HEARTBEAT_STATUS_ENUM_END: int
GOPRO_FLAG_RECORDING: int = 1
GOPRO_HEARTBEAT_FLAGS_ENUM_END: int
GOPRO_REQUEST_SUCCESS: int = 0
GOPRO_REQUEST_FAILED: int = 1
GOPRO_REQUEST_STATUS_ENUM_END: int
GOPRO_COMMAND_POWER: int = 0
GOPRO_COMMAND_CAPTURE_MODE: int = 1
GOPRO_COMMAND_SHUTTER: int = 2
GOPRO_COMMAND_BATTERY: int = 3
GOPRO_COMMAND_MODEL: int = 4
GOPRO_COMMAND_VIDEO_SETTINGS: int = 5
GOPRO_COMMAND_LOW_LIGHT: int = 6
GOPRO_COMMAND_PHOTO_RESOLUTION: int = 7
GOPRO_COMMAND_PHOTO_BURST_RATE: int = 8
GOPRO_COMMAND_PROTUNE: int = 9
GOPRO_COMMAND_PROTUNE_WHITE_BALANCE: int = 10
GOPRO_COMMAND_PROTUNE_COLOUR: int = 11
GOPRO_COMMAND_PROTUNE_GAIN: int = 12
GOPRO_COMMAND_PROTUNE_SHARPNESS: int = 13
GOPRO_COMMAND_PROTUNE_EXPOSURE: int = 14
GOPRO_COMMAND_TIME: int = 15
GOPRO_COMMAND_CHARGING: int = 16
GOPRO_COMMAND_ENUM_END: int
GOPRO_CAPTURE_MODE_VIDEO: int = 0
GOPRO_CAPTURE_MODE_PHOTO: int = 1
GOPRO_CAPTURE_MODE_BURST: int = 2
GOPRO_CAPTURE_MODE_TIME_LAPSE: int = 3
GOPRO_CAPTURE_MODE_MULTI_SHOT: int = 4
GOPRO_CAPTURE_MODE_PLAYBACK: int = 5
GOPRO_CAPTURE_MODE_SETUP: int = 6
GOPRO_CAPTURE_MODE_UNKNOWN: int = 255
GOPRO_CAPTURE_MODE_ENUM_END: int
GOPRO_RESOLUTION_480p: int = 0
GOPRO_RESOLUTION_720p: int = 1
GOPRO_RESOLUTION_960p: int = 2
GOPRO_RESOLUTION_1080p: int = 3
GOPRO_RESOLUTION_1440p: int = 4
GOPRO_RESOLUTION_2_7k_17_9: int = 5
GOPRO_RESOLUTION_2_7k_16_9: int = 6
GOPRO_RESOLUTION_2_7k_4_3: int = 7
GOPRO_RESOLUTION_4k_16_9: int = 8
GOPRO_RESOLUTION_4k_17_9: int = 9
GOPRO_RESOLUTION_720p_SUPERVIEW: int = 10
GOPRO_RESOLUTION_1080p_SUPERVIEW: int = 11
GOPRO_RESOLUTION_2_7k_SUPERVIEW: int = 12
GOPRO_RESOLUTION_4k_SUPERVIEW: int = 13
GOPRO_RESOLUTION_ENUM_END: int
GOPRO_FRAME_RATE_12: int = 0
GOPRO_FRAME_RATE_15: int = 1
GOPRO_FRAME_RATE_24: int = 2
GOPRO_FRAME_RATE_25: int = 3
GOPRO_FRAME_RATE_30: int = 4
GOPRO_FRAME_RATE_48: int = 5
GOPRO_FRAME_RATE_50: int = 6
GOPRO_FRAME_RATE_60: int = 7
GOPRO_FRAME_RATE_80: int = 8
GOPRO_FRAME_RATE_90: int = 9
GOPRO_FRAME_RATE_100: int = 10
GOPRO_FRAME_RATE_120: int = 11
GOPRO_FRAME_RATE_240: int = 12
GOPRO_FRAME_RATE_12_5: int = 13
GOPRO_FRAME_RATE_ENUM_END: int
GOPRO_FIELD_OF_VIEW_WIDE: int = 0
GOPRO_FIELD_OF_VIEW_MEDIUM: int = 1
GOPRO_FIELD_OF_VIEW_NARROW: int = 2
GOPRO_FIELD_OF_VIEW_ENUM_END: int
GOPRO_VIDEO_SETTINGS_TV_MODE: int = 1
GOPRO_VIDEO_SETTINGS_FLAGS_ENUM_END: int
GOPRO_PHOTO_RESOLUTION_5MP_MEDIUM: int = 0
GOPRO_PHOTO_RESOLUTION_7MP_MEDIUM: int = 1
GOPRO_PHOTO_RESOLUTION_7MP_WIDE: int = 2
GOPRO_PHOTO_RESOLUTION_10MP_WIDE: int = 3
GOPRO_PHOTO_RESOLUTION_12MP_WIDE: int = 4
GOPRO_PHOTO_RESOLUTION_ENUM_END: int
GOPRO_PROTUNE_WHITE_BALANCE_AUTO: int = 0
GOPRO_PROTUNE_WHITE_BALANCE_3000K: int = 1
GOPRO_PROTUNE_WHITE_BALANCE_5500K: int = 2
GOPRO_PROTUNE_WHITE_BALANCE_6500K: int = 3
GOPRO_PROTUNE_WHITE_BALANCE_RAW: int = 4
GOPRO_PROTUNE_WHITE_BALANCE_ENUM_END: int
GOPRO_PROTUNE_COLOUR_STANDARD: int = 0
GOPRO_PROTUNE_COLOUR_NEUTRAL: int = 1
GOPRO_PROTUNE_COLOUR_ENUM_END: int
GOPRO_PROTUNE_GAIN_400: int = 0
GOPRO_PROTUNE_GAIN_800: int = 1
GOPRO_PROTUNE_GAIN_1600: int = 2
GOPRO_PROTUNE_GAIN_3200: int = 3
GOPRO_PROTUNE_GAIN_6400: int = 4
GOPRO_PROTUNE_GAIN_ENUM_END: int
GOPRO_PROTUNE_SHARPNESS_LOW: int = 0
GOPRO_PROTUNE_SHARPNESS_MEDIUM: int = 1
GOPRO_PROTUNE_SHARPNESS_HIGH: int = 2
GOPRO_PROTUNE_SHARPNESS_ENUM_END: int
GOPRO_PROTUNE_EXPOSURE_NEG_5_0: int = 0
GOPRO_PROTUNE_EXPOSURE_NEG_4_5: int = 1
GOPRO_PROTUNE_EXPOSURE_NEG_4_0: int = 2
GOPRO_PROTUNE_EXPOSURE_NEG_3_5: int = 3
GOPRO_PROTUNE_EXPOSURE_NEG_3_0: int = 4
GOPRO_PROTUNE_EXPOSURE_NEG_2_5: int = 5
GOPRO_PROTUNE_EXPOSURE_NEG_2_0: int = 6
GOPRO_PROTUNE_EXPOSURE_NEG_1_5: int = 7
GOPRO_PROTUNE_EXPOSURE_NEG_1_0: int = 8
GOPRO_PROTUNE_EXPOSURE_NEG_0_5: int = 9
GOPRO_PROTUNE_EXPOSURE_ZERO: int = 10
GOPRO_PROTUNE_EXPOSURE_POS_0_5: int = 11
GOPRO_PROTUNE_EXPOSURE_POS_1_0: int = 12
GOPRO_PROTUNE_EXPOSURE_POS_1_5: int = 13
GOPRO_PROTUNE_EXPOSURE_POS_2_0: int = 14
GOPRO_PROTUNE_EXPOSURE_POS_2_5: int = 15
GOPRO_PROTUNE_EXPOSURE_POS_3_0: int = 16
GOPRO_PROTUNE_EXPOSURE_POS_3_5: int = 17
GOPRO_PROTUNE_EXPOSURE_POS_4_0: int = 18
GOPRO_PROTUNE_EXPOSURE_POS_4_5: int = 19
GOPRO_PROTUNE_EXPOSURE_POS_5_0: int = 20
GOPRO_PROTUNE_EXPOSURE_ENUM_END: int
GOPRO_CHARGING_DISABLED: int = 0
GOPRO_CHARGING_ENABLED: int = 1
GOPRO_CHARGING_ENUM_END: int
GOPRO_MODEL_UNKNOWN: int = 0
GOPRO_MODEL_HERO_3_PLUS_SILVER: int = 1
GOPRO_MODEL_HERO_3_PLUS_BLACK: int = 2
GOPRO_MODEL_HERO_4_SILVER: int = 3
GOPRO_MODEL_HERO_4_BLACK: int = 4
GOPRO_MODEL_ENUM_END: int
GOPRO_BURST_RATE_3_IN_1_SECOND: int = 0
GOPRO_BURST_RATE_5_IN_1_SECOND: int = 1
GOPRO_BURST_RATE_10_IN_1_SECOND: int = 2
GOPRO_BURST_RATE_10_IN_2_SECOND: int = 3
GOPRO_BURST_RATE_10_IN_3_SECOND: int = 4
GOPRO_BURST_RATE_30_IN_1_SECOND: int = 5
GOPRO_BURST_RATE_30_IN_2_SECOND: int = 6
GOPRO_BURST_RATE_30_IN_3_SECOND: int = 7
GOPRO_BURST_RATE_30_IN_6_SECOND: int = 8
GOPRO_BURST_RATE_ENUM_END: int
MAV_CMD_DO_AUX_FUNCTION_SWITCH_LEVEL_LOW: int = 0
MAV_CMD_DO_AUX_FUNCTION_SWITCH_LEVEL_MIDDLE: int = 1
MAV_CMD_DO_AUX_FUNCTION_SWITCH_LEVEL_HIGH: int = 2
MAV_CMD_DO_AUX_FUNCTION_SWITCH_LEVEL_ENUM_END: int
LED_CONTROL_PATTERN_OFF: int = 0
LED_CONTROL_PATTERN_FIRMWAREUPDATE: int = 1
LED_CONTROL_PATTERN_CUSTOM: int = 255
LED_CONTROL_PATTERN_ENUM_END: int
EKF_ATTITUDE: int = 1
EKF_VELOCITY_HORIZ: int = 2
EKF_VELOCITY_VERT: int = 4
EKF_POS_HORIZ_REL: int = 8
EKF_POS_HORIZ_ABS: int = 16
EKF_POS_VERT_ABS: int = 32
EKF_POS_VERT_AGL: int = 64
EKF_CONST_POS_MODE: int = 128
EKF_PRED_POS_HORIZ_REL: int = 256
EKF_PRED_POS_HORIZ_ABS: int = 512
EKF_UNINITIALIZED: int = 1024
EKF_GPS_GLITCHING: int = 32768
EKF_STATUS_FLAGS_ENUM_END: int
PID_TUNING_ROLL: int = 1
PID_TUNING_PITCH: int = 2
PID_TUNING_YAW: int = 3
PID_TUNING_ACCZ: int = 4
PID_TUNING_STEER: int = 5
PID_TUNING_LANDING: int = 6
PID_TUNING_WHEEL_LEFT: int = 7
PID_TUNING_WHEEL_RIGHT: int = 8
PID_TUNING_SAIL_HEEL: int = 9
PID_TUNING_VEL_NORTH: int = 10
PID_TUNING_VEL_EAST: int = 11
PID_TUNING_VEL_DOWN: int = 12
PID_TUNING_POS_NORTH: int = 13
PID_TUNING_POS_EAST: int = 14
PID_TUNING_POS_DOWN: int = 15
PID_TUNING_YAW_ANGLE: int = 16
PID_TUNING_AXIS_ENUM_END: int
MAV_REMOTE_LOG_DATA_BLOCK_STOP: int = 2147483645
MAV_REMOTE_LOG_DATA_BLOCK_START: int = 2147483646
MAV_REMOTE_LOG_DATA_BLOCK_COMMANDS_ENUM_END: int
MAV_REMOTE_LOG_DATA_BLOCK_NACK: int = 0
MAV_REMOTE_LOG_DATA_BLOCK_ACK: int = 1
MAV_REMOTE_LOG_DATA_BLOCK_STATUSES_ENUM_END: int
DEVICE_OP_BUSTYPE_I2C: int = 0
DEVICE_OP_BUSTYPE_SPI: int = 1
DEVICE_OP_BUSTYPE_ENUM_END: int
DEEPSTALL_STAGE_FLY_TO_LANDING: int = 0
DEEPSTALL_STAGE_ESTIMATE_WIND: int = 1
DEEPSTALL_STAGE_WAIT_FOR_BREAKOUT: int = 2
DEEPSTALL_STAGE_FLY_TO_ARC: int = 3
DEEPSTALL_STAGE_ARC: int = 4
DEEPSTALL_STAGE_APPROACH: int = 5
DEEPSTALL_STAGE_LAND: int = 6
DEEPSTALL_STAGE_ENUM_END: int
PLANE_MODE_MANUAL: int = 0
PLANE_MODE_CIRCLE: int = 1
PLANE_MODE_STABILIZE: int = 2
PLANE_MODE_TRAINING: int = 3
PLANE_MODE_ACRO: int = 4
PLANE_MODE_FLY_BY_WIRE_A: int = 5
PLANE_MODE_FLY_BY_WIRE_B: int = 6
PLANE_MODE_CRUISE: int = 7
PLANE_MODE_AUTOTUNE: int = 8
PLANE_MODE_AUTO: int = 10
PLANE_MODE_RTL: int = 11
PLANE_MODE_LOITER: int = 12
PLANE_MODE_TAKEOFF: int = 13
PLANE_MODE_AVOID_ADSB: int = 14
PLANE_MODE_GUIDED: int = 15
PLANE_MODE_INITIALIZING: int = 16
PLANE_MODE_QSTABILIZE: int = 17
PLANE_MODE_QHOVER: int = 18
PLANE_MODE_QLOITER: int = 19
PLANE_MODE_QLAND: int = 20
PLANE_MODE_QRTL: int = 21
PLANE_MODE_QAUTOTUNE: int = 22
PLANE_MODE_QACRO: int = 23
PLANE_MODE_THERMAL: int = 24
PLANE_MODE_LOITER_ALT_QLAND: int = 25
PLANE_MODE_AUTOLAND: int = 26
PLANE_MODE_ENUM_END: int
COPTER_MODE_STABILIZE: int = 0
COPTER_MODE_ACRO: int = 1
COPTER_MODE_ALT_HOLD: int = 2
COPTER_MODE_AUTO: int = 3
COPTER_MODE_GUIDED: int = 4
COPTER_MODE_LOITER: int = 5
COPTER_MODE_RTL: int = 6
COPTER_MODE_CIRCLE: int = 7
COPTER_MODE_LAND: int = 9
COPTER_MODE_DRIFT: int = 11
COPTER_MODE_SPORT: int = 13
COPTER_MODE_FLIP: int = 14
COPTER_MODE_AUTOTUNE: int = 15
COPTER_MODE_POSHOLD: int = 16
COPTER_MODE_BRAKE: int = 17
COPTER_MODE_THROW: int = 18
COPTER_MODE_AVOID_ADSB: int = 19
COPTER_MODE_GUIDED_NOGPS: int = 20
COPTER_MODE_SMART_RTL: int = 21
COPTER_MODE_FLOWHOLD: int = 22
COPTER_MODE_FOLLOW: int = 23
COPTER_MODE_ZIGZAG: int = 24
COPTER_MODE_SYSTEMID: int = 25
COPTER_MODE_AUTOROTATE: int = 26
COPTER_MODE_AUTO_RTL: int = 27
COPTER_MODE_TURTLE: int = 28
COPTER_MODE_ENUM_END: int
SUB_MODE_STABILIZE: int = 0
SUB_MODE_ACRO: int = 1
SUB_MODE_ALT_HOLD: int = 2
SUB_MODE_AUTO: int = 3
SUB_MODE_GUIDED: int = 4
SUB_MODE_CIRCLE: int = 7
SUB_MODE_SURFACE: int = 9
SUB_MODE_POSHOLD: int = 16
SUB_MODE_MANUAL: int = 19
SUB_MODE_MOTORDETECT: int = 20
SUB_MODE_SURFTRAK: int = 21
SUB_MODE_ENUM_END: int
ROVER_MODE_MANUAL: int = 0
ROVER_MODE_ACRO: int = 1
ROVER_MODE_STEERING: int = 3
ROVER_MODE_HOLD: int = 4
ROVER_MODE_LOITER: int = 5
ROVER_MODE_FOLLOW: int = 6
ROVER_MODE_SIMPLE: int = 7
ROVER_MODE_DOCK: int = 8
ROVER_MODE_CIRCLE: int = 9
ROVER_MODE_AUTO: int = 10
ROVER_MODE_RTL: int = 11
ROVER_MODE_SMART_RTL: int = 12
ROVER_MODE_GUIDED: int = 15
ROVER_MODE_INITIALIZING: int = 16
ROVER_MODE_ENUM_END: int
TRACKER_MODE_MANUAL: int = 0
TRACKER_MODE_STOP: int = 1
TRACKER_MODE_SCAN: int = 2
TRACKER_MODE_SERVO_TEST: int = 3
TRACKER_MODE_GUIDED: int = 4
TRACKER_MODE_AUTO: int = 10
TRACKER_MODE_INITIALIZING: int = 16
TRACKER_MODE_ENUM_END: int
OSD_PARAM_NONE: int = 0
OSD_PARAM_SERIAL_PROTOCOL: int = 1
OSD_PARAM_SERVO_FUNCTION: int = 2
OSD_PARAM_AUX_FUNCTION: int = 3
OSD_PARAM_FLIGHT_MODE: int = 4
OSD_PARAM_FAILSAFE_ACTION: int = 5
OSD_PARAM_FAILSAFE_ACTION_1: int = 6
OSD_PARAM_FAILSAFE_ACTION_2: int = 7
OSD_PARAM_NUM_TYPES: int = 8
OSD_PARAM_CONFIG_TYPE_ENUM_END: int
OSD_PARAM_SUCCESS: int = 0
OSD_PARAM_INVALID_SCREEN: int = 1
OSD_PARAM_INVALID_PARAMETER_INDEX: int = 2
OSD_PARAM_INVALID_PARAMETER: int = 3
OSD_PARAM_CONFIG_ERROR_ENUM_END: int

class MAVLink_sensor_offsets_message(_dialect.MAVLink_message):  # 150
    mag_ofs_x: int
    mag_ofs_y: int
    mag_ofs_z: int
    mag_declination: float  # rad
    raw_press: int
    raw_temp: int
    gyro_cal_x: float
    gyro_cal_y: float
    gyro_cal_z: float
    accel_cal_x: float
    accel_cal_y: float
    accel_cal_z: float
    def __init__(self, mag_ofs_x: int, mag_ofs_y: int, mag_ofs_z: int, mag_declination: float, raw_press: int,
        raw_temp: int, gyro_cal_x: float, gyro_cal_y: float, gyro_cal_z: float, accel_cal_x: float,
        accel_cal_y: float, accel_cal_z: float) -> None: ...

class MAVLink_set_mag_offsets_message(_dialect.MAVLink_message):  # 151
    target_system: int
    target_component: int
    mag_ofs_x: int
    mag_ofs_y: int
    mag_ofs_z: int
    def __init__(self, target_system: int, target_component: int, mag_ofs_x: int, mag_ofs_y: int,
        mag_ofs_z: int) -> None: ...

class MAVLink_meminfo_message(_dialect.MAVLink_message):  # 152
    brkval: int
    freemem: int  # bytes
    freemem32: int  # bytes
    def __init__(self, brkval: int, freemem: int, freemem32: int = 0) -> None: ...

class MAVLink_ap_adc_message(_dialect.MAVLink_message):  # 153
    adc1: int
    adc2: int
    adc3: int
    adc4: int
    adc5: int
    adc6: int
    def __init__(self, adc1: int, adc2: int, adc3: int, adc4: int, adc5: int, adc6: int) -> None: ...

class MAVLink_digicam_configure_message(_dialect.MAVLink_message):  # 154
    target_system: int
    target_component: int
    mode: int
    shutter_speed: int
    aperture: int
    iso: int
    exposure_type: int
    command_id: int
    engine_cut_off: int  # ds
    extra_param: int
    extra_value: float
    def __init__(self, target_system: int, target_component: int, mode: int, shutter_speed: int,
        aperture: int, iso: int, exposure_type: int, command_id: int, engine_cut_off: int, extra_param: int,
        extra_value: float) -> None: ...

class MAVLink_digicam_control_message(_dialect.MAVLink_message):  # 155
    target_system: int
    target_component: int
    session: int
    zoom_pos: int
    zoom_step: int
    focus_lock: int
    shot: int
    command_id: int
    extra_param: int
    extra_value: float
    def __init__(self, target_system: int, target_component: int, session: int, zoom_pos: int, zoom_step: int,
        focus_lock: int, shot: int, command_id: int, extra_param: int, extra_value: float) -> None: ...

class MAVLink_mount_configure_message(_dialect.MAVLink_message):  # 156
    target_system: int
    target_component: int
    mount_mode: int  # MAV_MOUNT_MODE
    stab_roll: int
    stab_pitch: int
    stab_yaw: int
    def __init__(self, target_system: int, target_component: int, mount_mode: int, stab_roll: int,
        stab_pitch: int, stab_yaw: int) -> None: ...

class MAVLink_mount_control_message(_dialect.MAVLink_message):  # 157
    target_system: int
    target_component: int
    input_a: int
    input_b: int
    input_c: int
    save_position: int
    def __init__(self, target_system: int, target_component: int, input_a: int, input_b: int, input_c: int,
        save_position: int) -> None: ...

class MAVLink_mount_status_message(_dialect.MAVLink_message):  # 158
    target_system: int
    target_component: int
    pointing_a: int  # cdeg
    pointing_b: int  # cdeg
    pointing_c: int  # cdeg
    mount_mode: int  # MAV_MOUNT_MODE
    def __init__(self, target_system: int, target_component: int, pointing_a: int, pointing_b: int,
        pointing_c: int, mount_mode: int = 0) -> None: ...

class MAVLink_fence_point_message(_dialect.MAVLink_message):  # 160
    target_system: int
    target_component: int
    idx: int
    count: int
    lat: float  # deg
    lng: float  # deg
    def __init__(self, target_system: int, target_component: int, idx: int, count: int, lat: float,
        lng: float) -> None: ...

class MAVLink_fence_fetch_point_message(_dialect.MAVLink_message):  # 161
    target_system: int
    target_component: int
    idx: int
    def __init__(self, target_system: int, target_component: int, idx: int) -> None: ...

class MAVLink_ahrs_message(_dialect.MAVLink_message):  # 163
    omegaIx: float  # rad/s
    omegaIy: float  # rad/s
    omegaIz: float  # rad/s
    accel_weight: float
    renorm_val: float
    error_rp: float
    error_yaw: float
    def __init__(self, omegaIx: float, omegaIy: float, omegaIz: float, accel_weight: float, renorm_val: float,
        error_rp: float, error_yaw: float) -> None: ...

class MAVLink_simstate_message(_dialect.MAVLink_message):  # 164
    roll: float  # rad
    pitch: float  # rad
    yaw: float  # rad
    xacc: float  # m/s/s
    yacc: float  # m/s/s
    zacc: float  # m/s/s
    xgyro: float  # rad/s
    ygyro: float  # rad/s
    zgyro: float  # rad/s
    lat: int  # degE7
    lng: int  # degE7
    def __init__(self, roll: float, pitch: float, yaw: float, xacc: float, yacc: float, zacc: float,
        xgyro: float, ygyro: float, zgyro: float, lat: int, lng: int) -> None: ...

class MAVLink_hwstatus_message(_dialect.MAVLink_message):  # 165
    Vcc: int  # mV
    I2Cerr: int
    def __init__(self, Vcc: int, I2Cerr: int) -> None: ...

class MAVLink_radio_message(_dialect.MAVLink_message):  # 166
    rssi: int
    remrssi: int
    txbuf: int  # %
    noise: int
    remnoise: int
    rxerrors: int
    fixed: int
    def __init__(self, rssi: int, remrssi: int, txbuf: int, noise: int, remnoise: int, rxerrors: int,
        fixed: int) -> None: ...

class MAVLink_limits_status_message(_dialect.MAVLink_message):  # 167
    limits_state: int  # LIMITS_STATE
    last_trigger: int  # ms
    last_action: int  # ms
    last_recovery: int  # ms
    last_clear: int  # ms
    breach_count: int
    mods_enabled: int  # LIMIT_MODULE
    mods_required: int  # LIMIT_MODULE
    mods_triggered: int  # LIMIT_MODULE
    def __init__(self, limits_state: int, last_trigger: int, last_action: int, last_recovery: int,
        last_clear: int, breach_count: int, mods_enabled: int, mods_required: int,
        mods_triggered: int) -> None: ...

class MAVLink_wind_message(_dialect.MAVLink_message):  # 168
    direction: float  # deg
    speed: float  # m/s
    speed_z: float  # m/s
    def __init__(self, direction: float, speed: float, speed_z: float) -> None: ...

class MAVLink_data16_message(_dialect.MAVLink_message):  # 169
    type: int
    len: int  # bytes
    data: list[int]
    def __init__(self, type: int, len: int, data: _Sequence[int]) -> None: ...

class MAVLink_data32_message(_dialect.MAVLink_message):  # 170
    type: int
    len: int  # bytes
    data: list[int]
    def __init__(self, type: int, len: int, data: _Sequence[int]) -> None: ...

class MAVLink_data64_message(_dialect.MAVLink_message):  # 171
    type: int
    len: int  # bytes
    data: list[int]
    def __init__(self, type: int, len: int, data: _Sequence[int]) -> None: ...

class MAVLink_data96_message(_dialect.MAVLink_message):  # 172
    type: int
    len: int  # bytes
    data: list[int]
    def __init__(self, type: int, len: int, data: _Sequence[int]) -> None: ...

class MAVLink_rangefinder_message(_dialect.MAVLink_message):  # 173
    distance: float  # m
    voltage: float  # V
    def __init__(self, distance: float, voltage: float) -> None: ...

class MAVLink_airspeed_autocal_message(_dialect.MAVLink_message):  # 174
    vx: float  # m/s
    vy: float  # m/s
    vz: float  # m/s
    diff_pressure: float  # Pa
    EAS2TAS: float
    ratio: float
    state_x: float
    state_y: float
    state_z: float
    Pax: float
    Pby: float
    Pcz: float
    def __init__(self, vx: float, vy: float, vz: float, diff_pressure: float, EAS2TAS: float, ratio: float,
        state_x: float, state_y: float, state_z: float, Pax: float, Pby: float, Pcz: float) -> None: ...

class MAVLink_rally_point_message(_dialect.MAVLink_message):  # 175
    target_system: int
    target_component: int
    idx: int
    count: int
    lat: int  # degE7
    lng: int  # degE7
    alt: int  # m
    break_alt: int  # m
    land_dir: int  # cdeg
    flags: int  # RALLY_FLAGS
    def __init__(self, target_system: int, target_component: int, idx: int, count: int, lat: int, lng: int,
        alt: int, break_alt: int, land_dir: int, flags: int) -> None: ...

class MAVLink_rally_fetch_point_message(_dialect.MAVLink_message):  # 176
    target_system: int
    target_component: int
    idx: int
    def __init__(self, target_system: int, target_component: int, idx: int) -> None: ...

class MAVLink_compassmot_status_message(_dialect.MAVLink_message):  # 177
    throttle: int  # d%
    current: float  # A
    interference: int  # %
    CompensationX: float
    CompensationY: float
    CompensationZ: float
    def __init__(self, throttle: int, current: float, interference: int, CompensationX: float,
        CompensationY: float, CompensationZ: float) -> None: ...

class MAVLink_ahrs2_message(_dialect.MAVLink_message):  # 178
    roll: float  # rad
    pitch: float  # rad
    yaw: float  # rad
    altitude: float  # m
    lat: int  # degE7
    lng: int  # degE7
    def __init__(self, roll: float, pitch: float, yaw: float, altitude: float, lat: int,
        lng: int) -> None: ...

class MAVLink_camera_status_message(_dialect.MAVLink_message):  # 179
    time_usec: int  # us
    target_system: int
    cam_idx: int
    img_idx: int
    event_id: int  # CAMERA_STATUS_TYPES
    p1: float
    p2: float
    p3: float
    p4: float
    def __init__(self, time_usec: int, target_system: int, cam_idx: int, img_idx: int, event_id: int,
        p1: float, p2: float, p3: float, p4: float) -> None: ...

class MAVLink_camera_feedback_message(_dialect.MAVLink_message):  # 180
    time_usec: int  # us
    target_system: int
    cam_idx: int
    img_idx: int
    lat: int  # degE7
    lng: int  # degE7
    alt_msl: float  # m
    alt_rel: float  # m
    roll: float  # deg
    pitch: float  # deg
    yaw: float  # deg
    foc_len: float  # mm
    flags: int  # CAMERA_FEEDBACK_FLAGS
    completed_captures: int
    def __init__(self, time_usec: int, target_system: int, cam_idx: int, img_idx: int, lat: int, lng: int,
        alt_msl: float, alt_rel: float, roll: float, pitch: float, yaw: float, foc_len: float, flags: int,
        completed_captures: int = 0) -> None: ...

class MAVLink_battery2_message(_dialect.MAVLink_message):  # 181
    voltage: int  # mV
    current_battery: int  # cA
    def __init__(self, voltage: int, current_battery: int) -> None: ...

class MAVLink_ahrs3_message(_dialect.MAVLink_message):  # 182
    roll: float  # rad
    pitch: float  # rad
    yaw: float  # rad
    altitude: float  # m
    lat: int  # degE7
    lng: int  # degE7
    v1: float
    v2: float
    v3: float
    v4: float
    def __init__(self, roll: float, pitch: float, yaw: float, altitude: float, lat: int, lng: int, v1: float,
        v2: float, v3: float, v4: float) -> None: ...

class MAVLink_autopilot_version_request_message(_dialect.MAVLink_message):  # 183
    target_system: int
    target_component: int
    def __init__(self, target_system: int, target_component: int) -> None: ...

class MAVLink_remote_log_data_block_message(_dialect.MAVLink_message):  # 184
    target_system: int
    target_component: int
    seqno: int  # MAV_REMOTE_LOG_DATA_BLOCK_COMMANDS
    data: list[int]
    def __init__(self, target_system: int, target_component: int, seqno: int,
        data: _Sequence[int]) -> None: ...

class MAVLink_remote_log_block_status_message(_dialect.MAVLink_message):  # 185
    target_system: int
    target_component: int
    seqno: int
    status: int  # MAV_REMOTE_LOG_DATA_BLOCK_STATUSES
    def __init__(self, target_system: int, target_component: int, seqno: int, status: int) -> None: ...

class MAVLink_led_control_message(_dialect.MAVLink_message):  # 186
    target_system: int
    target_component: int
    instance: int
    pattern: int
    custom_len: int
    custom_bytes: list[int]
    def __init__(self, target_system: int, target_component: int, instance: int, pattern: int,
        custom_len: int, custom_bytes: _Sequence[int]) -> None: ...

class MAVLink_mag_cal_progress_message(_dialect.MAVLink_message):  # 191
    compass_id: int
    cal_mask: int
    cal_status: int  # MAG_CAL_STATUS
    attempt: int
    completion_pct: int  # %
    completion_mask: list[int]
    direction_x: float
    direction_y: float
    direction_z: float
    def __init__(self, compass_id: int, cal_mask: int, cal_status: int, attempt: int, completion_pct: int,
        completion_mask: _Sequence[int], direction_x: float, direction_y: float,
        direction_z: float) -> None: ...

class MAVLink_ekf_status_report_message(_dialect.MAVLink_message):  # 193
    flags: int  # EKF_STATUS_FLAGS
    velocity_variance: float
    pos_horiz_variance: float
    pos_vert_variance: float
    compass_variance: float
    terrain_alt_variance: float
    airspeed_variance: float
    def __init__(self, flags: int, velocity_variance: float, pos_horiz_variance: float,
        pos_vert_variance: float, compass_variance: float, terrain_alt_variance: float,
        airspeed_variance: float = 0) -> None: ...

class MAVLink_pid_tuning_message(_dialect.MAVLink_message):  # 194
    axis: int  # PID_TUNING_AXIS
    desired: float
    achieved: float
    FF: float
    P: float
    I: float
    D: float
    SRate: float
    PDmod: float
    def __init__(self, axis: int, desired: float, achieved: float, FF: float, P: float, I: float, D: float,
        SRate: float = 0, PDmod: float = 0) -> None: ...

class MAVLink_deepstall_message(_dialect.MAVLink_message):  # 195
    landing_lat: int  # degE7
    landing_lon: int  # degE7
    path_lat: int  # degE7
    path_lon: int  # degE7
    arc_entry_lat: int  # degE7
    arc_entry_lon: int  # degE7
    altitude: float  # m
    expected_travel_distance: float  # m
    cross_track_error: float  # m
    stage: int  # DEEPSTALL_STAGE
    def __init__(self, landing_lat: int, landing_lon: int, path_lat: int, path_lon: int, arc_entry_lat: int,
        arc_entry_lon: int, altitude: float, expected_travel_distance: float, cross_track_error: float,
        stage: int) -> None: ...

class MAVLink_gimbal_report_message(_dialect.MAVLink_message):  # 200
    target_system: int
    target_component: int
    delta_time: float  # s
    delta_angle_x: float  # rad
    delta_angle_y: float  # rad
    delta_angle_z: float  # rad
    delta_velocity_x: float  # m/s
    delta_velocity_y: float  # m/s
    delta_velocity_z: float  # m/s
    joint_roll: float  # rad
    joint_el: float  # rad
    joint_az: float  # rad
    def __init__(self, target_system: int, target_component: int, delta_time: float, delta_angle_x: float,
        delta_angle_y: float, delta_angle_z: float, delta_velocity_x: float, delta_velocity_y: float,
        delta_velocity_z: float, joint_roll: float, joint_el: float, joint_az: float) -> None: ...

class MAVLink_gimbal_control_message(_dialect.MAVLink_message):  # 201
    target_system: int
    target_component: int
    demanded_rate_x: float  # rad/s
    demanded_rate_y: float  # rad/s
    demanded_rate_z: float  # rad/s
    def __init__(self, target_system: int, target_component: int, demanded_rate_x: float,
        demanded_rate_y: float, demanded_rate_z: float) -> None: ...

class MAVLink_gimbal_torque_cmd_report_message(_dialect.MAVLink_message):  # 214
    target_system: int
    target_component: int
    rl_torque_cmd: int
    el_torque_cmd: int
    az_torque_cmd: int
    def __init__(self, target_system: int, target_component: int, rl_torque_cmd: int, el_torque_cmd: int,
        az_torque_cmd: int) -> None: ...

class MAVLink_gopro_heartbeat_message(_dialect.MAVLink_message):  # 215
    status: int  # GOPRO_HEARTBEAT_STATUS
    capture_mode: int  # GOPRO_CAPTURE_MODE
    flags: int  # GOPRO_HEARTBEAT_FLAGS
    def __init__(self, status: int, capture_mode: int, flags: int) -> None: ...

class MAVLink_gopro_get_request_message(_dialect.MAVLink_message):  # 216
    target_system: int
    target_component: int
    cmd_id: int  # GOPRO_COMMAND
    def __init__(self, target_system: int, target_component: int, cmd_id: int) -> None: ...

class MAVLink_gopro_get_response_message(_dialect.MAVLink_message):  # 217
    cmd_id: int  # GOPRO_COMMAND
    status: int  # GOPRO_REQUEST_STATUS
    value: list[int]
    def __init__(self, cmd_id: int, status: int, value: _Sequence[int]) -> None: ...

class MAVLink_gopro_set_request_message(_dialect.MAVLink_message):  # 218
    target_system: int
    target_component: int
    cmd_id: int  # GOPRO_COMMAND
    value: list[int]
    def __init__(self, target_system: int, target_component: int, cmd_id: int,
        value: _Sequence[int]) -> None: ...

class MAVLink_gopro_set_response_message(_dialect.MAVLink_message):  # 219
    cmd_id: int  # GOPRO_COMMAND
    status: int  # GOPRO_REQUEST_STATUS
    def __init__(self, cmd_id: int, status: int) -> None: ...

class MAVLink_rpm_message(_dialect.MAVLink_message):  # 226
    rpm1: float
    rpm2: float
    def __init__(self, rpm1: float, rpm2: float) -> None: ...

class MAVLink_device_op_read_message(_dialect.MAVLink_message):  # 11000
    target_system: int
    target_component: int
    request_id: int
    bustype: int  # DEVICE_OP_BUSTYPE
    bus: int
    address: int
    busname: str
    _busname_raw: bytes
    regstart: int
    count: int
    bank: int
    def __init__(self, target_system: int, target_component: int, request_id: int, bustype: int, bus: int,
        address: int, busname: bytes, regstart: int, count: int, bank: int = 0) -> None: ...

class MAVLink_device_op_read_reply_message(_dialect.MAVLink_message):  # 11001
    request_id: int
    result: int
    regstart: int
    count: int
    data: list[int]
    bank: int
    def __init__(self, request_id: int, result: int, regstart: int, count: int, data: _Sequence[int],
        bank: int = 0) -> None: ...

class MAVLink_device_op_write_message(_dialect.MAVLink_message):  # 11002
    target_system: int
    target_component: int
    request_id: int
    bustype: int  # DEVICE_OP_BUSTYPE
    bus: int
    address: int
    busname: str
    _busname_raw: bytes
    regstart: int
    count: int
    data: list[int]
    bank: int
    def __init__(self, target_system: int, target_component: int, request_id: int, bustype: int, bus: int,
        address: int, busname: bytes, regstart: int, count: int, data: _Sequence[int],
        bank: int = 0) -> None: ...

class MAVLink_device_op_write_reply_message(_dialect.MAVLink_message):  # 11003
    request_id: int
    result: int
    def __init__(self, request_id: int, result: int) -> None: ...

class MAVLink_secure_command_message(_dialect.MAVLink_message):  # 11004
    target_system: int
    target_component: int
    sequence: int
    operation: int  # SECURE_COMMAND_OP
    data_length: int
    sig_length: int
    data: list[int]
    def __init__(self, target_system: int, target_component: int, sequence: int, operation: int,
        data_length: int, sig_length: int, data: _Sequence[int]) -> None: ...

class MAVLink_secure_command_reply_message(_dialect.MAVLink_message):  # 11005
    sequence: int
    operation: int  # SECURE_COMMAND_OP
    result: int  # MAV_RESULT
    data_length: int
    data: list[int]
    def __init__(self, sequence: int, operation: int, result: int, data_length: int,
        data: _Sequence[int]) -> None: ...

class MAVLink_adap_tuning_message(_dialect.MAVLink_message):  # 11010
    axis: int  # PID_TUNING_AXIS
    desired: float  # deg/s
    achieved: float  # deg/s
    error: float
    theta: float
    omega: float
    sigma: float
    theta_dot: float
    omega_dot: float
    sigma_dot: float
    f: float
    f_dot: float
    u: float
    def __init__(self, axis: int, desired: float, achieved: float, error: float, theta: float, omega: float,
        sigma: float, theta_dot: float, omega_dot: float, sigma_dot: float, f: float, f_dot: float,
        u: float) -> None: ...

class MAVLink_vision_position_delta_message(_dialect.MAVLink_message):  # 11011
    time_usec: int  # us
    time_delta_usec: int  # us
    angle_delta: list[float]  # rad
    position_delta: list[float]  # m
    confidence: float  # %
    def __init__(self, time_usec: int, time_delta_usec: int, angle_delta: _Sequence[float],
        position_delta: _Sequence[float], confidence: float) -> None: ...

class MAVLink_aoa_ssa_message(_dialect.MAVLink_message):  # 11020
    time_usec: int  # us
    AOA: float  # deg
    SSA: float  # deg
    def __init__(self, time_usec: int, AOA: float, SSA: float) -> None: ...

class MAVLink_esc_telemetry_1_to_4_message(_dialect.MAVLink_message):  # 11030
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_esc_telemetry_5_to_8_message(_dialect.MAVLink_message):  # 11031
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_esc_telemetry_9_to_12_message(_dialect.MAVLink_message):  # 11032
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_osd_param_config_message(_dialect.MAVLink_message):  # 11033
    target_system: int
    target_component: int
    request_id: int
    osd_screen: int
    osd_index: int
    param_id: str
    _param_id_raw: bytes
    config_type: int  # OSD_PARAM_CONFIG_TYPE
    min_value: float
    max_value: float
    increment: float
    def __init__(self, target_system: int, target_component: int, request_id: int, osd_screen: int,
        osd_index: int, param_id: bytes, config_type: int, min_value: float, max_value: float,
        increment: float) -> None: ...

class MAVLink_osd_param_config_reply_message(_dialect.MAVLink_message):  # 11034
    request_id: int
    result: int  # OSD_PARAM_CONFIG_ERROR
    def __init__(self, request_id: int, result: int) -> None: ...

class MAVLink_osd_param_show_config_message(_dialect.MAVLink_message):  # 11035
    target_system: int
    target_component: int
    request_id: int
    osd_screen: int
    osd_index: int
    def __init__(self, target_system: int, target_component: int, request_id: int, osd_screen: int,
        osd_index: int) -> None: ...

class MAVLink_osd_param_show_config_reply_message(_dialect.MAVLink_message):  # 11036
    request_id: int
    result: int  # OSD_PARAM_CONFIG_ERROR
    param_id: str
    _param_id_raw: bytes
    config_type: int  # OSD_PARAM_CONFIG_TYPE
    min_value: float
    max_value: float
    increment: float
    def __init__(self, request_id: int, result: int, param_id: bytes, config_type: int, min_value: float,
        max_value: float, increment: float) -> None: ...

class MAVLink_obstacle_distance_3d_message(_dialect.MAVLink_message):  # 11037
    time_boot_ms: int  # ms
    sensor_type: int  # MAV_DISTANCE_SENSOR
    frame: int  # MAV_FRAME
    obstacle_id: int
    x: float  # m
    y: float  # m
    z: float  # m
    min_distance: float  # m
    max_distance: float  # m
    def __init__(self, time_boot_ms: int, sensor_type: int, frame: int, obstacle_id: int, x: float, y: float,
        z: float, min_distance: float, max_distance: float) -> None: ...

class MAVLink_water_depth_message(_dialect.MAVLink_message):  # 11038
    time_boot_ms: int  # ms
    id: int
    healthy: int
    lat: int  # degE7
    lng: int  # degE7
    alt: float  # m
    roll: float  # rad
    pitch: float  # rad
    yaw: float  # rad
    distance: float  # m
    temperature: float  # degC
    def __init__(self, time_boot_ms: int, id: int, healthy: int, lat: int, lng: int, alt: float, roll: float,
        pitch: float, yaw: float, distance: float, temperature: float) -> None: ...

class MAVLink_mcu_status_message(_dialect.MAVLink_message):  # 11039
    id: int
    MCU_temperature: int  # cdegC
    MCU_voltage: int  # mV
    MCU_voltage_min: int  # mV
    MCU_voltage_max: int  # mV
    def __init__(self, id: int, MCU_temperature: int, MCU_voltage: int, MCU_voltage_min: int,
        MCU_voltage_max: int) -> None: ...

class MAVLink_esc_telemetry_13_to_16_message(_dialect.MAVLink_message):  # 11040
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_esc_telemetry_17_to_20_message(_dialect.MAVLink_message):  # 11041
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_esc_telemetry_21_to_24_message(_dialect.MAVLink_message):  # 11042
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_esc_telemetry_25_to_28_message(_dialect.MAVLink_message):  # 11043
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_esc_telemetry_29_to_32_message(_dialect.MAVLink_message):  # 11044
    temperature: list[int]  # degC
    voltage: list[int]  # cV
    current: list[int]  # cA
    totalcurrent: list[int]  # mAh
    rpm: list[int]  # rpm
    count: list[int]
    def __init__(self, temperature: _Sequence[int], voltage: _Sequence[int], current: _Sequence[int],
        totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int]) -> None: ...

class MAVLink_named_value_string_message(_dialect.MAVLink_message):  # 11060
    time_boot_ms: int  # ms
    name: str
    _name_raw: bytes
    value: str
    _value_raw: bytes
    def __init__(self, time_boot_ms: int, name: bytes, value: bytes) -> None: ...

class _Methods:
    def sensor_offsets_encode(self, mag_ofs_x: int, mag_ofs_y: int, mag_ofs_z: int, mag_declination: float,
        raw_press: int, raw_temp: int, gyro_cal_x: float, gyro_cal_y: float, gyro_cal_z: float,
        accel_cal_x: float, accel_cal_y: float, accel_cal_z: float) -> MAVLink_sensor_offsets_message: ...
    def sensor_offsets_send(self, mag_ofs_x: int, mag_ofs_y: int, mag_ofs_z: int, mag_declination: float,
        raw_press: int, raw_temp: int, gyro_cal_x: float, gyro_cal_y: float, gyro_cal_z: float,
        accel_cal_x: float, accel_cal_y: float, accel_cal_z: float, force_mavlink1: bool = False) -> None: ...
    def set_mag_offsets_encode(self, target_system: int, target_component: int, mag_ofs_x: int,
        mag_ofs_y: int, mag_ofs_z: int) -> MAVLink_set_mag_offsets_message: ...
    def set_mag_offsets_send(self, target_system: int, target_component: int, mag_ofs_x: int, mag_ofs_y: int,
        mag_ofs_z: int, force_mavlink1: bool = False) -> None: ...
    def meminfo_encode(self, brkval: int, freemem: int, freemem32: int = 0) -> MAVLink_meminfo_message: ...
    def meminfo_send(self, brkval: int, freemem: int, freemem32: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def ap_adc_encode(self, adc1: int, adc2: int, adc3: int, adc4: int, adc5: int,
        adc6: int) -> MAVLink_ap_adc_message: ...
    def ap_adc_send(self, adc1: int, adc2: int, adc3: int, adc4: int, adc5: int, adc6: int,
        force_mavlink1: bool = False) -> None: ...
    def digicam_configure_encode(self, target_system: int, target_component: int, mode: int,
        shutter_speed: int, aperture: int, iso: int, exposure_type: int, command_id: int, engine_cut_off: int,
        extra_param: int, extra_value: float) -> MAVLink_digicam_configure_message: ...
    def digicam_configure_send(self, target_system: int, target_component: int, mode: int, shutter_speed: int,
        aperture: int, iso: int, exposure_type: int, command_id: int, engine_cut_off: int, extra_param: int,
        extra_value: float, force_mavlink1: bool = False) -> None: ...
    def digicam_control_encode(self, target_system: int, target_component: int, session: int, zoom_pos: int,
        zoom_step: int, focus_lock: int, shot: int, command_id: int, extra_param: int,
        extra_value: float) -> MAVLink_digicam_control_message: ...
    def digicam_control_send(self, target_system: int, target_component: int, session: int, zoom_pos: int,
        zoom_step: int, focus_lock: int, shot: int, command_id: int, extra_param: int, extra_value: float,
        force_mavlink1: bool = False) -> None: ...
    def mount_configure_encode(self, target_system: int, target_component: int, mount_mode: int,
        stab_roll: int, stab_pitch: int, stab_yaw: int) -> MAVLink_mount_configure_message: ...
    def mount_configure_send(self, target_system: int, target_component: int, mount_mode: int, stab_roll: int,
        stab_pitch: int, stab_yaw: int, force_mavlink1: bool = False) -> None: ...
    def mount_control_encode(self, target_system: int, target_component: int, input_a: int, input_b: int,
        input_c: int, save_position: int) -> MAVLink_mount_control_message: ...
    def mount_control_send(self, target_system: int, target_component: int, input_a: int, input_b: int,
        input_c: int, save_position: int, force_mavlink1: bool = False) -> None: ...
    def mount_status_encode(self, target_system: int, target_component: int, pointing_a: int, pointing_b: int,
        pointing_c: int, mount_mode: int = 0) -> MAVLink_mount_status_message: ...
    def mount_status_send(self, target_system: int, target_component: int, pointing_a: int, pointing_b: int,
        pointing_c: int, mount_mode: int = 0, force_mavlink1: bool = False) -> None: ...
    def fence_point_encode(self, target_system: int, target_component: int, idx: int, count: int, lat: float,
        lng: float) -> MAVLink_fence_point_message: ...
    def fence_point_send(self, target_system: int, target_component: int, idx: int, count: int, lat: float,
        lng: float, force_mavlink1: bool = False) -> None: ...
    def fence_fetch_point_encode(self, target_system: int, target_component: int,
        idx: int) -> MAVLink_fence_fetch_point_message: ...
    def fence_fetch_point_send(self, target_system: int, target_component: int, idx: int,
        force_mavlink1: bool = False) -> None: ...
    def ahrs_encode(self, omegaIx: float, omegaIy: float, omegaIz: float, accel_weight: float,
        renorm_val: float, error_rp: float, error_yaw: float) -> MAVLink_ahrs_message: ...
    def ahrs_send(self, omegaIx: float, omegaIy: float, omegaIz: float, accel_weight: float,
        renorm_val: float, error_rp: float, error_yaw: float, force_mavlink1: bool = False) -> None: ...
    def simstate_encode(self, roll: float, pitch: float, yaw: float, xacc: float, yacc: float, zacc: float,
        xgyro: float, ygyro: float, zgyro: float, lat: int, lng: int) -> MAVLink_simstate_message: ...
    def simstate_send(self, roll: float, pitch: float, yaw: float, xacc: float, yacc: float, zacc: float,
        xgyro: float, ygyro: float, zgyro: float, lat: int, lng: int,
        force_mavlink1: bool = False) -> None: ...
    def hwstatus_encode(self, Vcc: int, I2Cerr: int) -> MAVLink_hwstatus_message: ...
    def hwstatus_send(self, Vcc: int, I2Cerr: int, force_mavlink1: bool = False) -> None: ...
    def radio_encode(self, rssi: int, remrssi: int, txbuf: int, noise: int, remnoise: int, rxerrors: int,
        fixed: int) -> MAVLink_radio_message: ...
    def radio_send(self, rssi: int, remrssi: int, txbuf: int, noise: int, remnoise: int, rxerrors: int,
        fixed: int, force_mavlink1: bool = False) -> None: ...
    def limits_status_encode(self, limits_state: int, last_trigger: int, last_action: int, last_recovery: int,
        last_clear: int, breach_count: int, mods_enabled: int, mods_required: int,
        mods_triggered: int) -> MAVLink_limits_status_message: ...
    def limits_status_send(self, limits_state: int, last_trigger: int, last_action: int, last_recovery: int,
        last_clear: int, breach_count: int, mods_enabled: int, mods_required: int, mods_triggered: int,
        force_mavlink1: bool = False) -> None: ...
    def wind_encode(self, direction: float, speed: float, speed_z: float) -> MAVLink_wind_message: ...
    def wind_send(self, direction: float, speed: float, speed_z: float,
        force_mavlink1: bool = False) -> None: ...
    def data16_encode(self, type: int, len: int, data: _Sequence[int]) -> MAVLink_data16_message: ...
    def data16_send(self, type: int, len: int, data: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def data32_encode(self, type: int, len: int, data: _Sequence[int]) -> MAVLink_data32_message: ...
    def data32_send(self, type: int, len: int, data: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def data64_encode(self, type: int, len: int, data: _Sequence[int]) -> MAVLink_data64_message: ...
    def data64_send(self, type: int, len: int, data: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def data96_encode(self, type: int, len: int, data: _Sequence[int]) -> MAVLink_data96_message: ...
    def data96_send(self, type: int, len: int, data: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def rangefinder_encode(self, distance: float, voltage: float) -> MAVLink_rangefinder_message: ...
    def rangefinder_send(self, distance: float, voltage: float, force_mavlink1: bool = False) -> None: ...
    def airspeed_autocal_encode(self, vx: float, vy: float, vz: float, diff_pressure: float, EAS2TAS: float,
        ratio: float, state_x: float, state_y: float, state_z: float, Pax: float, Pby: float,
        Pcz: float) -> MAVLink_airspeed_autocal_message: ...
    def airspeed_autocal_send(self, vx: float, vy: float, vz: float, diff_pressure: float, EAS2TAS: float,
        ratio: float, state_x: float, state_y: float, state_z: float, Pax: float, Pby: float, Pcz: float,
        force_mavlink1: bool = False) -> None: ...
    def rally_point_encode(self, target_system: int, target_component: int, idx: int, count: int, lat: int,
        lng: int, alt: int, break_alt: int, land_dir: int, flags: int) -> MAVLink_rally_point_message: ...
    def rally_point_send(self, target_system: int, target_component: int, idx: int, count: int, lat: int,
        lng: int, alt: int, break_alt: int, land_dir: int, flags: int,
        force_mavlink1: bool = False) -> None: ...
    def rally_fetch_point_encode(self, target_system: int, target_component: int,
        idx: int) -> MAVLink_rally_fetch_point_message: ...
    def rally_fetch_point_send(self, target_system: int, target_component: int, idx: int,
        force_mavlink1: bool = False) -> None: ...
    def compassmot_status_encode(self, throttle: int, current: float, interference: int, CompensationX: float,
        CompensationY: float, CompensationZ: float) -> MAVLink_compassmot_status_message: ...
    def compassmot_status_send(self, throttle: int, current: float, interference: int, CompensationX: float,
        CompensationY: float, CompensationZ: float, force_mavlink1: bool = False) -> None: ...
    def ahrs2_encode(self, roll: float, pitch: float, yaw: float, altitude: float, lat: int,
        lng: int) -> MAVLink_ahrs2_message: ...
    def ahrs2_send(self, roll: float, pitch: float, yaw: float, altitude: float, lat: int, lng: int,
        force_mavlink1: bool = False) -> None: ...
    def camera_status_encode(self, time_usec: int, target_system: int, cam_idx: int, img_idx: int,
        event_id: int, p1: float, p2: float, p3: float, p4: float) -> MAVLink_camera_status_message: ...
    def camera_status_send(self, time_usec: int, target_system: int, cam_idx: int, img_idx: int,
        event_id: int, p1: float, p2: float, p3: float, p4: float, force_mavlink1: bool = False) -> None: ...
    def camera_feedback_encode(self, time_usec: int, target_system: int, cam_idx: int, img_idx: int, lat: int,
        lng: int, alt_msl: float, alt_rel: float, roll: float, pitch: float, yaw: float, foc_len: float,
        flags: int, completed_captures: int = 0) -> MAVLink_camera_feedback_message: ...
    def camera_feedback_send(self, time_usec: int, target_system: int, cam_idx: int, img_idx: int, lat: int,
        lng: int, alt_msl: float, alt_rel: float, roll: float, pitch: float, yaw: float, foc_len: float,
        flags: int, completed_captures: int = 0, force_mavlink1: bool = False) -> None: ...
    def battery2_encode(self, voltage: int, current_battery: int) -> MAVLink_battery2_message: ...
    def battery2_send(self, voltage: int, current_battery: int, force_mavlink1: bool = False) -> None: ...
    def ahrs3_encode(self, roll: float, pitch: float, yaw: float, altitude: float, lat: int, lng: int,
        v1: float, v2: float, v3: float, v4: float) -> MAVLink_ahrs3_message: ...
    def ahrs3_send(self, roll: float, pitch: float, yaw: float, altitude: float, lat: int, lng: int,
        v1: float, v2: float, v3: float, v4: float, force_mavlink1: bool = False) -> None: ...
    def autopilot_version_request_encode(self, target_system: int,
        target_component: int) -> MAVLink_autopilot_version_request_message: ...
    def autopilot_version_request_send(self, target_system: int, target_component: int,
        force_mavlink1: bool = False) -> None: ...
    def remote_log_data_block_encode(self, target_system: int, target_component: int, seqno: int,
        data: _Sequence[int]) -> MAVLink_remote_log_data_block_message: ...
    def remote_log_data_block_send(self, target_system: int, target_component: int, seqno: int,
        data: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def remote_log_block_status_encode(self, target_system: int, target_component: int, seqno: int,
        status: int) -> MAVLink_remote_log_block_status_message: ...
    def remote_log_block_status_send(self, target_system: int, target_component: int, seqno: int, status: int,
        force_mavlink1: bool = False) -> None: ...
    def led_control_encode(self, target_system: int, target_component: int, instance: int, pattern: int,
        custom_len: int, custom_bytes: _Sequence[int]) -> MAVLink_led_control_message: ...
    def led_control_send(self, target_system: int, target_component: int, instance: int, pattern: int,
        custom_len: int, custom_bytes: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def mag_cal_progress_encode(self, compass_id: int, cal_mask: int, cal_status: int, attempt: int,
        completion_pct: int, completion_mask: _Sequence[int], direction_x: float, direction_y: float,
        direction_z: float) -> MAVLink_mag_cal_progress_message: ...
    def mag_cal_progress_send(self, compass_id: int, cal_mask: int, cal_status: int, attempt: int,
        completion_pct: int, completion_mask: _Sequence[int], direction_x: float, direction_y: float,
        direction_z: float, force_mavlink1: bool = False) -> None: ...
    def ekf_status_report_encode(self, flags: int, velocity_variance: float, pos_horiz_variance: float,
        pos_vert_variance: float, compass_variance: float, terrain_alt_variance: float,
        airspeed_variance: float = 0) -> MAVLink_ekf_status_report_message: ...
    def ekf_status_report_send(self, flags: int, velocity_variance: float, pos_horiz_variance: float,
        pos_vert_variance: float, compass_variance: float, terrain_alt_variance: float,
        airspeed_variance: float = 0, force_mavlink1: bool = False) -> None: ...
    def pid_tuning_encode(self, axis: int, desired: float, achieved: float, FF: float, P: float, I: float,
        D: float, SRate: float = 0, PDmod: float = 0) -> MAVLink_pid_tuning_message: ...
    def pid_tuning_send(self, axis: int, desired: float, achieved: float, FF: float, P: float, I: float,
        D: float, SRate: float = 0, PDmod: float = 0, force_mavlink1: bool = False) -> None: ...
    def deepstall_encode(self, landing_lat: int, landing_lon: int, path_lat: int, path_lon: int,
        arc_entry_lat: int, arc_entry_lon: int, altitude: float, expected_travel_distance: float,
        cross_track_error: float, stage: int) -> MAVLink_deepstall_message: ...
    def deepstall_send(self, landing_lat: int, landing_lon: int, path_lat: int, path_lon: int,
        arc_entry_lat: int, arc_entry_lon: int, altitude: float, expected_travel_distance: float,
        cross_track_error: float, stage: int, force_mavlink1: bool = False) -> None: ...
    def gimbal_report_encode(self, target_system: int, target_component: int, delta_time: float,
        delta_angle_x: float, delta_angle_y: float, delta_angle_z: float, delta_velocity_x: float,
        delta_velocity_y: float, delta_velocity_z: float, joint_roll: float, joint_el: float,
        joint_az: float) -> MAVLink_gimbal_report_message: ...
    def gimbal_report_send(self, target_system: int, target_component: int, delta_time: float,
        delta_angle_x: float, delta_angle_y: float, delta_angle_z: float, delta_velocity_x: float,
        delta_velocity_y: float, delta_velocity_z: float, joint_roll: float, joint_el: float, joint_az: float,
        force_mavlink1: bool = False) -> None: ...
    def gimbal_control_encode(self, target_system: int, target_component: int, demanded_rate_x: float,
        demanded_rate_y: float, demanded_rate_z: float) -> MAVLink_gimbal_control_message: ...
    def gimbal_control_send(self, target_system: int, target_component: int, demanded_rate_x: float,
        demanded_rate_y: float, demanded_rate_z: float, force_mavlink1: bool = False) -> None: ...
    def gimbal_torque_cmd_report_encode(self, target_system: int, target_component: int, rl_torque_cmd: int,
        el_torque_cmd: int, az_torque_cmd: int) -> MAVLink_gimbal_torque_cmd_report_message: ...
    def gimbal_torque_cmd_report_send(self, target_system: int, target_component: int, rl_torque_cmd: int,
        el_torque_cmd: int, az_torque_cmd: int, force_mavlink1: bool = False) -> None: ...
    def gopro_heartbeat_encode(self, status: int, capture_mode: int,
        flags: int) -> MAVLink_gopro_heartbeat_message: ...
    def gopro_heartbeat_send(self, status: int, capture_mode: int, flags: int,
        force_mavlink1: bool = False) -> None: ...
    def gopro_get_request_encode(self, target_system: int, target_component: int,
        cmd_id: int) -> MAVLink_gopro_get_request_message: ...
    def gopro_get_request_send(self, target_system: int, target_component: int, cmd_id: int,
        force_mavlink1: bool = False) -> None: ...
    def gopro_get_response_encode(self, cmd_id: int, status: int,
        value: _Sequence[int]) -> MAVLink_gopro_get_response_message: ...
    def gopro_get_response_send(self, cmd_id: int, status: int, value: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def gopro_set_request_encode(self, target_system: int, target_component: int, cmd_id: int,
        value: _Sequence[int]) -> MAVLink_gopro_set_request_message: ...
    def gopro_set_request_send(self, target_system: int, target_component: int, cmd_id: int,
        value: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def gopro_set_response_encode(self, cmd_id: int, status: int) -> MAVLink_gopro_set_response_message: ...
    def gopro_set_response_send(self, cmd_id: int, status: int, force_mavlink1: bool = False) -> None: ...
    def rpm_encode(self, rpm1: float, rpm2: float) -> MAVLink_rpm_message: ...
    def rpm_send(self, rpm1: float, rpm2: float, force_mavlink1: bool = False) -> None: ...
    def device_op_read_encode(self, target_system: int, target_component: int, request_id: int, bustype: int,
        bus: int, address: int, busname: bytes, regstart: int, count: int,
        bank: int = 0) -> MAVLink_device_op_read_message: ...
    def device_op_read_send(self, target_system: int, target_component: int, request_id: int, bustype: int,
        bus: int, address: int, busname: bytes, regstart: int, count: int, bank: int = 0,
        force_mavlink1: bool = False) -> None: ...
    def device_op_read_reply_encode(self, request_id: int, result: int, regstart: int, count: int,
        data: _Sequence[int], bank: int = 0) -> MAVLink_device_op_read_reply_message: ...
    def device_op_read_reply_send(self, request_id: int, result: int, regstart: int, count: int,
        data: _Sequence[int], bank: int = 0, force_mavlink1: bool = False) -> None: ...
    def device_op_write_encode(self, target_system: int, target_component: int, request_id: int, bustype: int,
        bus: int, address: int, busname: bytes, regstart: int, count: int, data: _Sequence[int],
        bank: int = 0) -> MAVLink_device_op_write_message: ...
    def device_op_write_send(self, target_system: int, target_component: int, request_id: int, bustype: int,
        bus: int, address: int, busname: bytes, regstart: int, count: int, data: _Sequence[int],
        bank: int = 0, force_mavlink1: bool = False) -> None: ...
    def device_op_write_reply_encode(self, request_id: int,
        result: int) -> MAVLink_device_op_write_reply_message: ...
    def device_op_write_reply_send(self, request_id: int, result: int,
        force_mavlink1: bool = False) -> None: ...
    def secure_command_encode(self, target_system: int, target_component: int, sequence: int, operation: int,
        data_length: int, sig_length: int, data: _Sequence[int]) -> MAVLink_secure_command_message: ...
    def secure_command_send(self, target_system: int, target_component: int, sequence: int, operation: int,
        data_length: int, sig_length: int, data: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def secure_command_reply_encode(self, sequence: int, operation: int, result: int, data_length: int,
        data: _Sequence[int]) -> MAVLink_secure_command_reply_message: ...
    def secure_command_reply_send(self, sequence: int, operation: int, result: int, data_length: int,
        data: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def adap_tuning_encode(self, axis: int, desired: float, achieved: float, error: float, theta: float,
        omega: float, sigma: float, theta_dot: float, omega_dot: float, sigma_dot: float, f: float,
        f_dot: float, u: float) -> MAVLink_adap_tuning_message: ...
    def adap_tuning_send(self, axis: int, desired: float, achieved: float, error: float, theta: float,
        omega: float, sigma: float, theta_dot: float, omega_dot: float, sigma_dot: float, f: float,
        f_dot: float, u: float, force_mavlink1: bool = False) -> None: ...
    def vision_position_delta_encode(self, time_usec: int, time_delta_usec: int,
        angle_delta: _Sequence[float], position_delta: _Sequence[float],
        confidence: float) -> MAVLink_vision_position_delta_message: ...
    def vision_position_delta_send(self, time_usec: int, time_delta_usec: int, angle_delta: _Sequence[float],
        position_delta: _Sequence[float], confidence: float, force_mavlink1: bool = False) -> None: ...
    def aoa_ssa_encode(self, time_usec: int, AOA: float, SSA: float) -> MAVLink_aoa_ssa_message: ...
    def aoa_ssa_send(self, time_usec: int, AOA: float, SSA: float, force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_1_to_4_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_1_to_4_message: ...
    def esc_telemetry_1_to_4_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_5_to_8_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_5_to_8_message: ...
    def esc_telemetry_5_to_8_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_9_to_12_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_9_to_12_message: ...
    def esc_telemetry_9_to_12_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def osd_param_config_encode(self, target_system: int, target_component: int, request_id: int,
        osd_screen: int, osd_index: int, param_id: bytes, config_type: int, min_value: float,
        max_value: float, increment: float) -> MAVLink_osd_param_config_message: ...
    def osd_param_config_send(self, target_system: int, target_component: int, request_id: int,
        osd_screen: int, osd_index: int, param_id: bytes, config_type: int, min_value: float,
        max_value: float, increment: float, force_mavlink1: bool = False) -> None: ...
    def osd_param_config_reply_encode(self, request_id: int,
        result: int) -> MAVLink_osd_param_config_reply_message: ...
    def osd_param_config_reply_send(self, request_id: int, result: int,
        force_mavlink1: bool = False) -> None: ...
    def osd_param_show_config_encode(self, target_system: int, target_component: int, request_id: int,
        osd_screen: int, osd_index: int) -> MAVLink_osd_param_show_config_message: ...
    def osd_param_show_config_send(self, target_system: int, target_component: int, request_id: int,
        osd_screen: int, osd_index: int, force_mavlink1: bool = False) -> None: ...
    def osd_param_show_config_reply_encode(self, request_id: int, result: int, param_id: bytes,
        config_type: int, min_value: float, max_value: float,
        increment: float) -> MAVLink_osd_param_show_config_reply_message: ...
    def osd_param_show_config_reply_send(self, request_id: int, result: int, param_id: bytes,
        config_type: int, min_value: float, max_value: float, increment: float,
        force_mavlink1: bool = False) -> None: ...
    def obstacle_distance_3d_encode(self, time_boot_ms: int, sensor_type: int, frame: int, obstacle_id: int,
        x: float, y: float, z: float, min_distance: float,
        max_distance: float) -> MAVLink_obstacle_distance_3d_message: ...
    def obstacle_distance_3d_send(self, time_boot_ms: int, sensor_type: int, frame: int, obstacle_id: int,
        x: float, y: float, z: float, min_distance: float, max_distance: float,
        force_mavlink1: bool = False) -> None: ...
    def water_depth_encode(self, time_boot_ms: int, id: int, healthy: int, lat: int, lng: int, alt: float,
        roll: float, pitch: float, yaw: float, distance: float,
        temperature: float) -> MAVLink_water_depth_message: ...
    def water_depth_send(self, time_boot_ms: int, id: int, healthy: int, lat: int, lng: int, alt: float,
        roll: float, pitch: float, yaw: float, distance: float, temperature: float,
        force_mavlink1: bool = False) -> None: ...
    def mcu_status_encode(self, id: int, MCU_temperature: int, MCU_voltage: int, MCU_voltage_min: int,
        MCU_voltage_max: int) -> MAVLink_mcu_status_message: ...
    def mcu_status_send(self, id: int, MCU_temperature: int, MCU_voltage: int, MCU_voltage_min: int,
        MCU_voltage_max: int, force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_13_to_16_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_13_to_16_message: ...
    def esc_telemetry_13_to_16_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_17_to_20_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_17_to_20_message: ...
    def esc_telemetry_17_to_20_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_21_to_24_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_21_to_24_message: ...
    def esc_telemetry_21_to_24_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_25_to_28_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_25_to_28_message: ...
    def esc_telemetry_25_to_28_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def esc_telemetry_29_to_32_encode(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int],
        count: _Sequence[int]) -> MAVLink_esc_telemetry_29_to_32_message: ...
    def esc_telemetry_29_to_32_send(self, temperature: _Sequence[int], voltage: _Sequence[int],
        current: _Sequence[int], totalcurrent: _Sequence[int], rpm: _Sequence[int], count: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def named_value_string_encode(self, time_boot_ms: int, name: bytes,
        value: bytes) -> MAVLink_named_value_string_message: ...
    def named_value_string_send(self, time_boot_ms: int, name: bytes, value: bytes,
        force_mavlink1: bool = False) -> None: ...
