"""The journal of a manifest: a run that is killed loses no log that was finished and doubles none.

Each log is noted twice, before it is begun and when it is done. The former keeps its name for it,
and those of its parts, so that a later run writes over what the killed one may have left, or removes
it. An object store cannot add to a file: there only what is begun is noted at once.
"""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any

from .manifest import BEGUN, JOURNAL, VERSION, Converted, Manifest, stored_row

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .store import Files

__all__ = ["BEGUN", "Journal"]

PAUSE = 5.0
"""Seconds at least between two writings of the manifest,"""
SHARE = 50
"""and how many times as long as the last one took."""


class Journal:
    """Notes what becomes of logs, in a manifest and at once in the store."""

    def __init__(self, store: Files, manifest: Manifest) -> None:
        self._store = store
        self._manifest = manifest
        self._begun = False
        self._unwritten = False
        self._due = 0.0

    def begin(self, path: str, name: str, parts: Iterable[str] = ()) -> None:
        """A log is about to be converted, in parts if it is cut."""
        self._remove_drafts({path: name})
        self._add(self._manifest.begun(path, name, parts))

    def begin_all(self, names: dict[str, str]) -> None:
        """Many logs are about to be converted: they are noted together."""
        self._remove_drafts(names)
        for path, name in names.items():
            self._manifest.add(self._manifest.begun(path, name))
        self._begun = True
        self._fold()

    def finish(self, row: Converted) -> None:
        """A log is converted, or failed to be."""
        self._add(row)
        if time.monotonic() >= self._due:
            self._fold()

    def close(self) -> None:
        """Write the manifest. The journal is gone then."""
        if self._unwritten or self._manifest.has_journal:
            self._fold()

    def _remove_drafts(self, names: dict[str, str]) -> None:
        """Remove what a run that was killed left of the files of these logs."""
        rows = self._manifest.rows
        begun = [name for path, name in names.items() if path in rows and rows[path].error == BEGUN]
        if begun:
            self._store.remove_drafts(*begun)

    def _add(self, row: Converted) -> None:
        if not self._begun:
            self._begun = True
            self._fold()  # what an earlier run left is in the manifest then
        self._manifest.add(row)
        self._unwritten = True
        if not self._store.appends and row.error != BEGUN:
            return
        if not self._manifest.has_journal:
            self._manifest.has_journal = True
            self._append({"version": VERSION, "options": self._manifest.how})
        self._append(stored_row(row))

    def _fold(self) -> None:
        began = time.monotonic()
        self._manifest.store()
        self._unwritten = False
        now = time.monotonic()
        self._due = now + max(PAUSE, SHARE * (now - began))

    def _append(self, line: dict[str, Any]) -> None:
        self._store.append(JOURNAL, json.dumps(line).encode() + b"\n")
