"""Letting the loop watch the descriptor of a link."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

# A descriptor and the port that it belongs to, since the system uses the numbers again.
Descriptor = tuple[int, Any]

# How often links are looked at that the loop cannot watch: a serial port on Windows, and all of
# them under a proactor loop.
POLL_INTERVAL = 0.01


def descriptor_of(sync: Any) -> Descriptor | None:
    """The descriptor that `sync` has now, None if there is none to be watched."""
    fd = sync.fd
    return None if fd is None or fd < 0 else (fd, getattr(sync, "port", None))


def watch(
    add: Callable[..., Any], descriptor: Descriptor | None, callback: Callable[[], Any]
) -> Descriptor | None:
    """Have `add`, a method of the loop, watch `descriptor`; None if that is not possible."""
    if descriptor is None:
        return None
    try:
        add(descriptor[0], callback)
    except (NotImplementedError, OSError, ValueError):
        return None
    return descriptor
