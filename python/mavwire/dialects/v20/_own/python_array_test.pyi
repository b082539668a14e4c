"""What dialect python_array_test itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_ARRAY_TEST_0: int = 17150
MAVLINK_MSG_ID_ARRAY_TEST_1: int = 17151
MAVLINK_MSG_ID_ARRAY_TEST_3: int = 17153
MAVLINK_MSG_ID_ARRAY_TEST_4: int = 17154
MAVLINK_MSG_ID_ARRAY_TEST_5: int = 17155
MAVLINK_MSG_ID_ARRAY_TEST_6: int = 17156
MAVLINK_MSG_ID_ARRAY_TEST_7: int = 17157
MAVLINK_MSG_ID_ARRAY_TEST_8: int = 17158

class MAVLink_array_test_0_message(_dialect.MAVLink_message):  # 17150
    v1: int
    ar_i8: list[int]
    ar_u8: list[int]
    ar_u16: list[int]
    ar_u32: list[int]
    def __init__(self, v1: int, ar_i8: _Sequence[int], ar_u8: _Sequence[int], ar_u16: _Sequence[int],
        ar_u32: _Sequence[int]) -> None: ...

class MAVLink_array_test_1_message(_dialect.MAVLink_message):  # 17151
    ar_u32: list[int]
    def __init__(self, ar_u32: _Sequence[int]) -> None: ...

class MAVLink_array_test_3_message(_dialect.MAVLink_message):  # 17153
    v: int
    ar_u32: list[int]
    def __init__(self, v: int, ar_u32: _Sequence[int]) -> None: ...

class MAVLink_array_test_4_message(_dialect.MAVLink_message):  # 17154
    ar_u32: list[int]
    v: int
    def __init__(self, ar_u32: _Sequence[int], v: int) -> None: ...

class MAVLink_array_test_5_message(_dialect.MAVLink_message):  # 17155
    c1: str
    _c1_raw: bytes
    c2: str
    _c2_raw: bytes
    def __init__(self, c1: bytes, c2: bytes) -> None: ...

class MAVLink_array_test_6_message(_dialect.MAVLink_message):  # 17156
    v1: int
    v2: int
    v3: int
    ar_u32: list[int]
    ar_i32: list[int]
    ar_u16: list[int]
    ar_i16: list[int]
    ar_u8: list[int]
    ar_i8: list[int]
    ar_c: str
    _ar_c_raw: bytes
    ar_d: list[float]
    ar_f: list[float]
    def __init__(self, v1: int, v2: int, v3: int, ar_u32: _Sequence[int], ar_i32: _Sequence[int],
        ar_u16: _Sequence[int], ar_i16: _Sequence[int], ar_u8: _Sequence[int], ar_i8: _Sequence[int],
        ar_c: bytes, ar_d: _Sequence[float], ar_f: _Sequence[float]) -> None: ...

class MAVLink_array_test_7_message(_dialect.MAVLink_message):  # 17157
    ar_d: list[float]
    ar_f: list[float]
    ar_u32: list[int]
    ar_i32: list[int]
    ar_u16: list[int]
    ar_i16: list[int]
    ar_u8: list[int]
    ar_i8: list[int]
    ar_c: str
    _ar_c_raw: bytes
    def __init__(self, ar_d: _Sequence[float], ar_f: _Sequence[float], ar_u32: _Sequence[int],
        ar_i32: _Sequence[int], ar_u16: _Sequence[int], ar_i16: _Sequence[int], ar_u8: _Sequence[int],
        ar_i8: _Sequence[int], ar_c: bytes) -> None: ...

class MAVLink_array_test_8_message(_dialect.MAVLink_message):  # 17158
    v3: int
    ar_d: list[float]
    ar_u16: list[int]
    def __init__(self, v3: int, ar_d: _Sequence[float], ar_u16: _Sequence[int]) -> None: ...

class _Methods:
    def array_test_0_encode(self, v1: int, ar_i8: _Sequence[int], ar_u8: _Sequence[int],
        ar_u16: _Sequence[int], ar_u32: _Sequence[int]) -> MAVLink_array_test_0_message: ...
    def array_test_0_send(self, v1: int, ar_i8: _Sequence[int], ar_u8: _Sequence[int], ar_u16: _Sequence[int],
        ar_u32: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def array_test_1_encode(self, ar_u32: _Sequence[int]) -> MAVLink_array_test_1_message: ...
    def array_test_1_send(self, ar_u32: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def array_test_3_encode(self, v: int, ar_u32: _Sequence[int]) -> MAVLink_array_test_3_message: ...
    def array_test_3_send(self, v: int, ar_u32: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def array_test_4_encode(self, ar_u32: _Sequence[int], v: int) -> MAVLink_array_test_4_message: ...
    def array_test_4_send(self, ar_u32: _Sequence[int], v: int, force_mavlink1: bool = False) -> None: ...
    def array_test_5_encode(self, c1: bytes, c2: bytes) -> MAVLink_array_test_5_message: ...
    def array_test_5_send(self, c1: bytes, c2: bytes, force_mavlink1: bool = False) -> None: ...
    def array_test_6_encode(self, v1: int, v2: int, v3: int, ar_u32: _Sequence[int], ar_i32: _Sequence[int],
        ar_u16: _Sequence[int], ar_i16: _Sequence[int], ar_u8: _Sequence[int], ar_i8: _Sequence[int],
        ar_c: bytes, ar_d: _Sequence[float], ar_f: _Sequence[float]) -> MAVLink_array_test_6_message: ...
    def array_test_6_send(self, v1: int, v2: int, v3: int, ar_u32: _Sequence[int], ar_i32: _Sequence[int],
        ar_u16: _Sequence[int], ar_i16: _Sequence[int], ar_u8: _Sequence[int], ar_i8: _Sequence[int],
        ar_c: bytes, ar_d: _Sequence[float], ar_f: _Sequence[float],
        force_mavlink1: bool = False) -> None: ...
    def array_test_7_encode(self, ar_d: _Sequence[float], ar_f: _Sequence[float], ar_u32: _Sequence[int],
        ar_i32: _Sequence[int], ar_u16: _Sequence[int], ar_i16: _Sequence[int], ar_u8: _Sequence[int],
        ar_i8: _Sequence[int], ar_c: bytes) -> MAVLink_array_test_7_message: ...
    def array_test_7_send(self, ar_d: _Sequence[float], ar_f: _Sequence[float], ar_u32: _Sequence[int],
        ar_i32: _Sequence[int], ar_u16: _Sequence[int], ar_i16: _Sequence[int], ar_u8: _Sequence[int],
        ar_i8: _Sequence[int], ar_c: bytes, force_mavlink1: bool = False) -> None: ...
    def array_test_8_encode(self, v3: int, ar_d: _Sequence[float],
        ar_u16: _Sequence[int]) -> MAVLink_array_test_8_message: ...
    def array_test_8_send(self, v3: int, ar_d: _Sequence[float], ar_u16: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
