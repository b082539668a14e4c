"""What a fork leaves of what other threads were doing.

A forked process goes on with one thread, the one that forked. A lock that another one held stays locked there for ever, and
what that one was in the middle of stays half done, so that both are begun anew. Windows has no forks.
"""

from __future__ import annotations

import os
from _thread import allocate_lock
from _weakref import ref

TYPE_CHECKING = False
if TYPE_CHECKING:
    from _thread import LockType
    from collections.abc import Callable
    from typing import Any

# What has to be begun anew, and how.
_followers: dict[int, tuple[ref[Any], Callable[[Any], None]]] = {}


def follow_forks(one: Any, renew: Callable[[Any], None]) -> None:
    """Have `renew(one)` called in each process that is forked while `one` lives.

    It must import nothing and wait for no lock.
    """
    number = id(one)
    _followers[number] = (ref(one, lambda _: _followers.pop(number, None)), renew)


def _renew_all() -> None:
    for follower, renew in list(_followers.values()):
        one = follower()
        if one is not None:
            renew(one)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_all)


class Turn:
    """A lock that nobody waits for: whoever does not get it leaves the work to the one who has it."""

    def __init__(self) -> None:
        self._lock = allocate_lock()
        follow_forks(self, Turn._renew)

    def take(self) -> LockType | None:
        """What is to be released at the end of the turn; None while another thread has it."""
        lock = self._lock
        return lock if lock.acquire(blocking=False) else None

    def locked(self) -> bool:
        """Whether somebody has it."""
        return self._lock.locked()

    def _renew(self) -> None:
        if self._lock.locked():
            self._lock = allocate_lock()
