"""What a fork leaves of what other threads were doing.

A forked process goes on with one thread, the one that forked. A lock that another one held stays locked there for ever, and
what that one was in the middle of stays half done, so that both are begun anew. Windows has no forks.
"""

from __future__ import annotations

import os

from .weak_registry import WeakRegistry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

# How something is begun anew -> what has to be.
_followers: dict[Callable[[Any], None], WeakRegistry] = {}


def follow_forks(one: Any, renew: Callable[[Any], None]) -> None:
    """Have `renew(one)` called in each process that is forked while `one` lives.

    It must import nothing and wait for no lock.
    """
    _followers.setdefault(renew, WeakRegistry()).add(one)


def _renew_all() -> None:
    for renew, followers in list(_followers.items()):
        for one in followers:
            renew(one)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_all)
