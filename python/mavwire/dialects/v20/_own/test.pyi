"""What dialect test itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_TEST_TYPES: int = 17000

class MAVLink_test_types_message(_dialect.MAVLink_message):  # 17000
    c: str
    _c_raw: bytes
    s: str
    _s_raw: bytes
    u8: int
    u16: int
    u32: int
    u64: int
    s8: int
    s16: int
    s32: int
    s64: int
    f: float
    d: float
    u8_array: list[int]
    u16_array: list[int]
    u32_array: list[int]
    u64_array: list[int]
    s8_array: list[int]
    s16_array: list[int]
    s32_array: list[int]
    s64_array: list[int]
    f_array: list[float]
    d_array: list[float]
    def __init__(self, c: bytes, s: bytes, u8: int, u16: int, u32: int, u64: int, s8: int, s16: int, s32: int,
        s64: int, f: float, d: float, u8_array: _Sequence[int], u16_array: _Sequence[int],
        u32_array: _Sequence[int], u64_array: _Sequence[int], s8_array: _Sequence[int],
        s16_array: _Sequence[int], s32_array: _Sequence[int], s64_array: _Sequence[int],
        f_array: _Sequence[float], d_array: _Sequence[float]) -> None: ...

class _Methods:
    def test_types_encode(self, c: bytes, s: bytes, u8: int, u16: int, u32: int, u64: int, s8: int, s16: int,
        s32: int, s64: int, f: float, d: float, u8_array: _Sequence[int], u16_array: _Sequence[int],
        u32_array: _Sequence[int], u64_array: _Sequence[int], s8_array: _Sequence[int],
        s16_array: _Sequence[int], s32_array: _Sequence[int], s64_array: _Sequence[int],
        f_array: _Sequence[float], d_array: _Sequence[float]) -> MAVLink_test_types_message: ...
    def test_types_send(self, c: bytes, s: bytes, u8: int, u16: int, u32: int, u64: int, s8: int, s16: int,
        s32: int, s64: int, f: float, d: float, u8_array: _Sequence[int], u16_array: _Sequence[int],
        u32_array: _Sequence[int], u64_array: _Sequence[int], s8_array: _Sequence[int],
        s16_array: _Sequence[int], s32_array: _Sequence[int], s64_array: _Sequence[int],
        f_array: _Sequence[float], d_array: _Sequence[float], force_mavlink1: bool = False) -> None: ...
