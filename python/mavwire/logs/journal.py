"""The journal of a manifest: a run that is killed loses no log that was finished and doubles none.

Each log has two lines, one before it is begun and one when it is done. The former keeps its name
for it, so that a later run writes over what the killed one may have left.
"""

from __future__ import annotations

import json
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from .manifest import JOURNAL, VERSION, Converted, Manifest, stored_row

if TYPE_CHECKING:
    from .store import Store

PAUSE = 5.0
"""Seconds at least between two writings of the manifest,"""
SHARE = 50
"""and how many times as long as the last one took."""
BEGUN = "the conversion was interrupted"


class Journal:
    """Notes what becomes of logs, in a manifest and at once on the disk."""

    def __init__(self, store: Store, manifest: Manifest) -> None:
        self._store = store
        self._manifest = manifest
        self._begun = False
        self._due = 0.0

    def begin(self, path: str, name: str) -> None:
        """A log is about to be converted."""
        earlier = self._manifest.rows.get(path, Converted(path, name))
        if earlier.error == BEGUN:
            self._store.remove_drafts(name)
        self._add(replace(earlier, rows=0, error=BEGUN))

    def finish(self, row: Converted) -> None:
        """A log is converted, or failed to be."""
        self._add(row)
        if time.monotonic() >= self._due:
            self._fold()

    def close(self) -> None:
        """Write the manifest. The journal is gone then."""
        if self._manifest.has_journal:
            self._manifest.store()

    def _add(self, row: Converted) -> None:
        if not self._begun:
            self._begun = True
            self._fold()  # what an earlier run left is in the manifest then
        self._manifest.add(row)
        if not self._manifest.has_journal:
            self._manifest.has_journal = True
            self._append({"version": VERSION, "options": self._manifest.how})
        self._append(stored_row(row))

    def _fold(self) -> None:
        began = time.monotonic()
        self._manifest.store()
        now = time.monotonic()
        self._due = now + max(PAUSE, SHARE * (now - began))

    def _append(self, line: dict[str, Any]) -> None:
        self._store.append(JOURNAL, json.dumps(line).encode() + b"\n")
