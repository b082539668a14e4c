"""A registry of weak references that runs no callback.

The callbacks of a WeakSet may run in a signal handler, and an exception there would be lost.
"""

from __future__ import annotations

from _weakref import ref
from itertools import count

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

# So many are noted before the dead ones are forgotten.
MIN_NOTED = 64


class WeakRegistry:
    """Objects, weakly held. Threads may note, forget and look through them at any time."""

    def __init__(self) -> None:
        self._noted: dict[int, ref[Any]] = {}
        self._numbers = count()
        self._most = MIN_NOTED

    def __iter__(self) -> Iterator[Any]:
        for noted in list(self._noted.values()):
            one = noted()
            if one is not None:
                yield one

    def add(self, one: Any) -> None:
        """Note `one`."""
        if len(self._noted) >= self._most:
            self._forget(None)
            self._most = 2 * len(self._noted) + MIN_NOTED
        self._noted[next(self._numbers)] = ref(one)

    def discard(self, one: Any) -> None:
        """Forget `one`, if it was noted."""
        self._forget(one)

    def _forget(self, one: Any | None) -> None:
        """Forget `one`, or what is dead."""
        for number in list(self._noted):
            noted = self._noted.get(number)
            if noted is not None and noted() is one:
                self._noted.pop(number, None)
