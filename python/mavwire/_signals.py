"""Signals that end a program in good order, or later."""

from __future__ import annotations

import math
import signal
import threading
import time
from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from typing import Any


@contextmanager
def handled(numbers: Iterable[int], handler: Callable[[int, Any], object]) -> Iterator[None]:
    """Meanwhile these signals are for `handler`."""
    if threading.current_thread() is not threading.main_thread():  # which takes all signals
        yield
        return
    before = {number: signal.getsignal(number) for number in numbers}
    # Python cannot set again what it did not set.
    before = {number: other for number, other in before.items() if other is not None}
    try:
        for number in before:
            signal.signal(number, handler)
        yield
    finally:
        for number, other in before.items():
            signal.signal(number, other)


@contextmanager
def put_off(numbers: Iterable[int]) -> Iterator[None]:
    """Handlers of Python for these signals are called afterwards, also where something fails. Signals
    without such a handler have their usual effect at once.
    """
    came: set[int] = set()
    called = [number for number in numbers if callable(signal.getsignal(number))]
    try:
        with handled(called, lambda number, frame: came.add(number)):
            yield
    finally:
        for number in came:
            signal.raise_signal(number)


TOGETHER = 1.0
"""Seconds in which signals are for one end: SIGTERM and SIGHUP of a service manager come side by side."""

_ends_in_order = False


@contextmanager
def ended_in_order() -> Iterator[None]:
    """Meanwhile what ends a process does so as Ctrl-C does: what is being written is completed or
    removed. A second signal soon after does not disturb that.
    """
    global _ends_in_order
    if _ends_in_order or threading.current_thread() is not threading.main_thread():
        yield
        return
    latest = -math.inf

    def end(number: int, frame: object) -> None:
        nonlocal latest
        now = time.monotonic()
        if now - latest > TOGETHER:
            latest = now
            raise KeyboardInterrupt

    with handled(_ending(), end):
        try:
            _ends_in_order = True
            yield
        finally:
            _ends_in_order = False


def _ending() -> list[int]:
    """Signals of a service manager, and of a terminal that closes, unless `nohup` ignores that."""
    hangup = getattr(signal, "SIGHUP", None)
    if hangup is None or signal.getsignal(hangup) is signal.SIG_IGN:
        return [signal.SIGTERM]
    return [signal.SIGTERM, hangup]
