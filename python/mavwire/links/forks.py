"""What a fork leaves of what other threads were doing.

A forked process goes on with one thread, the one that forked. A lock that another one held stays locked there for ever, and
what that one was in the middle of stays half done, so that both are begun anew. Windows has no forks.
"""

from __future__ import annotations

import os
from _weakref import ref
from itertools import count

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

# What has to be begun anew, and how. What is gone stays here for a while: in the callback of a weak reference, exceptions
# of signal handlers would be lost.
_followers: dict[int, tuple[ref[Any], Callable[[Any], None]]] = {}
_numbers = count()
MIN_FOLLOWERS = 64
_most = MIN_FOLLOWERS


def follow_forks(one: Any, renew: Callable[[Any], None]) -> None:
    """Have `renew(one)` called in each process that is forked while `one` lives.

    It must import nothing and wait for no lock.
    """
    if len(_followers) >= _most:
        _forget_dead()
    _followers[next(_numbers)] = ref(one), renew


def _forget_dead() -> None:
    global _most
    for number, (follower, _) in list(_followers.items()):
        if follower() is None:
            _followers.pop(number, None)
    _most = 2 * len(_followers) + MIN_FOLLOWERS


def _renew_all() -> None:
    for follower, renew in list(_followers.values()):
        one = follower()
        if one is not None:
            renew(one)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_all)
