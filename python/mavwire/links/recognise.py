"""The meaning of a device string without a prefix: a kind of log, or a kind of port.

A log is recognised by its content before its name is looked at, because ground stations name
telemetry logs as they please, and a wrong reader finds nothing in a good file.
"""

from __future__ import annotations

import errno
import os
import stat

from mavwire._native import LogKind, identify

LOG_SUFFIXES = ("mavlink", "log", "raw", "tlog")
DATAFLASH_SUFFIXES = (".bin", ".px4log")
STAMP_LEN = 8
# Bytes of a frame that say how long it is.
LENGTH_HEAD = 3


def kind_of(path: str) -> LogKind:
    """The kind of a regular file; `CUT`, as for an empty one, if it cannot be read or is missing."""
    if not stat.S_ISREG(mode_of(path)):
        return LogKind.CUT
    try:
        return identify(path)
    except OSError:
        return LogKind.CUT


def mode_of(path: str) -> int:
    """The mode of the file at `path`; 0 where there is none."""
    try:
        return os.stat(path).st_mode
    except (OSError, ValueError):
        return 0


def frame_length(head: bytes) -> int:
    """How long the frame is that begins with `head`, three bytes or more; 0 if none does."""
    marker, payload_len, incompat_flags = head[:LENGTH_HEAD]
    if marker == 0xFD and incompat_flags in (0, 1):
        return 10 + payload_len + 2 + 13 * incompat_flags
    return 6 + payload_len + 2 if marker == 0xFE else 0


def log_kind(device: str, readonly: bool) -> LogKind | None:
    """As what mavutil reads a log: `TLOG`, `RAW`, `DATAFLASH` or `DATAFLASH_TEXT`; None for what is
    no log file. Where the content tells nothing, the name decides as in pymavlink.

    Files that are to be written, or read as raw streams, are not recognised by content.
    """
    kind = kind_of(device)
    if kind is LogKind.TLOG or (readonly and (kind.is_telemetry or kind.is_dataflash)):
        return LogKind.DATAFLASH if kind is LogKind.HEADERLESS else kind
    if readonly and kind is LogKind.OTHER_TEXT:
        return LogKind.DATAFLASH_TEXT  # its reader tells how to convert the log
    lower = device.lower()
    if lower.endswith(DATAFLASH_SUFFIXES):
        return LogKind.DATAFLASH
    if lower.endswith(".log") and kind is LogKind.DATAFLASH_TEXT:
        return kind
    return LogKind.TLOG if stat.S_ISREG(mode_of(device)) else None


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
    if not named:
        return False
    kind = kind_of(device)
    return not (kind.is_telemetry or kind.is_dataflash)


def is_pipe_or_socket(device: str) -> bool:
    """Whether a name leads to a named pipe or a socket, which opening would wait on for ever."""
    mode = mode_of(device)
    return stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)


def no_such_log(device: str) -> FileNotFoundError:
    """The error for a name that leads to no file."""
    return FileNotFoundError(errno.ENOENT, "no such log file", device)


def check_usable(device: str, creating: bool) -> None:
    """Raise the error that tells why no link can be made of a file that is meant as a log.

    FileNotFoundError for a missing one unless `creating`, IsADirectoryError for a directory,
    PermissionError for a program, which is never run because of its name; ValueError for no name,
    and for a pipe or a socket.
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
