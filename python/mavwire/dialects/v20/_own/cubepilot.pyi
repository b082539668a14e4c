"""What dialect cubepilot itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_CUBEPILOT_RAW_RC: int = 50001
MAVLINK_MSG_ID_HERELINK_VIDEO_STREAM_INFORMATION: int = 50002
MAVLINK_MSG_ID_HERELINK_TELEM: int = 50003
MAVLINK_MSG_ID_CUBEPILOT_FIRMWARE_UPDATE_START: int = 50004
MAVLINK_MSG_ID_CUBEPILOT_FIRMWARE_UPDATE_RESP: int = 50005

class MAVLink_cubepilot_raw_rc_message(_dialect.MAVLink_message):  # 50001
    rc_raw: list[int]
    def __init__(self, rc_raw: _Sequence[int]) -> None: ...

class MAVLink_herelink_video_stream_information_message(_dialect.MAVLink_message):  # 50002
    camera_id: int
    status: int
    framerate: float  # Hz
    resolution_h: int  # pix
    resolution_v: int  # pix
    bitrate: int  # bits/s
    rotation: int  # deg
    uri: str
    _uri_raw: bytes
    def __init__(self, camera_id: int, status: int, framerate: float, resolution_h: int, resolution_v: int,
        bitrate: int, rotation: int, uri: bytes) -> None: ...

class MAVLink_herelink_telem_message(_dialect.MAVLink_message):  # 50003
    rssi: int
    snr: int
    rf_freq: int
    link_bw: int
    link_rate: int
    cpu_temp: int
    board_temp: int
    def __init__(self, rssi: int, snr: int, rf_freq: int, link_bw: int, link_rate: int, cpu_temp: int,
        board_temp: int) -> None: ...

class MAVLink_cubepilot_firmware_update_start_message(_dialect.MAVLink_message):  # 50004
    target_system: int
    target_component: int
    size: int  # bytes
    crc: int
    def __init__(self, target_system: int, target_component: int, size: int, crc: int) -> None: ...

class MAVLink_cubepilot_firmware_update_resp_message(_dialect.MAVLink_message):  # 50005
    target_system: int
    target_component: int
    offset: int  # bytes
    def __init__(self, target_system: int, target_component: int, offset: int) -> None: ...

class _Methods:
    def cubepilot_raw_rc_encode(self, rc_raw: _Sequence[int]) -> MAVLink_cubepilot_raw_rc_message: ...
    def cubepilot_raw_rc_send(self, rc_raw: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def herelink_video_stream_information_encode(self, camera_id: int, status: int, framerate: float,
        resolution_h: int, resolution_v: int, bitrate: int, rotation: int,
        uri: bytes) -> MAVLink_herelink_video_stream_information_message: ...
    def herelink_video_stream_information_send(self, camera_id: int, status: int, framerate: float,
        resolution_h: int, resolution_v: int, bitrate: int, rotation: int, uri: bytes,
        force_mavlink1: bool = False) -> None: ...
    def herelink_telem_encode(self, rssi: int, snr: int, rf_freq: int, link_bw: int, link_rate: int,
        cpu_temp: int, board_temp: int) -> MAVLink_herelink_telem_message: ...
    def herelink_telem_send(self, rssi: int, snr: int, rf_freq: int, link_bw: int, link_rate: int,
        cpu_temp: int, board_temp: int, force_mavlink1: bool = False) -> None: ...
    def cubepilot_firmware_update_start_encode(self, target_system: int, target_component: int, size: int,
        crc: int) -> MAVLink_cubepilot_firmware_update_start_message: ...
    def cubepilot_firmware_update_start_send(self, target_system: int, target_component: int, size: int,
        crc: int, force_mavlink1: bool = False) -> None: ...
    def cubepilot_firmware_update_resp_encode(self, target_system: int, target_component: int,
        offset: int) -> MAVLink_cubepilot_firmware_update_resp_message: ...
    def cubepilot_firmware_update_resp_send(self, target_system: int, target_component: int, offset: int,
        force_mavlink1: bool = False) -> None: ...
