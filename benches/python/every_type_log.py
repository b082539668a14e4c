"""The telemetry log that the benches convert where the number of types matters: all that there are, with random values."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

from mavwire.dialects.v20 import all as every
from mavwire.dialects.v20.all import x25crc

FRAMES = 4
"""Of each type, over and over in another order."""
START = 1_700_000_000_000_000
STEP = 2_000
"""Microseconds from one record to the next, through the whole log."""


def write(path: Path, size: int) -> int:
    """Write a log of at least so many bytes; how many records it has."""
    noise = Random(1)
    # Parts of a STATUSTEXT with random ids would share rows.
    classes = [cls for cls in every.mavlink_map.values() if cls.msgname != "STATUSTEXT"]
    frames = [frame_of(cls, noise) for cls in classes for _ in range(FRAMES)]
    records = 0
    with path.open("wb") as file:
        while file.tell() < size:
            noise.shuffle(frames)
            for frame in frames:
                file.write((START + STEP * records).to_bytes(8, "big") + frame)
                records += 1
    return records


def frame_of(cls: Any, noise: Random) -> bytes:
    """A frame of MAVLink 2 with a random payload of full length."""
    size = cls.unpacker.size
    payload = noise.randbytes(size - 1) + b"\1" if size else b""
    body = bytes([len(payload), 0, 0, 0, 1, 1]) + cls.id.to_bytes(3, "little") + payload
    crc = x25crc(body + bytes([cls.crc_extra])).crc
    return b"\xfd" + body + crc.to_bytes(2, "little")
