"""Writing received frames to a telemetry log, and showing their fields, without leaking secrets."""

from __future__ import annotations

from mavwire._native import recordable

from .signing import KEY_LEN

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SECRET_FIELD = "secret_key"


def shown(field: str, value: Any) -> Any:
    """The value of a field as texts show it: a key reads as 255 over and over."""
    return [0xFF] * KEY_LEN if field == SECRET_FIELD else value


def record(file: Any, unix_seconds: float, frame: bytes | bytearray) -> None:
    """Write one telemetry log record: big-endian microseconds, low two bits clear, and frame."""
    timestamp = int(unix_seconds * 1.0e6) & ~3
    file.write(timestamp.to_bytes(8, "big") + recordable(frame))
