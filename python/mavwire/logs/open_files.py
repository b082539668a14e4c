"""The limit of open files: a conversion has one for each type that it writes."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager, suppress

try:
    import resource
except ImportError:  # Windows, which has no such limit
    resource = None  # type: ignore[assignment]


UNLIMITED = 10_240
"""The number to ask for where the hard limit is infinite: macOS takes no more."""


@contextmanager
def many_open_files() -> Iterator[None]:
    """Raise the limit of the process to the hard one. An error that more files are open tells what to
    do.
    """
    if resource is not None:
        _raise_limit()
    try:
        yield
    except OSError as error:
        if error.errno == errno.EMFILE:
            told = "each type has a file: choose some types with --types, or raise `ulimit -n`"
            raise OSError(errno.EMFILE, f"{error.strerror} ({told})", error.filename) from error
        raise


def _raise_limit() -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = UNLIMITED if hard == resource.RLIM_INFINITY else hard
    if soft != resource.RLIM_INFINITY and soft < most:
        with suppress(ValueError, OSError):  # some systems have yet another limit
            resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
