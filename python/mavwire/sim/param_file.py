"""All parameters in one file, as ArduPilot offers them at @PARAM/param.pck.

A header of three little-endian uint16 (magic, how many follow, how many there are), then for each
parameter its type and flags, how many letters its name shares with the one before and how many are
new, those letters, and the value. Zeros before an entry keep it within one block of a transfer.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from mavwire._ftp.params import HEADER, MAGIC, MAGIC_WITH_DEFAULTS, VALUES
from mavwire.dialects.v20 import all as mavlink

DEFAULT_FLAG = 0x10
_TYPES = {
    mavlink.MAV_PARAM_TYPE_INT8: 1,
    mavlink.MAV_PARAM_TYPE_INT16: 2,
    mavlink.MAV_PARAM_TYPE_INT32: 3,
    mavlink.MAV_PARAM_TYPE_REAL32: 4,
}


class Entry(NamedTuple):
    """One parameter of the file."""

    name: str
    type: int
    value: float
    default: float


def pack(entries: Iterable[Entry], total: int, block: int, with_defaults: bool = False) -> bytes:
    """The file, laid out for reads of `block` bytes."""
    entries = list(entries)
    magic = MAGIC_WITH_DEFAULTS if with_defaults else MAGIC
    packed = bytearray(HEADER.pack(magic, len(entries), total))
    before = ""
    for entry in entries:
        data = _entry(entry, before, with_defaults)
        left = block - len(packed) % block
        if len(data) > left:
            packed += bytes(left)
        packed += data
        before = entry.name
    return bytes(packed)


def _entry(entry: Entry, before: str, with_defaults: bool) -> bytes:
    common = min(_shared(before, entry.name), 15, len(entry.name) - 1)
    fresh = entry.name[common:].encode()
    number = _TYPES[entry.type]
    form = VALUES[number]
    real = entry.type == mavlink.MAV_PARAM_TYPE_REAL32
    value, default = (v if real else int(v) for v in (entry.value, entry.default))
    data = form.pack(value)
    if with_defaults and default != value:
        number |= DEFAULT_FLAG
        data += form.pack(default)
    return bytes((number, common | len(fresh) - 1 << 4)) + fresh + data


def _shared(a: str, b: str) -> int:
    """How many letters two names begin with alike."""
    differ = (at for at, (x, y) in enumerate(zip(a, b, strict=False)) if x != y)
    return next(differ, min(len(a), len(b)))
