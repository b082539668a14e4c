"""Messages to iterate over: every one of them, or always the newest."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .errors import LinkClosedError
from .feed import Reader
from .log_feed import LogReader


class Stream:
    """Every wanted message, in order. It ends when the link is closed or the log has been read.

    Several tasks may read one stream: each message goes to one of them.
    """

    def __init__(self, reader: Reader | LogReader) -> None:
        self._reader = reader

    @property
    def dropped(self) -> int:
        """Messages that the link did not keep until they were read here."""
        return self._reader.position.dropped

    def __aiter__(self) -> Stream:
        return self

    async def __anext__(self) -> Any:
        msg = self._reader.take()
        if msg is None:
            try:
                msg = await self._reader.next()
            except LinkClosedError as end:
                raise _iteration_ends(end) from end.__cause__
        return msg


class Newest:
    """The newest message of a type, whenever there is a newer one than the last time.

    Older messages that arrived while the consumer was busy are passed over. It ends as a `Stream` does.
    """

    def __init__(self, reader: Reader | LogReader, latest: Callable[[], Any]) -> None:
        self._reader = reader
        self._latest = latest
        self._last: Any = None

    def __aiter__(self) -> Newest:
        return self

    async def __anext__(self) -> Any:
        try:
            self._last = await newer(self._reader, self._latest, self._last)
        except LinkClosedError as end:
            raise _iteration_ends(end) from end.__cause__
        return self._last


async def newer(
    reader: Reader | LogReader, latest: Callable[[], Any], than: Any, deadline: float | None = None
) -> Any:
    """The newest message as soon as it is another than `than`; None at `deadline`."""
    while True:
        msg = latest()
        if msg is not None and msg is not than:
            return msg
        reader.skip()
        if await reader.next(deadline) is None:
            return None


def _iteration_ends(end: LinkClosedError) -> Exception:
    """A loop ends quietly with the link, but not when the link failed."""
    return StopAsyncIteration() if end.__cause__ is None else end
