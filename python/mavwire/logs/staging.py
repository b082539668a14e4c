"""Folders for incomplete files: one for each run of a fleet, beside the files that are complete."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

PREFIX = ".mavwire-staging-"
"""No other program begins a name so: folders of killed runs are removed by it."""


@contextmanager
def staging(root: str) -> Iterator[str]:
    """The folder for incomplete files of one run, gone with what is left in it afterwards."""
    with tempfile.TemporaryDirectory(prefix=PREFIX, dir=root, ignore_cleanup_errors=True) as folder:
        yield folder


def remove_left(root: str) -> None:
    """Remove the folders of runs that were killed. The store is locked: no other run is under way."""
    for name in os.listdir(root):
        if name.startswith(PREFIX):
            shutil.rmtree(os.path.join(root, name), ignore_errors=True)
