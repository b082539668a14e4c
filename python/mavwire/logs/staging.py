"""Folders for incomplete files: one for each run of a fleet, beside the files that are complete."""

from __future__ import annotations

import os
import shutil
import tempfile
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

PREFIX = ".mavwire-staging-"
"""No other program begins a name so: folders of killed runs are removed by it."""


@contextmanager
def staging(root: str) -> Iterator[str]:
    """The folder for incomplete files of one run, gone with what is left in it afterwards."""
    with (
        tempfile.TemporaryDirectory(prefix=PREFIX, dir=root, ignore_cleanup_errors=True) as folder,
        ExitStack() as stack,
    ):
        # Without locks of the file system no folder counts as left over.
        with suppress(OSError):
            stack.enter_context(_locked(folder))
        yield folder


def remove_left(root: str) -> None:
    """Remove the folders of runs that were killed: the lock that a run has on its folder ends with its
    process.
    """
    for name in os.listdir(root):
        if name.startswith(PREFIX):
            with suppress(OSError), _locked(os.path.join(root, name)) as folder:
                shutil.rmtree(folder)


@contextmanager
def _locked(folder: str) -> Iterator[str]:
    """A folder that no other process has locked; OSError if one has, or if the system has no such locks."""
    try:
        import fcntl
    except ImportError:
        raise OSError("no locks on folders here") from None
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield folder
    finally:
        os.close(descriptor)
