"""Getting a lost connection back: again and again, with growing pauses."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress

from mavwire.links.reconnecting import Backoff

Done = Callable[[], None]
Failed = Callable[[BaseException], None]


class Reconnecting:
    """Calls `reopen` until it succeeds. Any error but OSError is a defect, and ends it."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, reopen: Callable[[], Awaitable[None]], delay: float
    ) -> None:
        self._loop = loop
        self._reopen = reopen
        self._delay = delay
        self._backoff = Backoff()
        self._task: asyncio.Task[None] | None = None

    def start(self, at_once: bool, done: Done, failed: Failed) -> None:
        """Begin, without a pause if `at_once`: a peer that has nothing else to do than to hang up gets pauses too."""
        if at_once:
            self._backoff.reset()
        self._task = self._loop.create_task(self._run(at_once, done, failed))

    async def stop(self) -> None:
        """Give up."""
        if self._task is not None and not self._task.done():
            self._task.cancel()
            with suppress(asyncio.CancelledError):
                await self._task

    async def _run(self, at_once: bool, done: Done, failed: Failed) -> None:
        while True:
            if not at_once:
                await asyncio.sleep(self._backoff.next_pause(self._delay))
            at_once = False
            try:
                await self._reopen()
            except OSError:
                continue
            except Exception as error:
                failed(error)
                return
            done()
            return
