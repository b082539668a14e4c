"""Sending without waiting: what a peer does not take at once is kept and sent when it does.

A link's `mav` writes its frames here, and the link keeps what cannot be sent yet, up to a bound beyond which
whole frames are dropped.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from mavwire.links.stream import DescriptorPort

from .watching import POLL_INTERVAL, Descriptor, descriptor_of, watch


class SocketSender:
    """A link that never blocks when it writes."""

    def __init__(self, sync: Any) -> None:
        self._sync = sync
        self._refused = 0

    def descriptor(self) -> Descriptor | None:
        return descriptor_of(self._sync)

    def write(self, frame: bytes) -> None:
        try:
            self._sync.write(frame)
        except OSError:
            self._refused += 1
            raise

    def unsent(self) -> bool:
        return bool(getattr(self._sync, "_has_unsent", False))

    def flush(self) -> None:
        self._sync._send_rest(self._sync.port)

    def forget(self) -> None:
        """Links forget and count by themselves what was meant for a connection that is gone."""

    @property
    def dropped(self) -> int:
        return self._refused + int(getattr(self._sync, "frames_dropped", 0))


class QueueSender(SocketSender):
    """A link whose `write` may block, or that is written to elsewhere than it is read: by way of the link's own
    queue. `port` says to what, and `find` which descriptor that is now."""

    def __init__(
        self,
        sync: Any,
        port: Callable[[], DescriptorPort],
        find: Callable[[], Descriptor | None],
    ) -> None:
        super().__init__(sync)
        self._port = port
        self._find = find

    def descriptor(self) -> Descriptor | None:
        return self._find()

    def write(self, frame: bytes) -> None:
        self._sync._send_frame(self._port(), frame)

    def flush(self) -> None:
        self._sync._send_rest(self._port())

    def forget(self) -> None:
        self._sync._forget_unsent()


@dataclass(eq=False)
class Outgoing:
    """The file that `mav` writes to. `failed` is called when the connection turns out to be gone."""

    _loop: asyncio.AbstractEventLoop
    _sender: SocketSender
    _is_connected: Callable[[], bool]
    _failed: Callable[[OSError], None]
    _written: Callable[[], None]
    _dropped: int = 0
    _watched: Descriptor | None = None
    _timer: asyncio.TimerHandle | None = None
    _drained: set[asyncio.Future[None]] = field(default_factory=set)

    @property
    def dropped(self) -> int:
        """Frames that were not sent because nobody was there or had stopped reading."""
        return self._dropped + self._sender.dropped

    def write(self, frame: bytes) -> None:
        """Send one frame, or keep it until the peer takes it; without a peer, drop it."""
        if not self._is_connected():
            self._dropped += 1
            return
        try:
            self._sender.write(frame)
        except OSError as error:
            self._failed(error)
            return
        self._written()

    async def drain(self) -> None:
        """Wait until the system has taken everything that was sent."""
        while True:
            self.follow()  # which may find out that the connection is gone
            if not (self._is_connected() and self._sender.unsent()):
                return
            future = self._loop.create_future()
            self._drained.add(future)
            try:
                await future
            finally:
                self._drained.discard(future)

    def follow(self) -> None:
        """Watch for room while something waits, also what reading or the program has put into the link's queue; and no
        descriptor that the link has closed: its number may be another's by now."""
        if self._watched is not None:
            if self._watched != self._sender.descriptor():
                self._unwatch()
                self._flush()
        elif self._timer is None and self._is_connected() and self._sender.unsent():
            self._watch()

    def stop(self) -> None:
        """The connection is gone, and with it what was meant for it."""
        self._unwatch()
        self._sender.forget()
        self._tell()

    def _watch(self) -> None:
        self._watched = watch(self._loop.add_writer, self._sender.descriptor(), self._flush)
        if self._watched is None:
            self._timer = self._loop.call_later(POLL_INTERVAL, self._flush)

    def _unwatch(self) -> None:
        if self._watched is not None:
            self._loop.remove_writer(self._watched[0])
            self._watched = None
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _flush(self) -> None:
        try:
            self._sender.flush()
        except OSError as error:
            self._unwatch()
            self._failed(error)
            return
        if not self._sender.unsent():
            self._unwatch()
            self._tell()
        elif self._watched is None:
            self._watch()

    def _tell(self) -> None:
        for future in self._drained:
            if not future.done():
                future.set_result(None)
