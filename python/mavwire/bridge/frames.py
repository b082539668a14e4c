"""The frames of a bridge in batches, for a `for` loop or an `async for` loop."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from asyncio import Future
    from typing import Self

    from mavwire._native import BridgeTap, FrameBatch

# How long a thread of asyncio's waits at a time: one that a cancelled task leaves behind ends then.
ASYNC_SLICE = 0.2


class FrameBatches:
    """Batches of frames from when it was made; ends when the bridge stops or it is closed.

    A batch has up to `max_batch` frames, and none of them waited longer than `max_latency` seconds
    for the batch to fill.
    """

    def __init__(self, tap: BridgeTap, max_batch: int, max_latency: float) -> None:
        self._tap = tap
        self._max_batch = max_batch
        self._max_latency = max_latency
        self._fetching: Future[FrameBatch | None] | None = None

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

        loop = asyncio.get_running_loop()
        while True:
            fetching = self._fetching
            if fetching is None or not (fetching.done() or fetching.get_loop() is loop):
                fetching = self._fetching = loop.run_in_executor(None, self.next, ASYNC_SLICE)
            if not fetching.done():
                # Who is cancelled here leaves what is fetched to whoever comes next.
                await asyncio.wait([fetching])
            if self._fetching is not fetching:
                continue  # another task was quicker
            self._fetching = None
            batch = fetching.result()
            if batch is None:
                raise StopAsyncIteration
            if len(batch):
                return batch

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
