"""What dialect development itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_MISSION_CHECKSUM: int = 53
MAVLINK_MSG_ID_RADIO_RC_CHANNELS: int = 420
MAVLINK_MSG_ID_AVAILABLE_MODES: int = 435
MAVLINK_MSG_ID_CURRENT_MODE: int = 436
MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR: int = 437
MAVLINK_MSG_ID_GNSS_INTEGRITY: int = 441
MAVLINK_MSG_ID_RANGING_BEACON: int = 513
RADIO_RC_CHANNELS_FLAGS_FAILSAFE: int = 1
RADIO_RC_CHANNELS_FLAGS_OUTDATED: int = 2
RADIO_RC_CHANNELS_FLAGS_ENUM_END: int
MAV_MODE_PROPERTY_ADVANCED: int = 1
MAV_MODE_PROPERTY_NOT_USER_SELECTABLE: int = 2
MAV_MODE_PROPERTY_ENUM_END: int
MAV_CMD_DO_SET_SYS_CMP_ID: int = 610
MAV_CMD_DO_SET_GLOBAL_ORIGIN: int = 611
MAV_CMD_CAMERA_START_MTI: int = 2020
MAV_CMD_CAMERA_STOP_MTI: int = 2021
MAV_CMD_NAV_FENCE_HOME_CIRCLE_INCLUSION: int = 5005
MAV_CMD_EXTERNAL_WIND_ESTIMATE: int = 43004
GPS_SYSTEM_ERROR_INCOMING_CORRECTIONS: int = 1
GPS_SYSTEM_ERROR_CONFIGURATION: int = 2
GPS_SYSTEM_ERROR_SOFTWARE: int = 4
GPS_SYSTEM_ERROR_ANTENNA: int = 8
GPS_SYSTEM_ERROR_EVENT_CONGESTION: int = 16
GPS_SYSTEM_ERROR_CPU_OVERLOAD: int = 32
GPS_SYSTEM_ERROR_OUTPUT_CONGESTION: int = 64
GPS_SYSTEM_ERROR_FLAGS_ENUM_END: int
GPS_AUTHENTICATION_STATE_UNKNOWN: int = 0
GPS_AUTHENTICATION_STATE_INITIALIZING: int = 1
GPS_AUTHENTICATION_STATE_ERROR: int = 2
GPS_AUTHENTICATION_STATE_OK: int = 3
GPS_AUTHENTICATION_STATE_DISABLED: int = 4
GPS_AUTHENTICATION_STATE_ENUM_END: int
GPS_JAMMING_STATE_UNKNOWN: int = 0
GPS_JAMMING_STATE_NOT_JAMMED: int = 1
GPS_JAMMING_STATE_MITIGATED: int = 2
GPS_JAMMING_STATE_DETECTED: int = 3
GPS_JAMMING_STATE_ENUM_END: int
GPS_SPOOFING_STATE_UNKNOWN: int = 0
GPS_SPOOFING_STATE_NOT_SPOOFED: int = 1
GPS_SPOOFING_STATE_MITIGATED: int = 2
GPS_SPOOFING_STATE_DETECTED: int = 3
GPS_SPOOFING_STATE_ENUM_END: int
GPS_RAIM_STATE_UNKNOWN: int = 0
GPS_RAIM_STATE_DISABLED: int = 1
GPS_RAIM_STATE_OK: int = 2
GPS_RAIM_STATE_FAILED: int = 3
GPS_RAIM_STATE_ENUM_END: int
RANGING_BEACON_ALT_TYPE_WGS84: int = 0
RANGING_BEACON_ALT_TYPE_MSL: int = 1
RANGING_BEACON_ALT_TYPE_ENUM_END: int
RANGING_BEACON_STATUS_FLAG_STATION_SIGNAL_POOR: int = 1
RANGING_BEACON_STATUS_FLAG_ENUM_END: int

class MAVLink_mission_checksum_message(_dialect.MAVLink_message):  # 53
    mission_type: int  # MAV_MISSION_TYPE
    checksum: int
    def __init__(self, mission_type: int, checksum: int) -> None: ...

class MAVLink_radio_rc_channels_message(_dialect.MAVLink_message):  # 420
    target_system: int
    target_component: int
    time_last_update_ms: int  # ms
    flags: int  # RADIO_RC_CHANNELS_FLAGS
    count: int
    channels: list[int]
    def __init__(self, target_system: int, target_component: int, time_last_update_ms: int, flags: int,
        count: int, channels: _Sequence[int] = ...) -> None: ...

class MAVLink_available_modes_message(_dialect.MAVLink_message):  # 435
    number_modes: int
    mode_index: int
    standard_mode: int  # MAV_STANDARD_MODE
    custom_mode: int
    properties: int  # MAV_MODE_PROPERTY
    mode_name: str
    _mode_name_raw: bytes
    def __init__(self, number_modes: int, mode_index: int, standard_mode: int, custom_mode: int,
        properties: int, mode_name: bytes) -> None: ...

class MAVLink_current_mode_message(_dialect.MAVLink_message):  # 436
    standard_mode: int  # MAV_STANDARD_MODE
    custom_mode: int
    intended_custom_mode: int
    def __init__(self, standard_mode: int, custom_mode: int, intended_custom_mode: int) -> None: ...

class MAVLink_available_modes_monitor_message(_dialect.MAVLink_message):  # 437
    seq: int
    def __init__(self, seq: int) -> None: ...

class MAVLink_gnss_integrity_message(_dialect.MAVLink_message):  # 441
    id: int
    system_errors: int  # GPS_SYSTEM_ERROR_FLAGS
    authentication_state: int  # GPS_AUTHENTICATION_STATE
    jamming_state: int  # GPS_JAMMING_STATE
    spoofing_state: int  # GPS_SPOOFING_STATE
    raim_state: int  # GPS_RAIM_STATE
    raim_hfom: int  # cm
    raim_vfom: int  # cm
    corrections_quality: int
    system_status_summary: int
    gnss_signal_quality: int
    post_processing_quality: int
    def __init__(self, id: int, system_errors: int, authentication_state: int, jamming_state: int,
        spoofing_state: int, raim_state: int, raim_hfom: int, raim_vfom: int, corrections_quality: int,
        system_status_summary: int, gnss_signal_quality: int, post_processing_quality: int) -> None: ...

class MAVLink_ranging_beacon_message(_dialect.MAVLink_message):  # 513
    time_usec: int  # us
    target_system: int
    target_component: int
    beacon_id: int
    range: int  # mm
    lat: int  # degE7
    lon: int  # degE7
    alt: float  # m
    alt_type: int  # RANGING_BEACON_ALT_TYPE
    hacc_est: int  # mm
    vacc_est: int  # mm
    carrier_freq: int  # MHz
    range_accuracy: int  # mm
    sequence: int
    status: int  # RANGING_BEACON_STATUS_FLAG
    def __init__(self, time_usec: int, target_system: int, target_component: int, beacon_id: int, range: int,
        lat: int, lon: int, alt: float, alt_type: int, hacc_est: int, vacc_est: int, carrier_freq: int,
        range_accuracy: int, sequence: int, status: int) -> None: ...

class _Methods:
    def mission_checksum_encode(self, mission_type: int,
        checksum: int) -> MAVLink_mission_checksum_message: ...
    def mission_checksum_send(self, mission_type: int, checksum: int,
        force_mavlink1: bool = False) -> None: ...
    def radio_rc_channels_encode(self, target_system: int, target_component: int, time_last_update_ms: int,
        flags: int, count: int, channels: _Sequence[int] = ...) -> MAVLink_radio_rc_channels_message: ...
    def radio_rc_channels_send(self, target_system: int, target_component: int, time_last_update_ms: int,
        flags: int, count: int, channels: _Sequence[int] = ..., force_mavlink1: bool = False) -> None: ...
    def available_modes_encode(self, number_modes: int, mode_index: int, standard_mode: int, custom_mode: int,
        properties: int, mode_name: bytes) -> MAVLink_available_modes_message: ...
    def available_modes_send(self, number_modes: int, mode_index: int, standard_mode: int, custom_mode: int,
        properties: int, mode_name: bytes, force_mavlink1: bool = False) -> None: ...
    def current_mode_encode(self, standard_mode: int, custom_mode: int,
        intended_custom_mode: int) -> MAVLink_current_mode_message: ...
    def current_mode_send(self, standard_mode: int, custom_mode: int, intended_custom_mode: int,
        force_mavlink1: bool = False) -> None: ...
    def available_modes_monitor_encode(self, seq: int) -> MAVLink_available_modes_monitor_message: ...
    def available_modes_monitor_send(self, seq: int, force_mavlink1: bool = False) -> None: ...
    def gnss_integrity_encode(self, id: int, system_errors: int, authentication_state: int,
        jamming_state: int, spoofing_state: int, raim_state: int, raim_hfom: int, raim_vfom: int,
        corrections_quality: int, system_status_summary: int, gnss_signal_quality: int,
        post_processing_quality: int) -> MAVLink_gnss_integrity_message: ...
    def gnss_integrity_send(self, id: int, system_errors: int, authentication_state: int, jamming_state: int,
        spoofing_state: int, raim_state: int, raim_hfom: int, raim_vfom: int, corrections_quality: int,
        system_status_summary: int, gnss_signal_quality: int, post_processing_quality: int,
        force_mavlink1: bool = False) -> None: ...
    def ranging_beacon_encode(self, time_usec: int, target_system: int, target_component: int, beacon_id: int,
        range: int, lat: int, lon: int, alt: float, alt_type: int, hacc_est: int, vacc_est: int,
        carrier_freq: int, range_accuracy: int, sequence: int,
        status: int) -> MAVLink_ranging_beacon_message: ...
    def ranging_beacon_send(self, time_usec: int, target_system: int, target_component: int, beacon_id: int,
        range: int, lat: int, lon: int, alt: float, alt_type: int, hacc_est: int, vacc_est: int,
        carrier_freq: int, range_accuracy: int, sequence: int, status: int,
        force_mavlink1: bool = False) -> None: ...
