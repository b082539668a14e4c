"""The parameter file of ArduPilot, @PARAM/param.pck, and the text files that it is saved to."""

from __future__ import annotations

import struct
import time
from typing import Any

from mavwire._atomic_file import replace_text

from . import log

MAGIC = 0x671B
MAGIC_WITH_DEFAULTS = 0x671C
MAX_NAME = 16
HEADER = struct.Struct("<HHH")
# Type of a value in the file -> its format.
VALUES = {
    1: struct.Struct("<b"),
    2: struct.Struct("<h"),
    3: struct.Struct("<i"),
    4: struct.Struct("<f"),
}
_TYPE_NAMES = {1: "8-bit", 2: "16-bit", 3: "32-bit integer", 4: "32-bit float"}

Parameter = tuple[bytes, float, Any]
ByName = dict[str, tuple[float, Any]]


class ParamData:
    """Parameters of a file: (name, value, type); `defaults` is None where the file has none."""

    def __init__(self) -> None:
        self.params: list[Parameter] = []
        self.defaults: list[Parameter] | None = None

    def add_param(self, name: bytes, value: float, ptype: Any) -> None:
        """Append a parameter."""
        self.params.append((name, value, ptype))

    def add_default(self, name: bytes, value: float, ptype: Any) -> None:
        """Append the default of a parameter."""
        if self.defaults is None:
            self.defaults = []
        self.defaults.append((name, value, ptype))


class _Wrong(ValueError):
    """An error in a parameter file."""


def ftp_param_decode(data: bytes | bytearray) -> ParamData | None:
    """Decode a parameter file; None, and an error in the log, when anything about it is wrong."""
    try:
        return _decode(memoryview(data))
    except _Wrong as error:
        log.error("paramftp: %s", error)
        return None


def _decode(data: memoryview) -> ParamData:
    if len(data) < HEADER.size:
        raise _Wrong(f"Not enough data do decode, only {len(data)} bytes")
    magic, num_params, total_params = HEADER.unpack_from(data)
    if magic not in (MAGIC, MAGIC_WITH_DEFAULTS):
        raise _Wrong(f"bad magic 0x{magic:x} expected 0x{MAGIC:x}")
    if num_params > total_params:
        raise _Wrong(f"parameter count {num_params} exceeds total count {total_params}")
    found = ParamData()
    if magic == MAGIC_WITH_DEFAULTS:
        found.defaults = []
    at, name = HEADER.size, b""
    while (at := _skip_padding(data, at)) < len(data):
        at, name = _record(data, at, name, found)
    if len(found.params) != num_params:
        raise _Wrong(f"bad count {len(found.params)} should be {num_params}")
    return found


def _skip_padding(data: memoryview, at: int) -> int:
    """Zeros before a record keep it within one block of a transfer."""
    while at < len(data) and data[at] == 0:
        at += 1
    return at


def _record(data: memoryview, at: int, before: bytes, found: ParamData) -> tuple[int, bytes]:
    """One parameter; where the next begins, and this one's name, which that may share."""
    if len(data) - at < 2:
        raise _Wrong("truncated parameter header")
    kind, flags = data[at] & 15, data[at] >> 4
    common, fresh = data[at + 1] & 15, (data[at + 1] >> 4) + 1
    form = VALUES.get(kind)
    if form is None:
        raise _Wrong(f"bad type 0x{kind:x}")
    values = 2 if found.defaults is not None and flags & 1 else 1
    start, end = at + 2 + fresh, at + 2 + fresh + values * form.size
    if end > len(data):
        raise _Wrong("truncated parameter record")
    if common > len(before):
        raise _Wrong(f"invalid shared parameter name prefix length {common}")
    name = before[:common] + bytes(data[at + 2 : start])
    if len(name) > MAX_NAME:
        raise _Wrong(f"parameter name is too long ({len(name)} bytes)")
    if not _is_text(name):
        raise _Wrong("parameter name is not valid UTF-8")
    (value,) = form.unpack_from(data, start)
    found.add_param(name, value, kind)
    if found.defaults is not None:
        found.add_default(name, form.unpack_from(data, end - form.size)[0], kind)
    return end, name


def _is_text(name: bytes) -> bool:
    try:
        name.decode()
    except UnicodeDecodeError:
        return False
    return True


def missionplanner_sort(item: str) -> tuple[str, ...]:
    """The key by which Mission Planner sorts parameter names: their parts between underscores."""
    return tuple(item.split("_"))


def extract_params(pdata: list[Parameter] | None, sort_type: str) -> ByName:
    """Parameters by name, sorted as "missionplanner" or "mavproxy" do, or not at all."""
    found = {name.decode(): (value, ptype) for name, value, ptype in pdata or ()}
    if sort_type == "missionplanner":
        return dict(sorted(found.items(), key=lambda item: missionplanner_sort(item[0])))
    if sort_type == "mavproxy":
        return dict(sorted(found.items()))
    return found


def save_params(
    pdict: ByName,
    filename: str,
    sort_type: str,
    add_datatype_comments: bool,
    add_timestamp_comment: bool,
) -> None:
    """Write a parameter file for Mission Planner ("missionplanner") or MAVProxy.

    The comments name the type behind each value, and at the top the time. Nothing is written when
    there are no parameters.
    """
    if not pdict:
        return
    lines = [
        _line(name, value, sort_type) + (_type_comment(ptype) if add_datatype_comments else "")
        for name, (value, ptype) in pdict.items()
    ]
    if add_timestamp_comment:
        lines.insert(0, time.strftime("# Parameters saved at %Y-%m-%d %H:%M:%S"))
    replace_text(filename, "".join(line + "\n" for line in lines))
    log.info("Outputted %u parameters to %s", len(pdict), filename)


def _line(name: str, value: float, sort_type: str) -> str:
    if sort_type == "missionplanner":
        return f"{name},{f'{value:.6f}'.rstrip('0').rstrip('.')}"
    return f"{name:<16} {value:<8.6f}"


def _type_comment(ptype: Any) -> str:
    return f"  # {_TYPE_NAMES.get(ptype, ptype)}"
