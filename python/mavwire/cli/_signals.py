"""Signals that end a command in good order."""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from contextlib import AbstractContextManager
    from typing import Any


@contextmanager
def handled(numbers: Iterable[int], handler: Callable[[int, Any], None]) -> Iterator[None]:
    """Meanwhile these signals are for `handler`."""
    if threading.current_thread() is not threading.main_thread():  # which takes all signals
        yield
        return
    before = {number: signal.getsignal(number) for number in numbers}
    try:
        for number in before:
            signal.signal(number, handler)
        yield
    finally:
        _give_back(before)


def _give_back(handlers: dict[int, Any]) -> None:
    try:
        for number, other in handlers.items():
            if other is not None:  # one that was not set by Python, which cannot set it again
                signal.signal(number, other)
    except BaseException:  # of a signal that came between two of them
        _give_back(handlers)
        raise


def ended_in_order() -> AbstractContextManager[None]:
    """Meanwhile what ends a process does so as Ctrl-C does: what is being written is completed or
    removed.
    """
    return handled(_ending(), _interrupt)


def _ending() -> list[int]:
    """Signals of a service manager, and of a terminal that closes, unless `nohup` ignores that."""
    hangup = getattr(signal, "SIGHUP", None)
    if hangup is None or signal.getsignal(hangup) is signal.SIG_IGN:
        return [signal.SIGTERM]
    return [signal.SIGTERM, hangup]


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt
