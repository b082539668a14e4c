"""Writing received frames to a telemetry log, and showing their fields, without leaking secrets."""

from __future__ import annotations

from contextlib import suppress
from os import getpid

from mavwire._native import recordable

from .signing import KEY_LEN

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SECRET_FIELD = "secret_key"
# Files that links record to, weakly held, by the process that opened them.
_open_files: Any = None


def shown(field: str, value: Any) -> Any:
    """The value of a field as texts show it: a key reads as 255 over and over."""
    return [0xFF] * KEY_LEN if field == SECRET_FIELD else value


def record(file: Any, unix_seconds: float, frame: bytes | bytearray) -> None:
    """Write one telemetry log record: big-endian microseconds, low two bits clear, and frame."""
    timestamp = int(unix_seconds * 1.0e6) & ~3
    file.write(timestamp.to_bytes(8, "big") + recordable(frame))


def open_recording(path: str, mode: str) -> Any:
    """Open a file to record to. What is in its buffer is written when the program ends, even if threads still
    hold the link then, as daemon threads do.
    """
    global _open_files
    if _open_files is None:
        from atexit import register
        from weakref import WeakKeyDictionary

        _open_files = WeakKeyDictionary()
        register(_flush_all)
    file = open(path, mode)
    _open_files[file] = getpid()
    return file


def _flush_all() -> None:
    """Write the buffers of this process; a fork leaves those of its parent alone."""
    for file, process in list(_open_files.items()):
        if process == getpid():
            with suppress(OSError, ValueError):
                file.flush()
