"""What dialect storm32 itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_STORM32_GIMBAL_MANAGER_INFORMATION: int = 60010
MAVLINK_MSG_ID_STORM32_GIMBAL_MANAGER_STATUS: int = 60011
MAVLINK_MSG_ID_STORM32_GIMBAL_MANAGER_CONTROL: int = 60012
MAVLINK_MSG_ID_STORM32_GIMBAL_MANAGER_CONTROL_PITCHYAW: int = 60013
MAVLINK_MSG_ID_STORM32_GIMBAL_MANAGER_CORRECT_ROLL: int = 60014
MAVLINK_MSG_ID_QSHOT_STATUS: int = 60020
MAVLINK_MSG_ID_AUTOPILOT_STATE_FOR_GIMBAL_DEVICE_EXT: int = 60000
MAVLINK_MSG_ID_FRSKY_PASSTHROUGH_ARRAY: int = 60040
MAVLINK_MSG_ID_PARAM_VALUE_ARRAY: int = 60041
MAVLINK_MSG_ID_MLRS_RADIO_LINK_STATS: int = 60045
MAVLINK_MSG_ID_MLRS_RADIO_LINK_INFORMATION: int = 60046
MAVLINK_MSG_ID_MLRS_RADIO_LINK_FLOW_CONTROL: int = 60047
MAV_STORM32_TUNNEL_PAYLOAD_TYPE_STORM32_CH1_IN: int = 200
MAV_STORM32_TUNNEL_PAYLOAD_TYPE_STORM32_CH1_OUT: int = 201
MAV_STORM32_TUNNEL_PAYLOAD_TYPE_STORM32_CH2_IN: int = 202
MAV_STORM32_TUNNEL_PAYLOAD_TYPE_STORM32_CH2_OUT: int = 203
MAV_STORM32_TUNNEL_PAYLOAD_TYPE_STORM32_CH3_IN: int = 204
MAV_STORM32_TUNNEL_PAYLOAD_TYPE_STORM32_CH3_OUT: int = 205
MAV_STORM32_TUNNEL_PAYLOAD_TYPE_ENUM_END: int
MAV_STORM32_GIMBAL_MANAGER_CAP_FLAGS_HAS_PROFILES: int = 1
MAV_STORM32_GIMBAL_MANAGER_CAP_FLAGS_ENUM_END: int
MAV_STORM32_GIMBAL_MANAGER_FLAGS_RC_ACTIVE: int = 1
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_ONBOARD_ACTIVE: int = 2
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_AUTOPILOT_ACTIVE: int = 4
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_GCS_ACTIVE: int = 8
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_CAMERA_ACTIVE: int = 16
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_GCS2_ACTIVE: int = 32
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_CAMERA2_ACTIVE: int = 64
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_CUSTOM_ACTIVE: int = 128
MAV_STORM32_GIMBAL_MANAGER_FLAGS_CLIENT_CUSTOM2_ACTIVE: int = 256
MAV_STORM32_GIMBAL_MANAGER_FLAGS_SET_SUPERVISON: int = 512
MAV_STORM32_GIMBAL_MANAGER_FLAGS_SET_RELEASE: int = 1024
MAV_STORM32_GIMBAL_MANAGER_FLAGS_ENUM_END: int
MAV_STORM32_GIMBAL_MANAGER_CLIENT_NONE: int = 0
MAV_STORM32_GIMBAL_MANAGER_CLIENT_ONBOARD: int = 1
MAV_STORM32_GIMBAL_MANAGER_CLIENT_AUTOPILOT: int = 2
MAV_STORM32_GIMBAL_MANAGER_CLIENT_GCS: int = 3
MAV_STORM32_GIMBAL_MANAGER_CLIENT_CAMERA: int = 4
MAV_STORM32_GIMBAL_MANAGER_CLIENT_GCS2: int = 5
MAV_STORM32_GIMBAL_MANAGER_CLIENT_CAMERA2: int = 6
MAV_STORM32_GIMBAL_MANAGER_CLIENT_CUSTOM: int = 7
MAV_STORM32_GIMBAL_MANAGER_CLIENT_CUSTOM2: int = 8
MAV_STORM32_GIMBAL_MANAGER_CLIENT_ENUM_END: int
MAV_STORM32_GIMBAL_MANAGER_PROFILE_DEFAULT: int = 0
MAV_STORM32_GIMBAL_MANAGER_PROFILE_CUSTOM: int = 1
MAV_STORM32_GIMBAL_MANAGER_PROFILE_COOPERATIVE: int = 2
MAV_STORM32_GIMBAL_MANAGER_PROFILE_EXCLUSIVE: int = 3
MAV_STORM32_GIMBAL_MANAGER_PROFILE_PRIORITY_COOPERATIVE: int = 4
MAV_STORM32_GIMBAL_MANAGER_PROFILE_PRIORITY_EXCLUSIVE: int = 5
MAV_STORM32_GIMBAL_MANAGER_PROFILE_ENUM_END: int
MAV_QSHOT_MODE_UNDEFINED: int = 0
MAV_QSHOT_MODE_DEFAULT: int = 1
MAV_QSHOT_MODE_GIMBAL_RETRACT: int = 2
MAV_QSHOT_MODE_GIMBAL_NEUTRAL: int = 3
MAV_QSHOT_MODE_GIMBAL_MISSION: int = 4
MAV_QSHOT_MODE_GIMBAL_RC_CONTROL: int = 5
MAV_QSHOT_MODE_POI_TARGETING: int = 6
MAV_QSHOT_MODE_SYSID_TARGETING: int = 7
MAV_QSHOT_MODE_CABLECAM_2POINT: int = 8
MAV_QSHOT_MODE_HOME_TARGETING: int = 9
MAV_QSHOT_MODE_ENUM_END: int
MAV_CMD_STORM32_DO_GIMBAL_MANAGER_CONTROL_PITCHYAW: int = 60002
MAV_CMD_STORM32_DO_GIMBAL_MANAGER_SETUP: int = 60010
MAV_CMD_QSHOT_DO_CONFIGURE: int = 60020
MLRS_RADIO_LINK_STATS_FLAGS_RSSI_DBM: int = 1
MLRS_RADIO_LINK_STATS_FLAGS_RX_RECEIVE_ANTENNA2: int = 2
MLRS_RADIO_LINK_STATS_FLAGS_RX_TRANSMIT_ANTENNA1: int = 4
MLRS_RADIO_LINK_STATS_FLAGS_RX_TRANSMIT_ANTENNA2: int = 8
MLRS_RADIO_LINK_STATS_FLAGS_TX_RECEIVE_ANTENNA2: int = 16
MLRS_RADIO_LINK_STATS_FLAGS_TX_TRANSMIT_ANTENNA1: int = 32
MLRS_RADIO_LINK_STATS_FLAGS_TX_TRANSMIT_ANTENNA2: int = 64
MLRS_RADIO_LINK_STATS_FLAGS_ENUM_END: int
MLRS_RADIO_LINK_TYPE_GENERIC: int = 0
MLRS_RADIO_LINK_TYPE_HERELINK: int = 1
MLRS_RADIO_LINK_TYPE_DRAGONLINK: int = 2
MLRS_RADIO_LINK_TYPE_RFD900: int = 3
MLRS_RADIO_LINK_TYPE_CROSSFIRE: int = 4
MLRS_RADIO_LINK_TYPE_EXPRESSLRS: int = 5
MLRS_RADIO_LINK_TYPE_MLRS: int = 6
MLRS_RADIO_LINK_TYPE_ENUM_END: int

class MAVLink_storm32_gimbal_manager_information_message(_dialect.MAVLink_message):  # 60010
    gimbal_id: int
    device_cap_flags: int  # GIMBAL_DEVICE_CAP_FLAGS
    manager_cap_flags: int  # MAV_STORM32_GIMBAL_MANAGER_CAP_FLAGS
    roll_min: float  # rad
    roll_max: float  # rad
    pitch_min: float  # rad
    pitch_max: float  # rad
    yaw_min: float  # rad
    yaw_max: float  # rad
    def __init__(self, gimbal_id: int, device_cap_flags: int, manager_cap_flags: int, roll_min: float,
        roll_max: float, pitch_min: float, pitch_max: float, yaw_min: float, yaw_max: float) -> None: ...

class MAVLink_storm32_gimbal_manager_status_message(_dialect.MAVLink_message):  # 60011
    gimbal_id: int
    supervisor: int  # MAV_STORM32_GIMBAL_MANAGER_CLIENT
    device_flags: int  # GIMBAL_DEVICE_FLAGS
    manager_flags: int  # MAV_STORM32_GIMBAL_MANAGER_FLAGS
    profile: int  # MAV_STORM32_GIMBAL_MANAGER_PROFILE
    def __init__(self, gimbal_id: int, supervisor: int, device_flags: int, manager_flags: int,
        profile: int) -> None: ...

class MAVLink_storm32_gimbal_manager_control_message(_dialect.MAVLink_message):  # 60012
    target_system: int
    target_component: int
    gimbal_id: int
    client: int  # MAV_STORM32_GIMBAL_MANAGER_CLIENT
    device_flags: int  # GIMBAL_DEVICE_FLAGS
    manager_flags: int  # MAV_STORM32_GIMBAL_MANAGER_FLAGS
    q: list[float]
    angular_velocity_x: float  # rad/s
    angular_velocity_y: float  # rad/s
    angular_velocity_z: float  # rad/s
    def __init__(self, target_system: int, target_component: int, gimbal_id: int, client: int,
        device_flags: int, manager_flags: int, q: _Sequence[float], angular_velocity_x: float,
        angular_velocity_y: float, angular_velocity_z: float) -> None: ...

class MAVLink_storm32_gimbal_manager_control_pitchyaw_message(_dialect.MAVLink_message):  # 60013
    target_system: int
    target_component: int
    gimbal_id: int
    client: int  # MAV_STORM32_GIMBAL_MANAGER_CLIENT
    device_flags: int  # GIMBAL_DEVICE_FLAGS
    manager_flags: int  # MAV_STORM32_GIMBAL_MANAGER_FLAGS
    pitch: float  # rad
    yaw: float  # rad
    pitch_rate: float  # rad/s
    yaw_rate: float  # rad/s
    def __init__(self, target_system: int, target_component: int, gimbal_id: int, client: int,
        device_flags: int, manager_flags: int, pitch: float, yaw: float, pitch_rate: float,
        yaw_rate: float) -> None: ...

class MAVLink_storm32_gimbal_manager_correct_roll_message(_dialect.MAVLink_message):  # 60014
    target_system: int
    target_component: int
    gimbal_id: int
    client: int  # MAV_STORM32_GIMBAL_MANAGER_CLIENT
    roll: float  # rad
    def __init__(self, target_system: int, target_component: int, gimbal_id: int, client: int,
        roll: float) -> None: ...

class MAVLink_qshot_status_message(_dialect.MAVLink_message):  # 60020
    mode: int  # MAV_QSHOT_MODE
    shot_state: int
    def __init__(self, mode: int, shot_state: int) -> None: ...

class MAVLink_autopilot_state_for_gimbal_device_ext_message(_dialect.MAVLink_message):  # 60000
    target_system: int
    target_component: int
    time_boot_us: int  # us
    wind_x: float  # m/s
    wind_y: float  # m/s
    wind_correction_angle: float  # rad
    def __init__(self, target_system: int, target_component: int, time_boot_us: int, wind_x: float,
        wind_y: float, wind_correction_angle: float) -> None: ...

class MAVLink_frsky_passthrough_array_message(_dialect.MAVLink_message):  # 60040
    time_boot_ms: int  # ms
    count: int
    packet_buf: list[int]
    def __init__(self, time_boot_ms: int, count: int, packet_buf: _Sequence[int]) -> None: ...

class MAVLink_param_value_array_message(_dialect.MAVLink_message):  # 60041
    param_count: int
    param_index_first: int
    param_array_len: int
    flags: int
    packet_buf: list[int]
    def __init__(self, param_count: int, param_index_first: int, param_array_len: int, flags: int,
        packet_buf: _Sequence[int]) -> None: ...

class MAVLink_mlrs_radio_link_stats_message(_dialect.MAVLink_message):  # 60045
    target_system: int
    target_component: int
    flags: int  # MLRS_RADIO_LINK_STATS_FLAGS
    rx_LQ_rc: int  # c%
    rx_LQ_ser: int  # c%
    rx_rssi1: int
    rx_snr1: int
    tx_LQ_ser: int  # c%
    tx_rssi1: int
    tx_snr1: int
    rx_rssi2: int
    rx_snr2: int
    tx_rssi2: int
    tx_snr2: int
    frequency1: float  # Hz
    frequency2: float  # Hz
    def __init__(self, target_system: int, target_component: int, flags: int, rx_LQ_rc: int, rx_LQ_ser: int,
        rx_rssi1: int, rx_snr1: int, tx_LQ_ser: int, tx_rssi1: int, tx_snr1: int, rx_rssi2: int, rx_snr2: int,
        tx_rssi2: int, tx_snr2: int, frequency1: float = 0, frequency2: float = 0) -> None: ...

class MAVLink_mlrs_radio_link_information_message(_dialect.MAVLink_message):  # 60046
    target_system: int
    target_component: int
    type: int  # MLRS_RADIO_LINK_TYPE
    mode: int
    tx_power: int  # dBm
    rx_power: int  # dBm
    tx_frame_rate: int  # Hz
    rx_frame_rate: int  # Hz
    mode_str: str
    _mode_str_raw: bytes
    band_str: str
    _band_str_raw: bytes
    tx_ser_data_rate: int
    rx_ser_data_rate: int
    tx_receive_sensitivity: int
    rx_receive_sensitivity: int
    def __init__(self, target_system: int, target_component: int, type: int, mode: int, tx_power: int,
        rx_power: int, tx_frame_rate: int, rx_frame_rate: int, mode_str: bytes, band_str: bytes,
        tx_ser_data_rate: int, rx_ser_data_rate: int, tx_receive_sensitivity: int,
        rx_receive_sensitivity: int) -> None: ...

class MAVLink_mlrs_radio_link_flow_control_message(_dialect.MAVLink_message):  # 60047
    tx_ser_rate: int  # bytes/s
    rx_ser_rate: int  # bytes/s
    tx_used_ser_bandwidth: int  # c%
    rx_used_ser_bandwidth: int  # c%
    txbuf: int  # c%
    def __init__(self, tx_ser_rate: int, rx_ser_rate: int, tx_used_ser_bandwidth: int,
        rx_used_ser_bandwidth: int, txbuf: int) -> None: ...

class _Methods:
    def storm32_gimbal_manager_information_encode(self, gimbal_id: int, device_cap_flags: int,
        manager_cap_flags: int, roll_min: float, roll_max: float, pitch_min: float, pitch_max: float,
        yaw_min: float, yaw_max: float) -> MAVLink_storm32_gimbal_manager_information_message: ...
    def storm32_gimbal_manager_information_send(self, gimbal_id: int, device_cap_flags: int,
        manager_cap_flags: int, roll_min: float, roll_max: float, pitch_min: float, pitch_max: float,
        yaw_min: float, yaw_max: float, force_mavlink1: bool = False) -> None: ...
    def storm32_gimbal_manager_status_encode(self, gimbal_id: int, supervisor: int, device_flags: int,
        manager_flags: int, profile: int) -> MAVLink_storm32_gimbal_manager_status_message: ...
    def storm32_gimbal_manager_status_send(self, gimbal_id: int, supervisor: int, device_flags: int,
        manager_flags: int, profile: int, force_mavlink1: bool = False) -> None: ...
    def storm32_gimbal_manager_control_encode(self, target_system: int, target_component: int, gimbal_id: int,
        client: int, device_flags: int, manager_flags: int, q: _Sequence[float], angular_velocity_x: float,
        angular_velocity_y: float,
        angular_velocity_z: float) -> MAVLink_storm32_gimbal_manager_control_message: ...
    def storm32_gimbal_manager_control_send(self, target_system: int, target_component: int, gimbal_id: int,
        client: int, device_flags: int, manager_flags: int, q: _Sequence[float], angular_velocity_x: float,
        angular_velocity_y: float, angular_velocity_z: float, force_mavlink1: bool = False) -> None: ...
    def storm32_gimbal_manager_control_pitchyaw_encode(self, target_system: int, target_component: int,
        gimbal_id: int, client: int, device_flags: int, manager_flags: int, pitch: float, yaw: float,
        pitch_rate: float, yaw_rate: float) -> MAVLink_storm32_gimbal_manager_control_pitchyaw_message: ...
    def storm32_gimbal_manager_control_pitchyaw_send(self, target_system: int, target_component: int,
        gimbal_id: int, client: int, device_flags: int, manager_flags: int, pitch: float, yaw: float,
        pitch_rate: float, yaw_rate: float, force_mavlink1: bool = False) -> None: ...
    def storm32_gimbal_manager_correct_roll_encode(self, target_system: int, target_component: int,
        gimbal_id: int, client: int, roll: float) -> MAVLink_storm32_gimbal_manager_correct_roll_message: ...
    def storm32_gimbal_manager_correct_roll_send(self, target_system: int, target_component: int,
        gimbal_id: int, client: int, roll: float, force_mavlink1: bool = False) -> None: ...
    def qshot_status_encode(self, mode: int, shot_state: int) -> MAVLink_qshot_status_message: ...
    def qshot_status_send(self, mode: int, shot_state: int, force_mavlink1: bool = False) -> None: ...
    def autopilot_state_for_gimbal_device_ext_encode(self, target_system: int, target_component: int,
        time_boot_us: int, wind_x: float, wind_y: float,
        wind_correction_angle: float) -> MAVLink_autopilot_state_for_gimbal_device_ext_message: ...
    def autopilot_state_for_gimbal_device_ext_send(self, target_system: int, target_component: int,
        time_boot_us: int, wind_x: float, wind_y: float, wind_correction_angle: float,
        force_mavlink1: bool = False) -> None: ...
    def frsky_passthrough_array_encode(self, time_boot_ms: int, count: int,
        packet_buf: _Sequence[int]) -> MAVLink_frsky_passthrough_array_message: ...
    def frsky_passthrough_array_send(self, time_boot_ms: int, count: int, packet_buf: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def param_value_array_encode(self, param_count: int, param_index_first: int, param_array_len: int,
        flags: int, packet_buf: _Sequence[int]) -> MAVLink_param_value_array_message: ...
    def param_value_array_send(self, param_count: int, param_index_first: int, param_array_len: int,
        flags: int, packet_buf: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def mlrs_radio_link_stats_encode(self, target_system: int, target_component: int, flags: int,
        rx_LQ_rc: int, rx_LQ_ser: int, rx_rssi1: int, rx_snr1: int, tx_LQ_ser: int, tx_rssi1: int,
        tx_snr1: int, rx_rssi2: int, rx_snr2: int, tx_rssi2: int, tx_snr2: int, frequency1: float = 0,
        frequency2: float = 0) -> MAVLink_mlrs_radio_link_stats_message: ...
    def mlrs_radio_link_stats_send(self, target_system: int, target_component: int, flags: int, rx_LQ_rc: int,
        rx_LQ_ser: int, rx_rssi1: int, rx_snr1: int, tx_LQ_ser: int, tx_rssi1: int, tx_snr1: int,
        rx_rssi2: int, rx_snr2: int, tx_rssi2: int, tx_snr2: int, frequency1: float = 0,
        frequency2: float = 0, force_mavlink1: bool = False) -> None: ...
    def mlrs_radio_link_information_encode(self, target_system: int, target_component: int, type: int,
        mode: int, tx_power: int, rx_power: int, tx_frame_rate: int, rx_frame_rate: int, mode_str: bytes,
        band_str: bytes, tx_ser_data_rate: int, rx_ser_data_rate: int, tx_receive_sensitivity: int,
        rx_receive_sensitivity: int) -> MAVLink_mlrs_radio_link_information_message: ...
    def mlrs_radio_link_information_send(self, target_system: int, target_component: int, type: int,
        mode: int, tx_power: int, rx_power: int, tx_frame_rate: int, rx_frame_rate: int, mode_str: bytes,
        band_str: bytes, tx_ser_data_rate: int, rx_ser_data_rate: int, tx_receive_sensitivity: int,
        rx_receive_sensitivity: int, force_mavlink1: bool = False) -> None: ...
    def mlrs_radio_link_flow_control_encode(self, tx_ser_rate: int, rx_ser_rate: int,
        tx_used_ser_bandwidth: int, rx_used_ser_bandwidth: int,
        txbuf: int) -> MAVLink_mlrs_radio_link_flow_control_message: ...
    def mlrs_radio_link_flow_control_send(self, tx_ser_rate: int, rx_ser_rate: int,
        tx_used_ser_bandwidth: int, rx_used_ser_bandwidth: int, txbuf: int,
        force_mavlink1: bool = False) -> None: ...
