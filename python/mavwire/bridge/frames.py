"""The frames of a bridge in batches, for a `for` loop or an `async for` loop."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Self

from mavwire._native import BridgeTap, FrameBatch

if TYPE_CHECKING:
    import asyncio

# Seconds that a thread of asyncio waits for frames: the end of `asyncio.run` waits for the thread.
LOOK_TIME = 0.2


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
        self._fetching: asyncio.Task[FrameBatch | None] | None = None

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
            if fetching is None or fetching.get_loop() is not asyncio.get_running_loop():
                look = asyncio.to_thread(self.next, LOOK_TIME)
                fetching = self._fetching = asyncio.ensure_future(look)
            # A task that is cancelled here leaves the fetched frames to the next one.
            batch = await asyncio.shield(fetching)
            if self._fetching is not fetching:
                continue  # another task was quicker
            self._fetching = None
            if batch is None:
                raise StopAsyncIteration
            if len(batch):
                return batch

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
