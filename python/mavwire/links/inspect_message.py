"""Messages explained for people: bitmasks bit by bit, enums by name, values in readable units."""

from __future__ import annotations

import math
import time

from . import state
from .signing import shown

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TextIO

# Unit on the wire -> what to divide by, and the unit that people read.
dump_message_unit_decoder: dict[str, list[Any]] = {
    "d%": [10.0, "%"],
    "c%": [100.0, "%"],
    "cA": [100.0, "A"],
    "cdegC": [100.0, "degC"],
    "cdeg": [100.0, "deg"],
    "degE5": [1.0e5, "deg"],
    "degE7": [1.0e7, "deg"],
    "mG": [1000.0, "G"],
    "mrad/s": [1000.0, "rad/s"],
    "mV": [1000.0, "V"],
}

# A time in microseconds beyond this counts from 1970, not from boot: 2^50 us is 35 years.
MIN_UNIX_MICROSECONDS = 1 << 50
MICROSECONDS = 1_000_000
BITS = 64


class EnumBitInfo:
    """One bit of a bitmask: `offset` from bit 0, `value` as bool, `name` or None."""

    def __init__(self, offset: int, value: bool, name: str | None) -> None:
        self.offset = offset
        self.value = value
        self.name = name


def decode_bitmask(messagetype: str, field: str, value: int) -> list[EnumBitInfo]:
    """The bits of a bitmask field of the current dialect: every named bit and every set one.

    AttributeError or ValueError says what is missing when the field is not a known bitmask.
    """
    mavlink = state.mavlink
    message_class = getattr(mavlink, f"MAVLink_{messagetype.lower()}_message", None)
    if message_class is None:
        raise AttributeError("No such message type")
    return _decode_bits(message_class, mavlink.enums, field, value)


def _decode_bits(message_class: Any, enums: Any, field: str, value: int) -> list[EnumBitInfo]:
    display = message_class.fielddisplays_by_name.get(field)
    if display is None:
        raise AttributeError("Not a bitmask field (none specified)")
    if display != "bitmask":
        raise ValueError("Not a bitmask field")
    enum_name = message_class.fieldenums_by_name.get(field)
    if enum_name is None:
        raise AttributeError("No enum found for bitmask field")
    enum = enums.get(enum_name)
    if enum is None:
        raise AttributeError(f"Did not find specified enumeration ({enum_name})")
    bits = []
    for offset in range(BITS):
        entry = enum.get(1 << offset)
        if entry is None and not value >> offset:
            continue
        name = None if entry is None else entry.name
        bits.append(EnumBitInfo(offset, bool(value >> offset & 1), name))
    return bits


def dump_message_verbose(f: TextIO, m: Any) -> None:
    """Write `m` to `f` with one line per field, and one per bit of a bitmask."""
    stamp = getattr(m, "_timestamp", None)
    if stamp is not None:
        f.write(f"{local_stamp(stamp)}: ")
    signed = f"Yes; out-link={m.get_link_id()}" if m.get_signed() else "No"
    f.write(
        f"{m.get_type()} (id={m.get_header().msgId}) (seq={m.get_seq()})"
        f" (src={m.get_srcSystem()}/{m.get_srcComponent()})"
        f" (in-link={getattr(m, '_link', None)}) (signed={signed})\n"
    )
    for field in m.get_fieldnames():
        f.write(f"    {field}: {_field_text(m, field)}\n")


def _field_text(m: Any, field: str) -> str:
    value = shown(field, m.format_attr(field))
    if m.fielddisplays_by_name.get(field) == "bitmask":
        return _bitmask_text(m, field, value)
    enum_name = m.fieldenums_by_name.get(field)
    if enum_name is not None and not isinstance(value, (list, tuple)):
        entry = state.mavlink.enums.get(enum_name, {}).get(value)
        return f"{value} ({'[UNKNOWN]' if entry is None else entry.name})"
    return _unit_text(value, m.fieldunits_by_name.get(field))


def _bitmask_text(m: Any, field: str, value: int) -> str:
    lines = [f"0x{value:x} ({value})"]
    try:
        bits = _decode_bits(type(m), state.mavlink.enums, field, value)
    except (AttributeError, ValueError):
        bits = []
    for bit in bits:
        name = "[UNKNOWN]" if bit.name is None else bit.name
        lines.append(f"{'       ' if bit.value else '      !'} {name}")
    return "\n".join(lines)


def _unit_text(value: Any, unit: str | None) -> str:
    """A value in readable units; angles also in degrees, times also in seconds or as a date."""
    if unit is not None and unit in dump_message_unit_decoder:
        divisor, unit = dump_message_unit_decoder[unit]
        value = [v / divisor for v in value] if isinstance(value, list) else value / divisor
    if unit is None:
        return f"{value}"
    return f"{value}{unit}{_converted(value, unit)}"


def _converted(value: Any, unit: str) -> str:
    if isinstance(value, (list, tuple)):
        return ""
    if unit == "rad":
        return f" ({math.degrees(value)}deg)"
    if unit == "rad/s":
        return f" ({math.degrees(value)}deg/s)"
    if unit == "us" and value > MIN_UNIX_MICROSECONDS:
        seconds, microseconds = divmod(value, MICROSECONDS)
        return f" ({local_time(seconds)}.{microseconds:06d} {_written('%Z', seconds) or 'UTC'})"
    if unit == "us" and value > MICROSECONDS:
        return f" ({value / MICROSECONDS}s)"
    return ""


def local_time(unix_seconds: float) -> str:
    """The time of the local clock for seconds since 1970."""
    return _written("%Y-%m-%d %H:%M:%S", unix_seconds) or f"{unix_seconds:.0f}s"


def local_stamp(unix_seconds: float) -> str:
    """The same with hundredths of a second."""
    return f"{local_time(unix_seconds)}.{int(unix_seconds * 100.0) % 100:02d}"


def _written(form: str, unix_seconds: float) -> str:
    """A local time; empty beyond the range of the platform's calendar."""
    try:
        return time.strftime(form, time.localtime(unix_seconds))
    except (OverflowError, OSError, ValueError):
        return ""
