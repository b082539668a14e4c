"""Where a fleet's files go: a folder, or a place of fsspec."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from mavwire.logs.store import Store

from .places import file_system, is_url

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


class Folder(Store):
    """A local folder, on a disk that all workers see."""

    def publish(self, draft: str, name: str) -> None:
        """Give a file of the same disk its name, in place of any that has it."""
        place = self.place(name)
        os.makedirs(os.path.dirname(place), exist_ok=True)
        os.replace(draft, place)


class Remote:
    """A place that fsspec opens. Object stores show an object when all of it is there."""

    appends = False

    def __init__(self, url: str, options: Mapping[str, Any] | None = None) -> None:
        self.root = url.rstrip("/")
        self.fs, self._inner = file_system(self.root, options)
        self._found: set[str] | None = None
        """What was there when it was first asked for: a request for all, not one for each."""
        self._appended: dict[str, bytes] = {}

    def place(self, name: str) -> str:
        """The URL of a file."""
        return f"{self.root}/{name}"

    def _path(self, name: str) -> str:
        return f"{self._inner.rstrip('/')}/{name}"

    def exists(self, name: str) -> bool:
        """Whether there was such a file when this was first asked."""
        return self.fs._strip_protocol(self._path(name)) in self._listing()

    def names(self) -> Iterator[str]:
        """The files that there are."""
        self._found = None
        root = self.fs._strip_protocol(self._path(""))
        for path in self._listing():
            yield path.removeprefix(root).lstrip("/")

    def _listing(self) -> set[str]:
        if self._found is None:
            self.fs.invalidate_cache()
            self._found = set(self.fs.find(self._inner))
        return self._found

    def read(self, name: str) -> bytes | None:
        """The content of a file; None where there is none."""
        try:
            return bytes(self.fs.cat_file(self._path(name)))
        except FileNotFoundError:
            return None

    def write(self, name: str, content: bytes) -> None:
        """Write or replace a file."""
        self.fs.makedirs(os.path.dirname(self._path(name)), exist_ok=True)
        self.fs.pipe_file(self._path(name), content)

    def append(self, name: str, content: bytes) -> None:
        """Add to what this object has written, as there is no way to add to a file."""
        self._appended[name] = self._appended.get(name, b"") + content
        self.write(name, self._appended[name])

    def publish(self, draft: str, name: str) -> None:
        """Copy a local file there, in place of any that has the name."""
        self.fs.makedirs(os.path.dirname(self._path(name)), exist_ok=True)
        self.fs.put_file(draft, self._path(name))

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Nothing: such a place has no locks that end with the process which has them."""
        yield

    def remove_drafts(self, name: str) -> None:
        """Nothing: files appear in a store when they are complete."""

    def remove(self, name: str) -> None:
        """Remove a file, if it is there."""
        self._appended.pop(name, None)
        try:
            self.fs.rm_file(self._path(name))
        except FileNotFoundError:
            pass


def store_of(out: str, options: Mapping[str, Any] | None = None) -> Folder | Remote:
    """The store of a path or URL."""
    return Remote(out, options) if is_url(out) else Folder(out)
