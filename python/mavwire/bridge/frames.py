"""The frames of a bridge in batches, for a `for` loop or an `async for` loop."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Self

    from mavwire._native import BridgeTap, FrameBatch

# How long a thread of asyncio's waits at a time: what a cancelled task leaves behind ends then.
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
            batch = await asyncio.to_thread(self.next, ASYNC_SLICE)
            if batch is None:
                raise StopAsyncIteration
            if len(batch):
                return batch

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
