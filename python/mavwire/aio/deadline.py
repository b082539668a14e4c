"""When a time-out ends, on the loop's clock."""

from __future__ import annotations

import asyncio
import math


def deadline_after(loop: asyncio.AbstractEventLoop, timeout: float | None) -> float | None:
    """The loop's time in `timeout` seconds; None for one that never comes. ValueError for a NaN,
    which no clock reaches."""
    if timeout is None or timeout == math.inf:
        return None
    if math.isnan(timeout):
        raise ValueError("a timeout is a number of seconds, which nan is not")
    return loop.time() + timeout


def is_over(loop: asyncio.AbstractEventLoop, deadline: float | None) -> bool:
    """Whether `deadline` has come."""
    return deadline is not None and loop.time() >= deadline
