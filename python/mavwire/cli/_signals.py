"""Signals that end a command in good order."""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def ended_in_order() -> Iterator[None]:
    """Meanwhile what ends a process does so as Ctrl-C does: what is being written is completed or
    removed.
    """
    if threading.current_thread() is not threading.main_thread():  # which takes all signals
        yield
        return
    before = {number: signal.signal(number, _interrupt) for number in _ending()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _ending() -> list[int]:
    """Signals of a service manager, and of a terminal that closes, unless `nohup` ignores that."""
    hangup = getattr(signal, "SIGHUP", None)
    if hangup is None or signal.getsignal(hangup) is signal.SIG_IGN:
        return [signal.SIGTERM]
    return [signal.SIGTERM, hangup]


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt
