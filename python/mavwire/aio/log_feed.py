"""The messages of a log: read when somebody asks, in slices, so that the loop can do other things.

A log has one position, as in mavutil: what one task reads another does not meet. Nothing is read
ahead, so that `messages`, `flightmode` and conditions are in step with the message in hand.
"""

from __future__ import annotations

import asyncio
from typing import Any

from .errors import EndOfLogError, LinkClosedError, again
from .feed import Position
from .filters import Wants

# Records that are read before others get their turn: about 0.1 ms.
SLICE = 256


class LogFeed:
    """Reads `sync`, a log reader of mavutil."""

    dropped = 0

    def __init__(self, loop: asyncio.AbstractEventLoop, sync: Any) -> None:
        self.loop = loop
        self.ended: LinkClosedError | None = None
        self._sync = sync
        self._position = Position(0)
        self._left = SLICE
        self._at_end = False

    def reader(
        self,
        wants: Wants | None = None,
        position: Position | None = None,
        in_step: bool = True,
    ) -> LogReader:
        """A reader; all of them share the log's position."""
        return LogReader(self, self._position, wants)

    def read(self, wants: Wants | None) -> Any:
        """The next wanted message; None at the end of the slice and of the log."""
        if self.ended is not None:
            return None
        while self._left:
            self._left -= 1
            msg = self._sync.recv_msg()
            if msg is None:
                self._at_end = True
                return None
            if wants is None or wants(msg):
                return msg
        return None

    async def pause(self) -> None:
        """Let others run between two slices. EndOfLogError when there is nothing left to be read."""
        if self.ended is not None:
            raise again(self.ended)
        if self._at_end:
            self._at_end = False  # it may grow, or be rewound
            raise EndOfLogError("the log has been read")
        await asyncio.sleep(0)
        self._left = SLICE

    def end(self, error: LinkClosedError) -> None:
        """Nothing is read any more."""
        self.ended = error


class LogReader:
    """Reads wanted messages from a log."""

    __slots__ = ("_feed", "_wants", "position")

    def __init__(self, feed: LogFeed, position: Position, wants: Wants | None) -> None:
        self.position = position
        self._feed = feed
        self._wants = wants

    def take(self) -> Any:
        """The next wanted message of this slice; None if there is none in it."""
        return self._feed.read(self._wants)

    async def next(self, deadline: float | None = None) -> Any:
        """The next wanted message; None if the loop's time reaches `deadline` first."""
        while True:
            msg = self.take()
            if msg is not None:
                return msg
            if deadline is not None and self._feed.loop.time() >= deadline:
                return None
            await self._feed.pause()

    def skip(self) -> None:
        """Nothing was read ahead."""
