"""Writing received frames to a telemetry log, and showing their fields, without leaking secrets."""

from __future__ import annotations

import os
from _thread import _count as count_threads
from _thread import allocate_lock, start_new_thread
from io import BufferedRandom, BufferedWriter

from mavwire._native import recordable

from .forks import follow_forks
from .signing import KEY_LEN
from .weak_registry import WeakRegistry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SECRET_FIELD = "secret_key"
# The id of the message with that field, which a dialect may lack.
SETUP_SIGNING = 256
# Files that links record to.
_files = WeakRegistry()
_is_registered = False
# How long a fork and the end of the program wait for a file that another thread is writing, in seconds.
PATIENCE = 1.0


def shown(field: str, value: Any) -> Any:
    """The value of a field as texts show it: a key reads as 255 over and over."""
    return [0xFF] * KEY_LEN if field == SECRET_FIELD else value


def recorded(unix_seconds: float, frame: bytes | bytearray) -> bytes:
    """One telemetry log record: big-endian microseconds, low two bits clear, and frame."""
    timestamp = int(unix_seconds * 1.0e6) & ~3
    return timestamp.to_bytes(8, "big") + recordable(frame)


def open_recording(path: str, mode: str) -> Any:
    """Open a file to record to. What is in its buffer is written when the program ends, even if threads still
    hold the link then, as daemon threads do, and before it forks, unless another thread waits for that very file.
    """
    if not _is_registered:
        _register()
    file = open(path, mode)
    _files.add(file)
    follow_forks(file, _renew)
    return file


def _register() -> None:
    """Not before something is recorded: at the end of the program, what was registered last comes first, and what the
    program has registered may read the file."""
    from atexit import register

    global _is_registered
    register(_flush_all)
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=_flush_all)
    _is_registered = True


def _flush_all() -> None:
    files = list(_files)
    if not files or not count_threads():
        _flush_each(files)
        return
    flushed = allocate_lock()
    flushed.acquire()

    def flush() -> None:
        try:
            _flush_each(files)
        finally:
            flushed.release()

    try:
        start_new_thread(flush, ())
    except RuntimeError:  # no thread can be had at the very end
        return
    flushed.acquire(timeout=PATIENCE)


def _flush_each(files: list[Any]) -> None:
    for file in files:
        try:
            file.flush()
        except (
            OSError,
            ValueError,
            RuntimeError,
        ):  # the last by a signal handler, in the middle of a write
            continue


def _renew(file: Any) -> None:
    """In a forked process: another thread may hold the lock of the file, and what it has put into the buffer is
    written where it runs."""
    if type(file) in (BufferedWriter, BufferedRandom) and not file.closed:
        type(file).__init__(file, file.raw)
