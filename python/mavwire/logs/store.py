"""Where converted files and their manifest go: a folder."""

from __future__ import annotations

import errno
import os
import re
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Protocol

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

from mavwire._atomic_file import replacing

from .formats import SUFFIXES

PREFIX = ".mavwire-staging-"
"""That of folders for incomplete files: no other program begins a name so, and those of killed runs are removed by it."""
_DRAFT = re.compile(r"(.+)\.\d+-[0-9a-f]+\.part", re.DOTALL)


class Files(Protocol):
    """The store of a manifest."""

    def names(self) -> Iterator[str]: ...
    def place(self, name: str) -> str: ...
    def has_content(self, name: str) -> bool: ...
    def read(self, name: str) -> bytes | None: ...
    def write(self, name: str, content: bytes) -> None: ...
    def remove(self, name: str) -> None: ...
    def remove_drafts(self) -> None: ...


class Store:
    """A local folder. Names are paths below it, with `/`."""

    def __init__(self, root: str) -> None:
        self.root = root
        if not root:
            raise ValueError("the folder for the files has an empty name")
        self._is_new = not os.path.lexists(root)
        try:
            os.makedirs(root, exist_ok=True)
        except FileExistsError:  # a file, or a link that leads nowhere
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), root) from None

    def place(self, name: str) -> str:
        """The path of a file."""
        return os.path.join(self.root, *name.split("/"))

    def names(self) -> Iterator[str]:
        """The files in it and in its folders."""
        for one in os.scandir(self.root):
            if one.is_dir(follow_symlinks=False):
                yield from (f"{one.name}/{name}" for name in os.listdir(one.path))
            else:
                yield one.name

    def has_content(self, name: str) -> bool:
        """Whether the file exists and is not empty."""
        try:
            return os.path.getsize(self.place(name)) > 0
        except OSError:
            return False

    def read(self, name: str) -> bytes | None:
        """The content of a file; None where there is none. OSError for what is no file."""
        path = self.place(name)
        if not os.path.lexists(path):
            return None
        with open(path, "rb") as file:
            return file.read()

    def write(self, name: str, content: bytes) -> None:
        """Write or replace a file, which is never seen half written."""
        write_file(self.place(name), content)

    def remove(self, name: str) -> None:
        """Remove a file, if it is there, and the folder of a type in which nothing is left then."""
        try:
            os.remove(self.place(name))
        except FileNotFoundError:
            return
        self.remove_empty(name)

    def remove_empty(self, name: str) -> None:
        """Remove the folder of a file that is not there, if nothing else is in it."""
        if "/" in name:
            with suppress(OSError):
                os.rmdir(os.path.dirname(self.place(name)))

    @contextmanager
    def locked(self, wait: bool = False) -> Iterator[None]:
        """Keep other runs from writing to the folder. ValueError where one does so already, unless it is
        to `wait` for that. A folder that was made for a run and that is empty afterwards is removed.
        """
        try:
            with self._lock(wait):
                yield
        finally:
            if self._is_new:
                with suppress(OSError):
                    os.rmdir(self.root)

    @contextmanager
    def _lock(self, wait: bool) -> Iterator[None]:
        if fcntl is None:
            yield
            return
        folder = os.open(self.root, os.O_RDONLY)
        try:
            try:
                fcntl.flock(folder, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
            except BlockingIOError:
                raise ValueError(
                    f"another conversion is writing to {self.root}: wait for it, or choose another folder"
                ) from None
            except OSError:
                pass  # a file system without locks
            yield
        finally:
            os.close(folder)

    def remove_drafts(self) -> None:
        """Remove the incomplete files that a run left which was killed."""
        folders = [entry.path for entry in os.scandir(self.root) if entry.is_dir()]
        for folder in [self.root, *folders]:
            for entry in list(os.scandir(folder)):
                if is_draft(entry.name):
                    os.remove(entry.path)


def is_draft(name: str) -> bool:
    """Whether a file is called as incomplete ones of a conversion, or of the manifest, are. Long names are replaced
    by `mavwire-...`.
    """
    draft = _DRAFT.fullmatch(name)
    stem = "" if draft is None else draft[1]
    return stem.startswith("mavwire-") or any(suffix in stem for suffix in (*SUFFIXES, ".json"))


def write_file(path: str, content: bytes | Iterable[str]) -> None:
    """Write or replace a file, which is never seen half written, with bytes or with pieces of text.
    An OSError names it.
    """
    pieces = [content] if isinstance(content, bytes) else map(str.encode, content)
    with replacing(path) as file:
        file.writelines(pieces)
        file.flush()
        os.fsync(file.fileno())


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
