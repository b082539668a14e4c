"""Calls that block, such as opening a connection, while the loop goes on."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar, cast

from mavwire._threads import NoThreadError, start_thread

T = TypeVar("T")
NAME = "mavwire.aio"


async def in_background(function: Callable[[], T], discard: Callable[[T], Any] | None = None) -> T:
    """Call `function` in a thread; its result, or its error. NoThreadError without a thread. If the wait is cancelled,
    `discard` gets the result, in a thread too.

    The thread ends with the call. A thread of the loop's executor would hold up the end of the program: a connection
    attempt may take long.
    """
    loop = asyncio.get_running_loop()
    # An error is a part of the result: futures do not take every exception.
    future: asyncio.Future[tuple[Any, BaseException | None]] = loop.create_future()

    def deliver(result: Any, error: BaseException | None) -> None:
        if not future.done():
            future.set_result((result, error))
        elif error is None:
            try:
                start_thread(lambda: drop(result), NAME)
            except NoThreadError:
                drop(result)

    def drop(result: T) -> None:
        if discard is not None:
            with suppress(OSError):
                discard(result)

    def call() -> None:
        result: Any = None
        error: BaseException | None = None
        try:
            result = function()
        except BaseException as raised:
            error = raised
        try:
            loop.call_soon_threadsafe(deliver, result, error)
        except RuntimeError:  # the loop was closed in the meantime
            if error is None:
                drop(result)

    start_thread(call, NAME)
    try:
        result, error = await future
    except asyncio.CancelledError:
        # Cancelled after the result had come, and before it was taken.
        if future.done() and not future.cancelled():
            deliver(*future.result())
        raise
    if error is not None:
        try:
            raise error
        finally:
            del error  # which knows this frame
    return cast("T", result)


async def close_in_background(close: Callable[[], object]) -> None:
    """Call `close`, which has to happen: where there is no thread to be had, the loop waits for it."""
    try:
        await in_background(close)
    except NoThreadError:
        close()
