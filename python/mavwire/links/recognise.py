"""What a device string means when it has no prefix: which kind of log, or which kind of port.

A log is recognised by what it holds before its name is looked at, because ground stations name
telemetry logs as they please, and a wrong reader finds nothing in a good file.
"""

from __future__ import annotations

import errno
import os
import stat

from mavwire._native import head_to_utf8

from .readiness import from_handler

LOG_SUFFIXES = ("mavlink", "log", "raw", "tlog")
DATAFLASH_SUFFIXES = (".bin", ".px4log")
# What the record takes that describes a type in a dataflash log.
FMT_LEN = 89
# The head of the FMT record that describes FMT itself, which dataflash logs begin with.
DATAFLASH_HEAD = b"\xa3\x95\x80"
TEXT_LOG_PROBE = 8000
# Records of a telemetry log that have to follow each other for the file to be one.
TLOG_RECORDS = 3
STAMP_LEN = 8
TLOG_PROBE = TLOG_RECORDS * (STAMP_LEN + 280) + 9
# Bytes of a frame that say how long it is.
LENGTH_HEAD = 3


def read_head(path: str, size: int) -> bytes:
    """The first bytes of a regular file; empty if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read(size)
    except OSError as error:
        if from_handler(error):
            raise
        return b""


def mode_of(path: str) -> int:
    """The mode of the file at `path`; 0 where there is none."""
    try:
        return os.stat(path).st_mode
    except (OSError, ValueError) as error:
        if from_handler(error):
            raise
        return 0


def frame_length(head: bytes) -> int:
    """How long the frame is that begins with `head`, three bytes or more; 0 if none does."""
    marker, payload_len, incompat_flags = head[:LENGTH_HEAD]
    if marker == 0xFD and incompat_flags in (0, 1):
        return 10 + payload_len + 2 + 13 * incompat_flags
    return 6 + payload_len + 2 if marker == 0xFE else 0


def looks_like_tlog(head: bytes) -> bool:
    """Whether `head` begins with whole records: a timestamp and a frame, several times over."""
    ofs = 0
    for _ in range(TLOG_RECORDS):
        if len(head) < ofs + STAMP_LEN + 8:
            break
        length = frame_length(head[ofs + STAMP_LEN :])
        if not length:
            return False
        ofs += STAMP_LEN + length
    return 0 < ofs <= len(head)


def _telemetry_kind(device: str, head: bytes) -> str | None:
    """Either "tlog", or "raw" where records are frames alone; None for a file that is no telemetry log beyond
    doubt.
    """
    if looks_like_tlog(head):
        return "tlog"
    if not head or head.startswith((DATAFLASH_HEAD, b"FMT,")):
        return None
    from mavwire._native import telemetry_kind

    try:
        return telemetry_kind(device)
    except OSError as error:
        if from_handler(error):
            raise
        return None


def log_kind(device: str, readonly: bool) -> str | None:
    """The kind of a log, "dataflash", "text", "tlog" or "raw"; None for what is not a log file.

    Files that are to be written, or read as raw streams, are not recognised by content.
    """
    lower = device.lower()
    exists = stat.S_ISREG(mode_of(device))
    head = read_head(device, TEXT_LOG_PROBE) if exists else b""
    if readonly and (kind := _telemetry_kind(device, head)):
        return kind
    if looks_like_tlog(head):
        return "tlog"
    if lower.endswith(DATAFLASH_SUFFIXES):
        return "dataflash"
    if lower.endswith(".log") and b"FMT," in head_to_utf8(head):
        return "text"
    if exists and readonly and head.startswith(DATAFLASH_HEAD):
        return "dataflash"
    return "tlog" if exists else None


def is_log_name(device: str) -> bool:
    """Whether a name ends like a telemetry log's."""
    return device.lower().rsplit(".", 1)[-1] in LOG_SUFFIXES


def is_serial_name(device: str) -> bool:
    """Whether a name looks like a serial port's, optionally with `,baud`."""
    name, _, baud = device.partition(",")
    base = os.path.basename(name).lower()
    return (
        baud.isdigit()
        or name.startswith(("/dev/", "\\\\.\\", "//./"))
        or base.startswith(("tty", "cu.", "rfcomm"))
        or (base.startswith("com") and base[3:].isdigit())
    )


def missing_log(device: str) -> bool:
    """Whether `device` can only mean a log file, and that file does not exist."""
    if mode_of(device) or is_serial_name(device):
        return False
    is_path = "/" in device or "\\" in device
    return is_path or is_log_name(device)


def is_program(device: str) -> bool:
    """Whether a file is a program by name and mode and no log by content."""
    named = device.endswith(".elf") or ("/bin/" in device and os.access(device, os.X_OK))
    return named and not looks_like_tlog(read_head(device, TLOG_PROBE))


def is_pipe_or_socket(device: str) -> bool:
    """Whether a name leads to a named pipe or a socket, which opening would wait on for ever."""
    mode = mode_of(device)
    return stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)


def no_such_log(device: str) -> OSError:
    """What to say of a name that leads to no file."""
    try:
        os.stat(device)
    except OSError as error:
        if error.errno == errno.ELOOP:  # there is a file, of symbolic links that lead round
            return error
    return FileNotFoundError(errno.ENOENT, "no such log file", device)


def check_usable(device: str, creating: bool) -> None:
    """Raise the error that tells why no link can be made of a file that is meant as a log.

    FileNotFoundError for a missing one unless `creating`, OSError for symbolic links that lead
    round, IsADirectoryError for a directory, PermissionError for a program, which is never run
    because of its name; ValueError for no name, and for what is neither a log nor a port.
    """
    if not device:
        raise ValueError("no device: the name is empty")
    if missing_log(device) and not creating:
        raise no_such_log(device)
    if stat.S_ISDIR(mode_of(device)):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), device)
    if is_pipe_or_socket(device):
        raise ValueError(f"a pipe or a socket is neither a log nor a port: {device!r}")
    if stat.S_ISREG(mode_of(device)) and is_program(device):
        reason = f"is a program, not a log; use 'exec:{device}' to run it and talk to it"
        raise PermissionError(errno.EACCES, reason, device)
