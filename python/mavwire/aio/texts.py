"""Status texts of vehicles. Texts that several messages carry are joined."""

from __future__ import annotations

from collections import deque
from typing import Any, NamedTuple

from mavwire._native import StatusTexts

from .stream import Stream


class StatusText(NamedTuple):
    """A whole text, and its first message, which has the severity and the sender."""

    text: str
    message: Any


class Texts:
    """Whole texts, in the order in which they end. The iteration ends as that of a `Stream`."""

    def __init__(self, stream: Stream) -> None:
        self._stream = stream
        self._joined = StatusTexts()
        self._ready: deque[StatusText] = deque()
        self._at_end = False

    @property
    def dropped(self) -> int:
        """The number of messages that were dropped because this iterator was too slow."""
        return self._stream.dropped

    def __aiter__(self) -> Texts:
        return self

    async def __anext__(self) -> StatusText:
        while not self._ready:
            if self._at_end:
                raise StopAsyncIteration
            try:
                found = self._joined.hear(await anext(self._stream))
            except StopAsyncIteration:  # incomplete texts come last
                self._at_end = True
                found = self._joined.finish()
            self._ready.extend(
                StatusText(text.decode("utf-8", "replace"), msg) for msg, text in found
            )
        return self._ready.popleft()
