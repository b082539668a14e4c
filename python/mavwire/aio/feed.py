"""The messages of a live link, for as many readers as there are.

A feed keeps the newest messages, up to a bound. Each reader has a position in the feed and gets every
message that arrives. Readers need not be registered or closed. A reader that falls behind by more than the
feed keeps skips messages, which are counted.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from typing import Any

from .errors import LinkClosedError, again
from .filters import Wants


class Position:
    """How far somebody has read. All that share it go on where one of them stopped."""

    __slots__ = ("__weakref__", "at", "dropped", "looked")

    def __init__(self, at: int) -> None:
        self.at = at
        # Unwanted messages up to here were looked at: they are not dropped when the feed loses them.
        self.looked = at
        self.dropped = 0


def check_backlog(backlog: int) -> None:
    """ValueError for a feed that could keep no message."""
    if backlog < 1:
        raise ValueError(f"a backlog of {backlog} messages holds none")


class Feed:
    """The newest `backlog` messages, and who waits for more."""

    def __init__(self, loop: asyncio.AbstractEventLoop, backlog: int) -> None:
        check_backlog(backlog)
        self.kept: deque[Any] = deque(maxlen=backlog)
        # Messages that were ever put in.
        self.count = 0
        # Messages that readers came too late for.
        self.dropped = 0
        self.ended: LinkClosedError | None = None
        self._loop = loop
        # Readers that wait and have to see each message before the next one is taken.
        self.in_step = 0
        self._waiting: dict[asyncio.Future[bool], Reader] = {}

    def reader(
        self,
        wants: Wants | None = None,
        position: Position | None = None,
        in_step: bool = False,
    ) -> Reader:
        """A reader at `position`, or one that begins with what comes next.

        `in_step`: while it waits it is asked about each message before the state of the link goes
        on, as conditions want it.
        """
        if position is None:
            position = Position(self.count)
        return Reader(self, position, wants, in_step)

    def add(self, messages: list[Any]) -> None:
        """Put in what arrived."""
        self.kept.extend(messages)
        self.count += len(messages)

    def tell(self) -> None:
        """Wake those whose messages have come."""
        for future, reader in list(self._waiting.items()):
            if future.done():
                continue
            try:
                if reader.look():
                    future.set_result(True)
            except Exception as error:  # a condition that cannot be evaluated
                future.set_exception(error)

    def fail(self, error: BaseException) -> bool:
        """Raise an error of reading in all waiting readers; whether there are any."""
        return self._fail(lambda: error)

    def _fail(self, error: Callable[[], BaseException]) -> bool:
        waiting = [future for future in self._waiting if not future.done()]
        for future in waiting:
            future.set_exception(error())
        return bool(waiting)

    def end(self, error: LinkClosedError) -> None:
        """Nothing comes any more: readers get what is left, then errors like `error`."""
        if self.ended is None:
            self.ended = error
            self._fail(lambda: again(error))

    async def wait(self, reader: Reader, deadline: float | None) -> bool:
        """Wait until `reader` has found a message; False if `deadline` came first."""
        if self.ended is not None:
            raise again(self.ended)
        future = self._loop.create_future()
        self._waiting[future] = reader
        self.in_step += reader.in_step
        timer = None if deadline is None else self._loop.call_at(deadline, _expire, future)
        try:
            found: bool = await future
            return found
        finally:
            del self._waiting[future]
            self.in_step -= reader.in_step
            if timer is not None:
                timer.cancel()


def _expire(future: asyncio.Future[bool]) -> None:
    if not future.done():
        future.set_result(False)


class Reader:
    """Reads wanted messages from a feed. The position moves when a message is taken, never before:
    a wait that is cancelled loses nothing."""

    __slots__ = ("_at", "_feed", "_found", "_wants", "in_step", "position")

    def __init__(
        self, feed: Feed, position: Position, wants: Wants | None, in_step: bool = False
    ) -> None:
        self.in_step = in_step
        self.position = position
        self._feed = feed
        self._wants = wants
        self._at = position.at
        self._found: Any = None

    def take(self) -> Any:
        """The next wanted message that is there; None if none is."""
        feed, position = self._feed, self.position
        if self._wants is None:  # the usual case of a loop over everything
            behind = feed.count - position.at
            if 0 < behind <= len(feed.kept):
                position.at += 1
                self._found = None  # by another task, which has not come to take it
                return feed.kept[-behind]
        self._at, self._found = position.at, None
        return self._taken() if self.look() else None

    async def next(self, deadline: float | None = None) -> Any:
        """The next wanted message; None if the loop's time reaches `deadline` first."""
        while True:
            msg = self.take()
            if msg is not None:
                return msg
            if not await self._feed.wait(self, deadline):
                self._move()
                return None
            if self._found is not None:  # unless another task took it, who reads with this reader
                return self._taken()

    def skip(self) -> None:
        """Go on with what comes from now on."""
        self.position.at = self._feed.count

    def look(self) -> bool:
        """Look for a wanted message, from where the last look ended."""
        if self._found is not None:
            return True
        feed, wants = self._feed, self._wants
        behind = feed.count - self._at
        if behind > len(feed.kept):
            behind = len(feed.kept)
            self._overrun(feed.count - behind)
        while behind:
            msg = feed.kept[-behind]
            behind -= 1
            if wants is None or wants(msg):
                self._found = msg
                break
        self._at = feed.count - behind
        self.position.looked = max(self.position.looked, self._at - (self._found is not None))
        return self._found is not None

    def _overrun(self, oldest: int) -> None:
        """Count what the feed does not keep any more."""
        position = self.position
        lost = oldest - max(self._at, position.looked)
        if lost > 0:
            position.dropped += lost
            self._feed.dropped += lost
        position.looked = max(position.looked, oldest)

    def _move(self) -> None:
        self.position.at = max(self.position.at, self._at)

    def _taken(self) -> Any:
        msg, self._found = self._found, None
        self._move()
        return msg
