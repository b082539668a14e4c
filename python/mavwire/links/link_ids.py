"""Link ids that processes share out among themselves, by way of the timestamp store that they share.

Receivers take two processes with one link id for one stream. A stream may only rise, so they refuse the process
whose timestamps lie behind. Therefore each id in use has an empty file beside the store, which the process locks.
The system unlocks it at the end of the process, and the next process takes the same ids. Ids that only rise would
soon be too many: receivers have room for few streams, ArduPilot for 16.
"""

from __future__ import annotations

import os
from _thread import RLock

from . import Any, warn

# The locked file of each id -> its descriptor, which is open until the process ends.
_held: dict[str, int] = {}
# For them, and for what links with a key share. A fork leaves it free.
section = RLock()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=section._at_fork_reinit)  # type: ignore[attr-defined]


def claim(store: str | os.PathLike[str], link_id: int) -> bool:
    """Whether no other process uses `link_id` with the timestamp store at the path `store`; none will
    until this one has ended. True, too, where that cannot be known, which is logged if it could be
    on this system.
    """
    try:
        import fcntl
    except ImportError:
        return True
    path = f"{os.path.realpath(os.fsdecode(store))}.link{link_id}"
    try:
        with section:
            return _hold(path, fcntl)
    except OSError as error:
        warn("link ids of processes are not kept apart, give each a link_id: %s", error)
        return True


def _hold(path: str, fcntl: Any) -> bool:
    """Whether the file at `path` is locked by this process; OSError if that cannot be known."""
    if path in _held:
        return True
    fd = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        _held[path] = fd
    except BlockingIOError:
        return path in _held  # by a signal handler in between
    finally:
        if _held.get(path) != fd:
            os.close(fd)
    return True
