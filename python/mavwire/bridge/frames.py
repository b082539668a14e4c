"""The frames of a bridge in batches, for a `for` loop or an `async for` loop."""

from __future__ import annotations

import threading
import weakref
from contextlib import suppress
from queue import SimpleQueue

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
        self._max_batch = max_batch
        self._max_latency = max_latency
        self._fetcher: _Fetcher | None = None
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
            if fetching is None or not (fetching.done() or self._has_fetcher()):
                fetching, self._awaited = self._fetch(), None
                self._fetching = fetching
            if not fetching.done():
                # Who is cancelled here leaves what is fetched to whoever comes next.
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

    def _has_fetcher(self) -> bool:
        """A forked child has none, whatever it was doing."""
        return self._fetcher is not None and self._fetcher.is_alive()

    def _fetch(self) -> Future[FrameBatch | None]:
        if not self._has_fetcher():
            self._fetcher = _Fetcher(self._tap, self._max_batch, self._max_latency)
            weakref.finalize(self, self._fetcher.end).atexit = False
        assert self._fetcher is not None
        return self._fetcher.fetch()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class _Fetcher(threading.Thread):
    """Waits for batches, where an event loop must not. One of asyncio's own threads would be missing elsewhere, and
    be waited for at the end of `asyncio.run`.
    """

    def __init__(self, tap: BridgeTap, max_batch: int, max_latency: float) -> None:
        super().__init__(name="mavwire-frames", daemon=True)
        self._tap = tap
        self._max_batch = max_batch
        self._max_latency = max_latency
        self._wanted: SimpleQueue[Future[FrameBatch | None] | None] = SimpleQueue()
        self.start()

    def fetch(self) -> Future[FrameBatch | None]:
        """The next batch, once it is there."""
        from concurrent.futures import Future

        wanted: Future[FrameBatch | None] = Future()
        wanted.set_running_or_notify_cancel()  # so that cancelling a wait for it leaves it alone
        self._wanted.put(wanted)
        return wanted

    def run(self) -> None:
        """Fetch what is asked for, one after the other."""
        while (wanted := self._wanted.get()) is not None:
            try:
                wanted.set_result(self._tap.next(self._max_batch, self._max_latency, None))
            except BaseException as error:
                wanted.set_exception(error)

    def end(self) -> None:
        """Nobody asks any more."""
        self._wanted.put(None)
        self._tap.close()
