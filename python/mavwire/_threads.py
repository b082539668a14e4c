"""Threads that nobody waits for at the end of the program."""

from __future__ import annotations

import errno
import threading
from collections.abc import Callable


class NoThreadError(OSError):
    """The system has no thread left."""


def start_thread(function: Callable[[], object], name: str) -> threading.Thread:
    """Run `function` in a daemon thread of its own. NoThreadError."""
    thread = threading.Thread(target=function, name=name, daemon=True)
    try:
        thread.start()
    except RuntimeError as error:
        raise NoThreadError(errno.EAGAIN, str(error)) from error
    return thread
