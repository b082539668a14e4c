"""From the descriptor of a link to its feed.

The loop calls when there is something to read. Input is taken in portions, so that a flood on one
link leaves time for the others. A link without a descriptor that the loop can watch (a serial
port on Windows, any link under a proactor loop) is looked at by a timer instead.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from mavwire._native import LiveLink, receive_batch

from .feed import Feed
from .watching import POLL_INTERVAL, Descriptor, descriptor_of, watch

# Messages that one turn takes at most: about 0.1 ms.
PORTION = 64


@dataclass(eq=False)
class Pump:
    """Reads `sync` into `feed`. After each turn `turned` gets the error that reading raised, or None."""

    _loop: asyncio.AbstractEventLoop
    _sync: Any
    _feed: Feed
    _turned: Callable[[Exception | None], None]
    _watched: Descriptor | None = None
    _handle: asyncio.Handle | None = None
    _is_running: bool = False

    def start(self) -> None:
        """Begin with what is there, then wait for more."""
        self._is_running = True
        self._watch()
        self._soon()

    def stop(self) -> None:
        """Leave the link alone."""
        self._is_running = False
        self._unwatch()
        self._forget_turn()

    def check(self) -> None:
        """Follow the link to another descriptor, after something else than reading used it."""
        if self._is_running and descriptor_of(self._sync) != self._watched:
            self._watch()
            self._forget_turn()  # which may be some time off
            self._soon()

    def _forget_turn(self) -> None:
        if self._handle is not None:
            self._handle.cancel()
            self._handle = None

    def _soon(self) -> None:
        if self._handle is None:
            self._handle = self._loop.call_soon(self._turn)

    def _readable(self) -> None:
        if self._handle is None:
            self._turn()

    def _turn(self) -> None:
        self._handle = None
        more, error = self._portion()
        if self._is_running:
            self._turned(error)
        if not self._is_running:
            return
        self._watch()
        if more or error is not None:
            self._soon()
        elif self._watched is None:
            self._handle = self._loop.call_later(POLL_INTERVAL, self._turn)

    def _portion(self) -> tuple[bool, Exception | None]:
        """Take a portion, one by one if somebody has to see each; whether there may be more, and
        what went wrong."""
        left = PORTION
        more, error = True, None
        while left and more and error is None:
            limit = 1 if self._feed.in_step else left
            more, error = self._receive(limit)
            self._feed.tell()
            left -= limit
        return more, error

    def _receive(self, limit: int) -> tuple[bool, Exception | None]:
        batch: list[Any] = []
        try:
            return self._take(batch, limit), None
        except Exception as error:  # of the system, of strict parsing or of a message hook
            return False, error
        finally:
            self._feed.add(batch)

    def _take(self, batch: list[Any], limit: int) -> bool:
        if isinstance(self._sync, LiveLink):
            return receive_batch(self._sync, batch, limit)
        while len(batch) < limit:
            msg = self._sync.recv_msg()
            if msg is None:
                return False
            batch.append(msg)
        return True

    # -- watching

    def _watch(self) -> None:
        """Let the loop watch the descriptor that the link has now."""
        now = descriptor_of(self._sync)
        if now != self._watched:
            self._unwatch()
            self._watched = watch(self._loop.add_reader, now, self._readable)

    def _unwatch(self) -> None:
        if self._watched is not None:
            self._loop.remove_reader(self._watched[0])
            self._watched = None
