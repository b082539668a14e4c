"""What dialect paparazzi_replaced itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_SCRIPT_ITEM: int = 180
MAVLINK_MSG_ID_SCRIPT_REQUEST: int = 181
MAVLINK_MSG_ID_SCRIPT_REQUEST_LIST: int = 182
MAVLINK_MSG_ID_SCRIPT_COUNT: int = 183
MAVLINK_MSG_ID_SCRIPT_CURRENT: int = 184

class MAVLink_script_item_message(_dialect.MAVLink_message):  # 180
    target_system: int
    target_component: int
    seq: int
    name: str
    _name_raw: bytes
    def __init__(self, target_system: int, target_component: int, seq: int, name: bytes) -> None: ...

class MAVLink_script_request_message(_dialect.MAVLink_message):  # 181
    target_system: int
    target_component: int
    seq: int
    def __init__(self, target_system: int, target_component: int, seq: int) -> None: ...

class MAVLink_script_request_list_message(_dialect.MAVLink_message):  # 182
    target_system: int
    target_component: int
    def __init__(self, target_system: int, target_component: int) -> None: ...

class MAVLink_script_count_message(_dialect.MAVLink_message):  # 183
    target_system: int
    target_component: int
    count: int
    def __init__(self, target_system: int, target_component: int, count: int) -> None: ...

class MAVLink_script_current_message(_dialect.MAVLink_message):  # 184
    seq: int
    def __init__(self, seq: int) -> None: ...

class _Methods:
    def script_item_encode(self, target_system: int, target_component: int, seq: int,
        name: bytes) -> MAVLink_script_item_message: ...
    def script_item_send(self, target_system: int, target_component: int, seq: int, name: bytes,
        force_mavlink1: bool = False) -> None: ...
    def script_request_encode(self, target_system: int, target_component: int,
        seq: int) -> MAVLink_script_request_message: ...
    def script_request_send(self, target_system: int, target_component: int, seq: int,
        force_mavlink1: bool = False) -> None: ...
    def script_request_list_encode(self, target_system: int,
        target_component: int) -> MAVLink_script_request_list_message: ...
    def script_request_list_send(self, target_system: int, target_component: int,
        force_mavlink1: bool = False) -> None: ...
    def script_count_encode(self, target_system: int, target_component: int,
        count: int) -> MAVLink_script_count_message: ...
    def script_count_send(self, target_system: int, target_component: int, count: int,
        force_mavlink1: bool = False) -> None: ...
    def script_current_encode(self, seq: int) -> MAVLink_script_current_message: ...
    def script_current_send(self, seq: int, force_mavlink1: bool = False) -> None: ...
