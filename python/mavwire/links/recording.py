"""Writing received frames to a telemetry log without leaking secrets or stopping reception.

A log is passed around, so what is recorded is stripped: a signature proves nothing to a reader
without the key, and SETUP_SIGNING would hand the key out (MAVLink guide, Message Signing).
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MARKER_V2 = 0xFD
HEADER_LEN = 10
SIGNATURE_LEN = 13
IFLAG_SIGNED = 0x01
# SETUP_SIGNING: id 256 little-endian, and the layout of its 42-byte payload.
_SETUP_SIGNING_ID = b"\x00\x01\x00"
_SETUP_SIGNING_EXTRA = 71
_KEY_OFFSET = 10
_KEY_LEN = 32
SECRET_FIELD = "secret_key"
# Payload length -> change of the checksum; 256 entries at most.
_deltas: dict[int, int] = {}


def crc_step(crc: int, byte: int) -> int:
    """One byte of CRC-16/MCRF4XX."""
    crc ^= byte
    for _ in range(8):
        crc = (crc >> 1) ^ 0x8408 if crc & 1 else crc >> 1
    return crc


def _unsigned_flag_delta(payload_len: int) -> int:
    """What clearing the signed flag changes in the checksum of a frame of `payload_len`.

    The CRC is linear, so the change depends on the flag's distance from the end alone. Neither
    crc_extra nor the payload is needed, and unknown messages can be stripped like known ones.
    """
    delta = _deltas.get(payload_len)
    if delta is None:
        delta = crc_step(0, IFLAG_SIGNED)
        for _ in range(HEADER_LEN - 3 + payload_len + 1):
            delta = crc_step(delta, 0)
        _deltas[payload_len] = delta
    return delta


def recordable(frame: bytes | bytearray) -> bytes | bytearray:
    """`frame` as a telemetry log may hold it: without signature, without a secret key."""
    if len(frame) < HEADER_LEN + 2 or frame[0] != MARKER_V2:
        return frame
    if frame[7:10] == _SETUP_SIGNING_ID:
        return _without_key(frame)
    if frame[2] & IFLAG_SIGNED:
        return _without_signature(frame)
    return frame


def _without_signature(frame: bytes | bytearray) -> bytes:
    stripped = bytearray(frame[:-SIGNATURE_LEN])
    stripped[2] &= ~IFLAG_SIGNED
    crc = int.from_bytes(stripped[-2:], "little") ^ _unsigned_flag_delta(stripped[1])
    stripped[-2:] = crc.to_bytes(2, "little")
    return bytes(stripped)


def _without_key(frame: bytes | bytearray) -> bytes:
    """The same SETUP_SIGNING with every key byte FF, whatever was trimmed from it before."""
    addressing = bytes(frame[HEADER_LEN : HEADER_LEN + frame[1]])[:_KEY_OFFSET]
    payload = addressing.ljust(_KEY_OFFSET, b"\0") + b"\xff" * _KEY_LEN
    redacted = bytearray(frame[:HEADER_LEN]) + payload
    redacted[1] = len(payload)
    redacted[2] &= ~IFLAG_SIGNED
    crc = 0xFFFF
    for byte in redacted[1:]:
        crc = crc_step(crc, byte)
    crc = crc_step(crc, _SETUP_SIGNING_EXTRA)
    return bytes(redacted) + crc.to_bytes(2, "little")


def shown(field: str, value: Any) -> Any:
    """The value of a field as texts show it: a key reads as 255 over and over."""
    return [0xFF] * _KEY_LEN if field == SECRET_FIELD else value


def record(file: Any, unix_seconds: float, frame: bytes | bytearray) -> None:
    """Write one telemetry log record: big-endian microseconds, low two bits clear, and frame."""
    timestamp = int(unix_seconds * 1.0e6) & ~3
    file.write(timestamp.to_bytes(8, "big") + recordable(frame))
