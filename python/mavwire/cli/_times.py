"""Times and durations as commands print them."""

from __future__ import annotations

import time


def local_time(second: float) -> str:
    """The time of the local clock for seconds since 1970."""
    try:
        return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(second))
    except (OverflowError, OSError, ValueError):  # beyond what this platform's calendar holds
        return f"{second:.0f}s"


def local_stamp(second: float) -> str:
    """The same with hundredths of a second."""
    return f"{local_time(second)}.{int(second * 100.0) % 100:02d}"


def minutes(seconds: int) -> str:
    """`2:40`"""
    return f"{seconds // 60}:{seconds % 60:02d}"
