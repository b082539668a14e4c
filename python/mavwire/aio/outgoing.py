"""Sending without waiting: what a peer does not take at once is kept and sent when it does.

A link's `mav` writes its frames here. Sockets keep what they cannot send themselves; serial ports and
child processes, which would block, get a queue. Queues are bounded and drop whole frames.
"""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from typing import Any

from mavwire.links.stream import StreamWriter

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


class DescriptorSender:
    """A descriptor that takes only so much at a time; `find` says which it is now."""

    def __init__(self, find: Callable[[], Descriptor | None]) -> None:
        self.descriptor = find
        self._writer = StreamWriter()
        self.forget = self._writer.clear

    def send(self, data: bytes) -> int:
        """What the writer calls to hand over bytes."""
        descriptor = self.descriptor()
        if descriptor is None:
            raise BrokenPipeError("nobody is there to be written to")
        return os.write(descriptor[0], data)

    def write(self, frame: bytes) -> None:
        self._writer.write(self, frame)

    def unsent(self) -> bool:
        return bool(self._writer.unsent)

    def flush(self) -> None:
        self._writer.flush(self)

    @property
    def dropped(self) -> int:
        return self._writer.dropped_frames


Sender = SocketSender | DescriptorSender


class Outgoing:
    """The file that `mav` writes to. `failed` is called when the connection turns out to be gone."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        sender: Sender,
        is_connected: Callable[[], bool],
        failed: Callable[[OSError], None],
        written: Callable[[], None],
    ) -> None:
        self._loop = loop
        self._sender = sender
        self._is_connected = is_connected
        self._failed = failed
        self._written = written
        self._dropped = 0
        self._watched: Descriptor | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._drained: list[asyncio.Future[None]] = []

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
        if self._watched is None and self._timer is None and self._sender.unsent():
            self._watch()

    async def drain(self) -> None:
        """Wait until the system has taken everything that was sent."""
        while self._is_connected() and self._sender.unsent():
            future = self._loop.create_future()
            self._drained.append(future)
            await future

    def follow(self) -> None:
        """Watch no descriptor that the link has closed: its number may be another's by now."""
        if self._watched is not None and self._watched != self._sender.descriptor():
            self._unwatch()
            self._flush()

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
        waiting, self._drained = self._drained, []
        for future in waiting:
            if not future.done():
                future.set_result(None)
