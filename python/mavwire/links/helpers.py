"""Small public helpers of `mavutil` that stand on their own."""

from __future__ import annotations

import time

from . import Any


class location:
    """A position: latitude and longitude in degrees, altitude in metres, heading in degrees."""

    def __init__(self, lat: float, lng: float, alt: float = 0, heading: float = 0) -> None:
        self.lat = lat
        self.lng = lng
        self.alt = alt
        self.heading = heading

    def __str__(self) -> str:
        return f"lat={self.lat:.6f},lon={self.lng:.6f},alt={self.alt:.1f}"


class periodic_event:
    """A timer for polling loops: `trigger()` is True `frequency` times a second."""

    def __init__(self, frequency: float) -> None:
        self.frequency = float(frequency)
        self.last_time = time.time()

    def force(self) -> None:
        """Make the next `trigger()` True."""
        self.last_time = 0.0

    def trigger(self) -> bool:
        """Whether 1/frequency seconds have passed since it was last True."""
        now = time.time()
        if now < self.last_time:
            print("Warning, time moved backwards. Restarting timer.")
            self.last_time = now
        if self.last_time + 1.0 / self.frequency <= now:
            self.last_time = now
            return True
        return False


class FakeSerial:
    """A placeholder for a serial port that could not be opened yet."""

    def read(self, len: int) -> str:
        return ""

    def write(self, buf: bytes) -> None:
        raise Exception("write always fails")

    def inWaiting(self) -> int:
        return 0

    def close(self) -> None:
        pass


def u_ord(c: Any) -> Any:
    """`c` itself: indexing bytes gives numbers."""
    return c


def is_printable(c: str | int) -> bool:
    """Whether one character, or the byte value of one, is printable ASCII."""
    code = ord(c) if isinstance(c, str) else c
    return 32 <= code <= 126


def all_printable(buf: str | bytes) -> bool:
    """Whether text holds nothing but printable ASCII, line ends and tabs."""
    return all(is_printable(c) or c in ("\r", "\n", "\t", 13, 10, 9) for c in buf)
