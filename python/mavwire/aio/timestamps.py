"""Signing timestamps on their way to a disk, which the loop does not wait for.

No timestamp may be used before a later one is stored. So one far enough ahead is stored at first, and the
next one by a thread, long before the first one is reached.
"""

from __future__ import annotations

import threading
from contextlib import suppress
from typing import Any

from mavwire._threads import NoThreadError, start_thread
from mavwire.links.signing_time import UNITS_PER_SECOND
from mavwire.links.timestamp_store import ahead, store_of

# How far ahead of what a link wants stored is stored, and how little of it may be left.
AHEAD = 30 * UNITS_PER_SECOND
LEAST = 25 * UNITS_PER_SECOND


class AheadStore:
    """A timestamp store for `setup_signing`, in front of one that may be slow: `store`, the path of a
    file or an object with `load` and `save`. Errors are those of the store.
    """

    def __init__(self, store: Any) -> None:
        self._store = store_of(store)
        self._claim = getattr(self._store, "_claim", None)
        self._stored = 0
        self._thread: threading.Thread | None = None

    def load(self) -> Any:
        """The timestamp to go on from."""
        return self._store.load()

    def save(self, timestamp: int) -> None:
        """See to it that `timestamp` or a later one is stored. It waits for the store at first, and after
        a pause so long that what is stored is used up."""
        if timestamp > self._stored:
            self._save(timestamp)
        elif self._stored - timestamp < LEAST and not self._is_saving():
            with suppress(NoThreadError):  # the next call tries again
                self._thread = start_thread(lambda: self._save_beside(timestamp), "mavwire.aio")

    def _is_saving(self) -> bool:
        return self._thread is not None and self._thread.is_alive()

    def _save_beside(self, timestamp: int) -> None:
        # Should it fail, `save` will meet the error itself when the rest is used up, and tell.
        with suppress(Exception):
            self._save(timestamp)

    def _save(self, timestamp: int) -> None:
        mark = ahead(timestamp, AHEAD)
        self._store.save(mark)
        self._stored = max(self._stored, mark)
