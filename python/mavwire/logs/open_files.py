"""How many files may be open at once: a conversion has one for each type that it writes."""

from __future__ import annotations

import errno
import os
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

try:
    import resource
except ImportError:  # Windows, which has no such limit
    resource = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator

UNLIMITED = 10_240
"""What is asked for where a system says that there is no limit: macOS takes no more."""


class _Limit:
    """The soft limit, raised while somebody needs it: threads convert side by side."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.users = 0
        self.before: tuple[int, int] | None = None

    def enter(self) -> None:
        with self.lock:
            self.users += 1
            if self.users == 1:
                self.before = _raised()

    def leave(self) -> None:
        with self.lock:
            self.users -= 1
            if not self.users and self.before is not None:
                resource.setrlimit(resource.RLIMIT_NOFILE, self.before)

    def renew(self) -> None:
        """In a forked process no other thread is left to unlock it."""
        self.lock = threading.Lock()


_limit = _Limit()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_limit.renew)


@contextmanager
def many_open_files() -> Iterator[None]:
    """While it lasts, as many files may be open as the system lets a process have. An error that
    there are more says what to do.
    """
    if resource is not None:
        _limit.enter()
    try:
        yield
    except OSError as error:
        if error.errno == errno.EMFILE:
            told = "each type has a file: choose some types with --types, or raise `ulimit -n`"
            raise OSError(errno.EMFILE, f"{error.strerror} ({told})", error.filename) from error
        raise
    finally:
        if resource is not None:
            _limit.leave()


def _raised() -> tuple[int, int] | None:
    """Raise the soft limit to the hard one; the limits of before, None where they stay."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY:
        return None
    most = UNLIMITED if hard == resource.RLIM_INFINITY else hard
    if most <= soft:
        return None
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
    except (ValueError, OSError):  # some systems have yet another limit
        return None
    return soft, hard
