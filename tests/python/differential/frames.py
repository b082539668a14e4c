"""Frames to feed to both packages: every message of a dialect, field values from harmless to
hostile, any framing.

Layouts are read off the reference's message classes (their public class attributes), checksums come
from the table below, so no code of the implementation under test takes part in making its input.
Everything follows from one `random.Random`.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from types import ModuleType

KEY = bytes(range(32))
_NICE_FLOATS = (0.0, -0.0, 1.5, 0.1, -273.15, 1e20, 1e-8, 123456.789, float("inf"), float("nan"))
_TEXT = b'ABCdef_09 .:/-"\\\n\t\x7f\xe9\xff\x00'


def _crc_table() -> list[int]:
    table = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0x8408 if crc & 1 else crc >> 1
        table.append(crc)
    return table


_TABLE = _crc_table()


def x25(data: bytes) -> int:
    """CRC-16/MCRF4XX, one byte at a time: slow, and independent of both packages."""
    crc = 0xFFFF
    for byte in data:
        crc = (crc >> 8) ^ _TABLE[(crc ^ byte) & 0xFF]
    return crc


@dataclass(frozen=True)
class Layout:
    """What is needed of a message to make its frames."""

    msgid: int
    name: str
    crc_extra: int
    payload: struct.Struct
    codes: tuple[tuple[int, str], ...]  # (elements, struct letter) per field in wire order

    @property
    def size(self) -> int:
        """Payload bytes without truncation."""
        return self.payload.size


def layouts(dialect: ModuleType) -> list[Layout]:
    """Layouts of all messages of a dialect module, in order of id."""
    made = []
    for msgid, cls in sorted(dialect.mavlink_map.items()):
        letters = bytes(cls.native_format[1:]).decode()
        codes = tuple(
            (count if letter == "c" else max(count, 1), "s" if letter == "c" else letter)
            for letter, count in zip(letters, cls.array_lengths, strict=True)
        )
        made.append(Layout(msgid, cls.msgname, cls.crc_extra, cls.unpacker, codes))
    return made


@dataclass(frozen=True)
class Framing:
    """How to wrap payloads."""

    version: int = 2
    key: bytes | None = None
    link_id: int = 1


class FrameMaker:
    """Deterministic source of frames: same seed, same bytes."""

    def __init__(self, seed: int, framing: Framing | None = None) -> None:
        self.random = Random(seed)
        self.framing = framing or Framing()
        self.timestamp = 1000
        self.seq = 0

    def payload(self, layout: Layout) -> bytes:
        """Random bits, plausible values, or a mostly zero payload."""
        kind = self.random.random()
        if kind < 0.45:
            return self.random.randbytes(layout.size)
        if kind < 0.9:
            return b"".join(self._plausible(count, code) for count, code in layout.codes)
        keep = self.random.randrange(layout.size + 1)
        return self.random.randbytes(keep).ljust(layout.size, b"\0")

    def _plausible(self, count: int, code: str) -> bytes:
        rand = self.random
        if code == "s":
            size = max(count, 1)
            text = bytes(rand.choices(_TEXT[:-1], k=rand.randrange(size + 1)))
            return text.ljust(size, b"\0")
        if code in "fd":
            values = [rand.choice((*_NICE_FLOATS, rand.gauss(0, 100))) for _ in range(count)]
            return struct.pack(f"<{count}{code}", *values)
        width = struct.calcsize(f"<{code}")
        small = (0, 1, 2, 100, 255, (1 << (8 * width)) - 1, 1 << (8 * width - 1))
        return b"".join(
            (rand.choice(small) % (1 << (8 * width))).to_bytes(width, "little")
            for _ in range(count)
        )

    def frame(self, layout: Layout, payload: bytes | None = None) -> bytes:
        """A correct frame; MAVLink 2 payloads mostly lose their trailing zeros."""
        payload = self.payload(layout) if payload is None else payload
        sysid, compid = self.random.choice(((1, 1), (1, 1), (255, 190), (7, 100), (51, 68)))
        self.seq = (self.seq + 1) % 256
        if self.framing.version == 1:
            head = struct.pack("<BBBBB", len(payload), self.seq, sysid, compid, layout.msgid)
            return _checked(b"\xfe", head + payload, layout.crc_extra)
        if self.random.random() < 0.9:
            payload = payload.rstrip(b"\0") or payload[:1]
        flags = 1 if self.framing.key else 0
        head = struct.pack("<BBBBBB", len(payload), flags, 0, self.seq, sysid, compid)
        head += layout.msgid.to_bytes(3, "little")
        frame = _checked(b"\xfd", head + payload, layout.crc_extra)
        return self._signed(frame) if self.framing.key else frame

    def _signed(self, frame: bytes) -> bytes:
        assert self.framing.key is not None
        self.timestamp += 1
        frame += bytes([self.framing.link_id]) + self.timestamp.to_bytes(6, "little")
        return frame + hashlib.sha256(self.framing.key + frame).digest()[:6]

    def frames(self, every: list[Layout], count: int) -> Iterator[bytes]:
        """`count` frames, going through all layouts in turn."""
        usable = [one for one in every if self.framing.version == 2 or one.msgid < 256]
        for index in range(count):
            yield self.frame(usable[index % len(usable)])


def _checked(stx: bytes, body: bytes, crc_extra: int) -> bytes:
    return stx + body + x25(body + bytes([crc_extra])).to_bytes(2, "little")
