"""What dialect stemstudios itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_LED_STRIP_CONFIG: int = 52600
MAVLINK_MSG_ID_LED_STRIP_STATE: int = 52601
LED_CONFIG_MODE_ALL: int = 0
LED_CONFIG_MODE_INDEX: int = 1
LED_CONFIG_MODE_FOLLOW_FLIGHT_MODE: int = 2
LED_CONFIG_MODE_CLEAR: int = 3
LED_CONFIG_MODE_ENUM_END: int

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
    def led_strip_config_encode(self, target_system: int, target_component: int, mode: int, index: int,
        length: int, id: int, colors: _Sequence[int]) -> MAVLink_led_strip_config_message: ...
    def led_strip_config_send(self, target_system: int, target_component: int, mode: int, index: int,
        length: int, id: int, colors: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def led_strip_state_encode(self, length: int, index: int, id: int, following_flight_mode: int,
        colors: _Sequence[int]) -> MAVLink_led_strip_state_message: ...
    def led_strip_state_send(self, length: int, index: int, id: int, following_flight_mode: int,
        colors: _Sequence[int], force_mavlink1: bool = False) -> None: ...
