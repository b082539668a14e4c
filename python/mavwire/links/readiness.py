"""Waiting for a descriptor."""

from __future__ import annotations

import errno
import os

from . import Any


def wait_readable(fd: Any, timeout: float) -> bool:
    """Whether `fd` becomes readable within `timeout` seconds; OSError, ValueError or TypeError when it cannot be
    watched."""
    import select

    if hasattr(select, "poll"):
        # Unlike select(), poll() takes descriptors beyond 1023: a bridge may hold many links.
        poller = select.poll()
        poller.register(fd, select.POLLIN)
        events = poller.poll(max(timeout, 0.0) * 1000.0)
        if events and events[0][1] & select.POLLNVAL:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        return bool(events)
    readable, _, _ = select.select([fd], [], [], max(timeout, 0.0))
    return bool(readable)


def wait_writable(fd: int, timeout: float) -> bool:
    """Whether `fd` takes something within `timeout` seconds, or has an error."""
    import select

    if hasattr(select, "poll"):
        poller = select.poll()
        poller.register(fd, select.POLLOUT)
        return bool(poller.poll(timeout * 1000.0))
    _, writable, failed = select.select([], [fd], [fd], timeout)
    return bool(writable or failed)
