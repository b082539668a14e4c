"""Memory for the tables of a log."""

from __future__ import annotations

import os
import re
import warnings
from contextlib import suppress
from pathlib import Path

from mavwire._text import callers_level

GIB = 1 << 30
LIMIT, USED = "/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"
"""Files in which Linux tells the memory limit of a container, and its use."""


def available() -> int | None:
    """Bytes of memory that are free on Linux, in a container too; None elsewhere."""
    with suppress(OSError, ValueError, TypeError):
        found = re.search(r"MemAvailable: +(\d+)", Path("/proc/meminfo").read_text())
        free = int(found[1]) << 10  # type: ignore[index]
        with suppress(OSError, ValueError):  # no container, or "max"
            free = min(free, int(Path(LIMIT).read_text()) - int(Path(USED).read_text()))
        return free
    return None


def warn_if_scarce(path: str) -> None:
    """Warn where the tables of a whole log will not fit. They take about as many bytes as the log, and more than
    a compressed file.
    """
    needed, free = os.stat(path).st_size, available()
    if free is not None and needed > free:
        text = f"{path}: its tables take about {needed / GIB:.1f} GiB, and {free / GIB:.1f} GiB of memory are free"
        advice = "ask for less by types=, fields= or start=, or use mavwire.scan, which holds one batch at a time"
        warnings.warn(f"{text}: {advice}", stacklevel=callers_level())
