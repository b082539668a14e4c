"""Where a download goes: a file that appears when it is complete, memory, or standard output; and the
file that an upload comes from.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import sys
from typing import IO

from mavwire._atomic_file import Replacement, is_replaceable
from mavwire._native import is_device


def local_name(remote: str) -> str:
    """The name of a remote file in the current directory; ValueError when it has none.

    A path that the vehicle named leads to no other directory, and to no device of Windows.
    """
    name = last_name(remote)
    return f"%{ord(name[0]):02X}{name[1:]}" if is_device(name) else name


def last_name(remote: str) -> str:
    """The part of a path after its last slash; ValueError when it names no file."""
    name = remote.replace("\\", "/").rpartition("/")[2]
    if name in ("", ".", "..") or "\0" in name:
        raise ValueError(f"no file name in {remote!r}")
    return name


def open_source(path: str) -> IO[bytes]:
    """A file to send; OSError for one that cannot be read, from any place in it."""
    is_pipe = stat.S_ISFIFO(os.stat(path).st_mode)  # which opening may wait for
    source = None if is_pipe else open(path, "rb")
    if source is not None and source.seekable():
        return source
    if source is not None:
        source.close()
    raise OSError(errno.ESPIPE, "a pipe, of which nothing can be read again", path)


class LocalFile(Replacement):
    """A file that is written beside its place and moved there when it is complete."""

    def __init__(self, path: str, remote: str) -> None:
        path = os.path.join(path, local_name(remote)) if os.path.isdir(path) else path
        if not is_replaceable(path):  # blocks come in any order
            raise OSError(errno.ESPIPE, "a pipe or a device: download to a file", path)
        super().__init__(path)


class Memory:
    """A file in memory, which may be copied to standard output."""

    def __init__(self, print_it: bool = False) -> None:
        self.path = "-"
        self.file: IO[bytes] = io.BytesIO()
        self._print_it = print_it

    def finish(self) -> None:
        """Rewind it, and print it if that is wanted."""
        self.file.seek(0)
        if self._print_it:
            sys.stdout.flush()
            sys.stdout.buffer.write(self.file.read())
            sys.stdout.buffer.flush()
            self.file.seek(0)

    def discard(self) -> None:
        """Nothing stays of it."""


Destination = LocalFile | Memory
