"""The four bytes of a parameter's value, as they travel.

ArduPilot converts an integer to the float of the messages. PX4 copies its bytes into the float. The bytes of
some integers, -5,000,000 for one, are a signalling NaN. A processor changes it as soon as it makes a double
of it. So the bytes are taken from the frame here, and put into it.
"""

from __future__ import annotations

import math
import struct

from . import Any

# MAV_PARAM_TYPE of the integers -> their layout, filled up to the four bytes of a float.
INTEGERS = {1: "<B3x", 2: "<b3x", 3: "<H2x", 4: "<h2x", 5: "<I", 6: "<i"}

# First byte of a frame -> where its payload begins.
_HEADER_LENGTHS = {0xFE: 6, 0xFD: 10}


def value_bytes(msg: Any) -> bytes:
    """The bytes of `param_value` of a PARAM_VALUE or PARAM_SET."""
    if math.isnan(msg.param_value):  # a double holds every other float
        frame = bytes(msg.get_msgbuf())
        if frame:
            return _payload(frame)[:4]
    return struct.pack("<f", msg.param_value)


def decoded(msg: Any, bytewise: bool) -> float:
    """The value of a PARAM_VALUE."""
    layout = INTEGERS.get(msg.param_type)
    if layout is not None and bytewise:
        value: int = struct.unpack(layout, value_bytes(msg))[0]
        return value
    number = float(msg.param_value)
    # A vehicle that copies bytes without our knowing sends what is no number.
    return int(number) if layout is not None and math.isfinite(number) else number


def encoded(value: float, param_type: int, bytewise: bool) -> bytes:
    """The four bytes that travel for a value. ValueError for one that the type cannot hold."""
    layout = INTEGERS.get(param_type)
    try:
        if layout is None:
            return struct.pack("<f", value)
        number = int(value)
        if number != value:
            raise ValueError("an integer is wanted")
        packed = struct.pack(layout, number)
    except (struct.error, OverflowError, ValueError) as error:
        raise ValueError(f"{value} does not fit a parameter of type {param_type}") from error
    return packed if bytewise else struct.pack("<f", number)


def with_value_bytes(msg: Any, data: bytes, mav_class: Any) -> Any:
    """A message like `msg`, a PARAM_VALUE or PARAM_SET that is to be sent, with `data` as its value.

    `mav_class` is the `MAVLink` class of its dialect.
    """
    (msg.param_value,) = struct.unpack("<f", data)
    if not math.isnan(msg.param_value):
        return msg
    mav = mav_class(None)
    payload = data + _payload(msg.pack(mav))[4:]
    # A received message is sent again with the bytes that it came with.
    return mav.decode(bytearray(msg._pack(mav, msg.crc_extra, payload)))


def _payload(frame: bytes) -> bytes:
    """The payload of a frame, which in both messages begins with the value."""
    start = _HEADER_LENGTHS[frame[0]]
    return frame[start : start + frame[1]]
