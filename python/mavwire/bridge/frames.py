"""The frames of a bridge in batches, for a `for` loop or an `async for` loop."""

from __future__ import annotations

import threading
import weakref
from contextlib import suppress

from mavwire._threads import start_thread

TYPE_CHECKING = False
if TYPE_CHECKING:
    import asyncio
    from concurrent.futures import Future
    from typing import Self

    from mavwire._native import BridgeTap, FrameBatch


class FrameBatches:
    """Batches of frames from when it was made; ends when the bridge stops or it is closed.

    A batch has up to `max_batch` frames, and none of them waited longer than `max_latency` seconds
    for the batch to fill.
    """

    def __init__(self, tap: BridgeTap, max_batch: int, max_latency: float) -> None:
        self._tap = tap
        weakref.finalize(self, tap.close).atexit = False  # a thread may wait for it
        self._max_batch = max_batch
        self._max_latency = max_latency
        # One of asyncio's own threads would be waited for at the end of `asyncio.run`.
        self._fetcher: threading.Thread | None = None
        self._fetching: Future[FrameBatch | None] | None = None
        self._awaited: asyncio.Future[FrameBatch | None] | None = None

    def next(self, timeout: float | None = None) -> FrameBatch | None:
        """The next batch: empty if nothing came for `timeout` seconds, None at the end."""
        return self._tap.next(self._max_batch, self._max_latency, timeout)

    @property
    def dropped(self) -> int:
        """Frames that were dropped because they were not fetched: 16 MB wait at most."""
        return self._tap.dropped

    def close(self) -> None:
        """Get no more frames; a thread that waits in `next` gets None."""
        self._tap.close()

    def __iter__(self) -> Self:
        return self

    def __next__(self) -> FrameBatch:
        batch = self.next()
        if batch is None:
            raise StopIteration
        return batch

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> FrameBatch:
        import asyncio

        while True:
            fetching = self._fetching
            # A forked child has no fetcher, even if its parent was fetching.
            if fetching is None or not (fetching.done() or self._is_fetching()):
                fetching, self._awaited = self._fetch(), None
                self._fetching = fetching
            if not fetching.done():
                # A task that is cancelled here leaves the fetched frames to the next one.
                with suppress(Exception):  # which `result` raises
                    await asyncio.shield(self._in_loop(fetching))
            if self._fetching is not fetching:
                continue  # another task was quicker
            self._fetching = self._awaited = None
            batch = fetching.result()
            if batch is None:
                raise StopAsyncIteration
            return batch

    def _in_loop(self, fetching: Future[FrameBatch | None]) -> asyncio.Future[FrameBatch | None]:
        """What is fetched, for the loop that runs: one future, however many wait for it and give up."""
        import asyncio

        if self._awaited is None or self._awaited.get_loop() is not asyncio.get_running_loop():
            self._awaited = asyncio.wrap_future(fetching)
        return self._awaited

    def _is_fetching(self) -> bool:
        return self._fetcher is not None and self._fetcher.is_alive()

    def _fetch(self) -> Future[FrameBatch | None]:
        """The next batch, once it is there: of a thread, since an event loop must not wait for it."""
        from concurrent.futures import Future

        tap, limits = self._tap, (self._max_batch, self._max_latency)
        fetching: Future[FrameBatch | None] = Future()
        fetching.set_running_or_notify_cancel()  # so that cancelling a wait for it leaves it alone

        def fetch() -> None:
            try:
                fetching.set_result(tap.next(*limits, None))
            except BaseException as error:
                fetching.set_exception(error)

        self._fetcher = start_thread(fetch, "mavwire-frames")
        return fetching

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
