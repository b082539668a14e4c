"""Where a fleet's files go: a folder, or a place of fsspec."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any

from mavwire._atomic_file import draft_of
from mavwire.logs.store import Store, is_draft

from .places import file_system, is_url

OBJECT_STORES = frozenset(
    {"s3", "s3a", "gs", "gcs", "az", "abfs", "abfss", "adl", "oci", "ocilake", "oss", "memory"}
)
"""Protocols of places at which a file appears when all of it is there."""


class Folder(Store):
    """A local folder, on a disk that all workers see."""

    def publish(self, draft: str, name: str) -> None:
        """Give a file of the same disk its name, in place of any that has it."""
        try:
            self._rename(draft, name)
        except OSError as error:
            self.remove_empty(name)
            if error.filename2 is not None:  # beside a draft, whose name means nothing to anybody
                error.filename, error.filename2 = self.place(name), None
            raise

    def _rename(self, draft: str, name: str) -> None:
        place = self.place(name)
        for is_last in (False, True):
            os.makedirs(os.path.dirname(place), exist_ok=True)
            try:
                return os.replace(draft, place)
            except FileNotFoundError:  # a folder that another process found empty, and removed
                if is_last:
                    raise


class Remote:
    """A place that fsspec opens. Object stores show an object when all of it is there; elsewhere a
    file gets its name when it is complete.
    """

    def __init__(self, url: str, options: Mapping[str, Any] | None = None) -> None:
        self.root = url.rstrip("/")
        self.fs, self._inner = file_system(self.root, options)
        self._found: dict[str, int | None] | None = None
        """The files at the first look: one request for all of them."""
        kinds = self.fs.protocol
        self._whole = not OBJECT_STORES.isdisjoint([kinds] if isinstance(kinds, str) else kinds)
        """Whether nobody sees half of a file."""

    def place(self, name: str) -> str:
        """The URL of a file."""
        return f"{self.root}/{name}"

    def _path(self, name: str) -> str:
        return f"{self._inner.rstrip('/')}/{name}"

    def has_content(self, name: str) -> bool:
        """Whether the file existed and was not empty at the first look."""
        return self._listing().get(self.fs._strip_protocol(self._path(name)), 0) != 0

    def names(self) -> Iterator[str]:
        """The files that there are."""
        self._found = None
        root = self.fs._strip_protocol(self._path(""))
        for path in self._listing():
            yield path.removeprefix(root).lstrip("/")

    def _listing(self) -> dict[str, int | None]:
        """Files and their sizes, where those are known."""
        if self._found is None:
            self.fs.invalidate_cache()
            found = self.fs.find(self._inner, detail=True)
            self._found = {path: told.get("size") for path, told in found.items()}
        return self._found

    def read(self, name: str) -> bytes | None:
        """The content of a file; None where there is none."""
        try:
            return bytes(self.fs.cat_file(self._path(name)))
        except FileNotFoundError:
            return None

    def write(self, name: str, content: bytes) -> None:
        """Write or replace a file, which is never seen half written."""
        self._put(self._path(name), lambda path: self.fs.pipe_file(path, content))

    def _put(self, path: str, put: Callable[[str], object]) -> None:
        self.fs.makedirs(os.path.dirname(path), exist_ok=True)
        if self._whole:
            put(path)
            return
        draft = draft_of(path)
        try:
            put(draft)
            try:
                self.fs.mv(draft, path)
            except OSError:  # some move nothing to where a file is
                if not self.fs.exists(path):
                    raise
                self.fs.rm_file(path)
                self.fs.mv(draft, path)
        except BaseException:
            with suppress(Exception):
                self.fs.rm_file(draft)
            raise

    def publish(self, draft: str, name: str) -> None:
        """Copy a local file there, in place of any that has the name."""
        self._put(self._path(name), lambda path: self.fs.put_file(draft, path))

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Do nothing: object stores have no locks that end with their process."""
        yield

    def remove_drafts(self) -> None:
        """Remove the incomplete files that a run left which was killed."""
        for one in [] if self._whole else list(self.names()):
            if is_draft(os.path.basename(one)):
                self.fs.rm_file(self._path(one))

    def remove(self, name: str) -> None:
        """Remove a file, if it is there."""
        try:
            self.fs.rm_file(self._path(name))
        except FileNotFoundError:
            pass


def store_of(out: str, options: Mapping[str, Any] | None = None) -> Folder | Remote:
    """The store of a path or URL."""
    return Remote(out, options) if is_url(out) else Folder(out)
