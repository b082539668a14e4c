"""Received frames as records of a telemetry log, and values of fields as texts show them, without secrets."""

from __future__ import annotations

from mavwire._native import recordable

from . import Any
from .signing import KEY_LEN

SECRET_FIELD = "secret_key"
# The id of the message with that field, which a dialect may lack.
SETUP_SIGNING = 256


def shown(field: str, value: Any) -> Any:
    """The value of a field as texts show it: a key reads as 255 over and over."""
    return [0xFF] * KEY_LEN if field == SECRET_FIELD else value


def recorded(unix_seconds: float, frame: bytes | bytearray) -> bytes:
    """One telemetry log record: big-endian microseconds, low two bits clear, and frame."""
    timestamp = int(unix_seconds * 1.0e6) & ~3
    return timestamp.to_bytes(8, "big") + recordable(frame)
