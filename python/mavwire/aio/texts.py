"""Status texts of vehicles, those of several messages as one."""

from __future__ import annotations

from collections import deque
from typing import Any, NamedTuple

from mavwire._native import StatusTexts

from .stream import Stream


class StatusText(NamedTuple):
    """A whole text, and the message that it begins in, which has its severity and sender."""

    text: str
    message: Any


class Texts:
    """Whole texts, in the order in which they end. It ends as a `Stream` does."""

    def __init__(self, stream: Stream) -> None:
        self._stream = stream
        self._joined = StatusTexts()
        self._ready: deque[StatusText] = deque()
        self._at_end = False

    @property
    def dropped(self) -> int:
        """Messages that the link did not keep until they were read here."""
        return self._stream.dropped

    def __aiter__(self) -> Texts:
        return self

    async def __anext__(self) -> StatusText:
        while not self._ready:
            if self._at_end:
                raise StopAsyncIteration
            try:
                found = self._joined.hear(await anext(self._stream))
            except StopAsyncIteration:  # of a text that lacks its end, what came is told
                self._at_end = True
                found = self._joined.finish()
            self._ready.extend(
                StatusText(text.decode("utf-8", "replace"), msg) for msg, text in found
            )
        return self._ready.popleft()
