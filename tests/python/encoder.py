"""Frames by the letter of the MAVLink guide, in a few lines and without mavwire or pymavlink."""

from __future__ import annotations

import hashlib
import struct

from differential.frames import x25

CRC_EXTRA = {0: 50, 22: 220, 30: 39, 42: 28, 109: 185, 251: 170, 253: 83, 256: 71}


def frame(
    msgid: int,
    payload: bytes,
    seq: int = 0,
    *,
    v1: bool = False,
    sysid: int = 1,
    compid: int = 1,
    flags: int = 0,
    crc_extra: int | None = None,
) -> bytes:
    """A frame with exactly this payload: nothing is cut off or added."""
    if v1:
        head = struct.pack("<5B", len(payload), seq, sysid, compid, msgid)
    else:
        head = struct.pack("<6B", len(payload), flags, 0, seq, sysid, compid)
        head += msgid.to_bytes(3, "little")
    extra = CRC_EXTRA.get(msgid, 0) if crc_extra is None else crc_extra
    checksum = x25(head + payload + bytes([extra]))
    return (b"\xfe" if v1 else b"\xfd") + head + payload + checksum.to_bytes(2, "little")


def signed(
    msgid: int,
    payload: bytes,
    key: bytes,
    timestamp: int,
    link_id: int = 3,
    *,
    sysid: int = 1,
    compid: int = 1,
    crc_extra: int | None = None,
) -> bytes:
    """A version 2 frame with a signature."""
    start = frame(msgid, payload, sysid=sysid, compid=compid, flags=1, crc_extra=crc_extra)
    start += bytes([link_id]) + timestamp.to_bytes(6, "little")
    return start + hashlib.sha256(key + start).digest()[:6]


def heartbeat(seq: int = 0, *, v1: bool = False, sysid: int = 1, compid: int = 1) -> bytes:
    """A vehicle's HEARTBEAT."""
    payload = struct.pack("<I5B", 4, 2, 3, 81, 4, 3)
    return frame(0, payload, seq % 256, v1=v1, sysid=sysid, compid=compid)


def attitude(time_boot_ms: int, *angles: float) -> bytes:
    """The payload of ATTITUDE."""
    return struct.pack("<I6f", time_boot_ms, *angles)


def record(frame: bytes, microseconds: int) -> bytes:
    """A record of a telemetry log."""
    return struct.pack(">Q", microseconds) + frame
