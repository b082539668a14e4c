"""Python methods of `DFMessage`: encoding changed messages, and showing them line by line."""

from __future__ import annotations

import math
import struct
import time
from array import array

from .formats import FORMAT_TO_STRUCT, is_quiet_nan

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TextIO

HEAD = b"\xa3\x95"


def get_msgbuf(message: Any) -> bytes | None:
    """The record of a message, encoded from `_elements`; None where a value does not fit.

    A column Mode, which may be the name of the mode, gets its number from the column ModeNum if
    there is one. ValueError where a value is no number.
    """
    fmt = message.fmt
    scaled = message._apply_multiplier
    has_number = "ModeNum" in fmt.colhash
    columns = zip(fmt.columns, message._elements, fmt.msg_fmts, strict=False)
    values = [
        message.ModeNum if column == "Mode" and has_number else _stored(element, character, scaled)
        for column, element, character in columns
    ]
    try:
        return HEAD + bytes([fmt.type]) + struct.pack(fmt.msg_struct, *values)
    except (struct.error, TypeError, OverflowError):
        return None


def _stored(element: Any, character: str, scaled: bool) -> Any:
    _, factor, kind = FORMAT_TO_STRUCT[character]
    if kind is str:
        if isinstance(element, array):
            return element.tobytes()
        return element.encode() if isinstance(element, str) else element
    if character == "M":
        return element
    if factor is None:
        return kind(element)
    return round(float(element)) if scaled else round(float(element) / factor)


def dump_verbose(message: Any, f: TextIO) -> None:
    """Write the time and the type of a message, and a line for each column."""
    stamp = message._timestamp
    milliseconds = int(stamp * 1000.0) % 1000
    local = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(stamp))
    f.write(f"{local}.{milliseconds:03d}: {message.get_type()}\n")
    fields = _documented_fields(message)
    for column in message.get_fieldnames():
        _dump_column(message, f, column, fields.get(column))


def _documented_fields(message: Any) -> dict[str, Any]:
    parent = message._parent
    tree = parent.metadata.metadata_tree() if parent is not None else None
    described = (tree or {}).get(message.get_type())
    if described is None:
        return {}
    return {field.get("name"): field for field in described.iter("field")}


def _dump_column(message: Any, f: TextIO, column: str, described: Any) -> None:
    value = getattr(message, column)
    unit = message.fmt.get_unit(column)
    note = _note(value, described)
    shown = "qnan" if is_quiet_nan(value) else value
    f.write(f"    {column}: {shown}{note} {unit}{_in_degrees(value, unit)}\n")
    if described is not None:
        message.dump_verbose_bitmask(f, column, value, described)


def _in_degrees(value: Any, unit: str) -> str:
    """An angle in radians, or a rate of one, in degrees too."""
    if not unit.startswith("rad") or not isinstance(value, int | float):
        return ""
    return f" ({math.degrees(value)} deg{unit.removeprefix('rad')})"


def _note(value: Any, described: Any) -> str:
    """The name of an enum's value, or a bitmask in hexadecimal digits, in brackets."""
    if described is None or not isinstance(value, int):
        return ""
    if described.find("bitmask") is not None:
        return f" (0x{value:x})"
    for element in described.iterfind("enum/element"):
        if element.findtext("value") == str(value):
            return f" ({element.get('name')})"
    return ""


def dump_verbose_bitmask(_message: Any, f: TextIO, _c: str, val: Any, field_metadata: Any) -> None:
    """Write a line for each bit that is set in `val` and described, after its name."""
    if field_metadata is None or not isinstance(val, int):
        return
    for bit in field_metadata.iterfind("bitmask/bit"):
        mask = int(bit.findtext("value") or "0", 0)
        if mask and val & mask:
            described = (bit.findtext("description") or "").strip()
            f.write(f"      {bit.get('name')}{': ' + described if described else ''}\n")
