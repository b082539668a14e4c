"""Finding serial ports that may be an autopilot."""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

UNIX_PORTS = ("/dev/ttyS*", "/dev/ttyUSB*", "/dev/ttyACM*", "/dev/serial/by-id/*")
MAC_PORTS = ("/dev/cu.usbmodem*", "/dev/cu.usbserial*")


class SerialPort:
    """A port found: its device name, and what is known of the adapter."""

    def __init__(
        self, device: str, description: str | None = None, hwid: str | None = None
    ) -> None:
        self.device = device
        self.description = description
        self.hwid = hwid

    def __str__(self) -> str:
        parts = (self.device, self.description, self.hwid)
        return " : ".join(part for part in parts if part is not None)


def _matches(text: str | None, patterns: Iterable[str]) -> bool:
    from fnmatch import fnmatch

    return text is not None and any(fnmatch(text, pattern) for pattern in patterns)


def auto_detect_serial_win32(preferred_list: Iterable[str] = ("*",)) -> list[SerialPort]:
    """The ports whose description or hardware id matches a pattern, or all ports."""
    try:
        from serial.tools.list_ports import comports

        found = [SerialPort(*port) for port in sorted(comports())]
    except Exception:  # pyserial's backends raise what the platform raises
        return []
    preferred = [
        port
        for port in found
        if _matches(port.description, preferred_list) or _matches(port.hwid, preferred_list)
    ]
    return preferred or found


def auto_detect_serial_unix(preferred_list: Iterable[str] = ("*",)) -> list[SerialPort]:
    """The ports whose device name matches a pattern, or all ports."""
    import sys
    from glob import glob

    patterns = UNIX_PORTS + (MAC_PORTS if sys.platform == "darwin" else ())
    devices = [device for pattern in patterns for device in glob(pattern)]
    preferred = [device for device in devices if _matches(device, preferred_list)]
    return [SerialPort(device) for device in preferred or devices]


def auto_detect_serial(preferred_list: Iterable[str] = ("*",)) -> list[SerialPort]:
    """Serial ports that look like an autopilot, by this platform's means."""
    if os.name == "nt":
        return auto_detect_serial_win32(preferred_list)
    return auto_detect_serial_unix(preferred_list)
