"""Transports in a loop: how a link loses its other end and gets it back.

mavutil's links connect again while somebody calls `recv`. Here nobody does so while the other end is gone, and
serial ports are opened in a thread, too.
"""

from __future__ import annotations

import asyncio
import os
from _thread import start_new_thread
from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from typing import Any

from mavwire._threads import NoThreadError
from mavwire.links.stream import DescriptorPort, StreamWriter

from .background import in_background
from .outgoing import QueueSender, SocketSender
from .watching import descriptor_of


class Transport:
    """A link that is there as long as it is open: datagrams, and servers, which wait for a peer."""

    # The other end can be gone and come back.
    reconnects = False
    # How often `look` is called, in seconds, if at all.
    look_interval: float | None = None

    def __init__(self, sync: Any) -> None:
        self.sync = sync
        # Called when the link may have another descriptor, for another reason than reading or writing.
        self.moved: Callable[[], None] = lambda: None

    def sender(self) -> SocketSender:
        """How frames are sent without blocking."""
        return SocketSender(self.sync)

    def is_there(self) -> bool:
        """Whether there is something to read from."""
        port = getattr(self.sync, "port", None)
        return port is None or port.fileno() >= 0

    def broke(self, error: Exception) -> bool:
        """Whether an error means that the other end is gone although `is_there` does not tell."""
        return False

    def look(self) -> None:
        """Regular work, at each `look_interval`."""

    def let_go(self) -> None:
        """Release what is left of a connection that is gone."""

    def stop(self) -> None:
        """The link is being closed."""

    def try_again(self) -> None:
        """Begin to get the other end back, beside the loop, if it is time to."""


class OneClientServer(Transport):
    """Servers for one client at a time, which let one go that says nothing while another one waits."""

    look_interval = 5.0

    def look(self) -> None:
        self.sync._drop_silent_client()


class DatagramClient(Transport):
    """Datagrams to a host: should it have moved, its name is looked up beside the loop. A server looks up none."""

    def __init__(self, sync: Any) -> None:
        super().__init__(sync)
        self._loop = asyncio.get_running_loop()
        self._looking: asyncio.Task[None] | None = None
        sync._look_up = self._look_up

    def _look_up(self) -> None:
        if self._looking is None or self._looking.done():
            self._looking = self._loop.create_task(self._find())

    async def _find(self) -> None:
        try:
            found = await in_background(self.sync._resolve)
        except NoThreadError:  # the next attempt is after a pause
            found = None
        self.sync._found(found)
        self.moved()

    def stop(self) -> None:
        if self._looking is not None:
            self._looking.cancel()


class Client(Transport):
    """Clients that connect. The link of mavutil connects again in a thread."""

    def __init__(self, sync: Any) -> None:
        super().__init__(sync)
        self.reconnects = sync.autoreconnect

    def is_there(self) -> bool:
        return self.sync.port is not None

    def try_again(self) -> None:
        self.sync._begin_attempt()


class StreamClient(Client):
    """TCP and Unix domain sockets."""

    def __init__(self, sync: Any) -> None:
        super().__init__(sync)
        # Which would print.
        sync.handle_eof = sync.handle_disconnect = lambda: None


class SerialPort(Client):
    """Serial ports, which may be unplugged."""

    def __init__(self, sync: Any) -> None:
        super().__init__(sync)
        self.reconnects, sync.autoreconnect = sync.autoreconnect, False
        sync._say = lambda text: None  # programs look at `link.connected` or at the log

    def sender(self) -> SocketSender:
        sync = self.sync
        if os.name != "posix":
            return SocketSender(sync)  # pyserial's own writing, which may block
        if not sync._writer.unsent:
            # A queue that no sender waits for may be longer.
            dropped, sync._writer = sync._writer.dropped_frames, StreamWriter()
            sync._writer.dropped_frames = dropped
        return QueueSender(sync, lambda: DescriptorPort(sync.port), lambda: descriptor_of(sync))

    def is_there(self) -> bool:
        return bool(getattr(self.sync.port, "is_open", False))

    def broke(self, error: Exception) -> bool:
        return isinstance(error, OSError)

    def let_go(self) -> None:
        if self.is_there():
            self.sync._lost(self.sync.port)

    def try_again(self) -> None:
        opening = self.sync._opening
        if self.is_there() or monotonic() < self.sync._next_reset or opening.locked():
            return
        with suppress(RuntimeError):  # there is no thread to be had
            start_new_thread(opening.run, (self._open,))

    def _open(self) -> None:
        self.sync._reopen(only_when_due=True)


class Child(Transport):
    """Child processes: gone when they end."""

    def sender(self) -> SocketSender:
        sync, pipe = self.sync, self.sync.child.stdin
        return QueueSender(
            sync, lambda: sync._input, lambda: None if pipe.closed else (pipe.fileno(), pipe)
        )

    def is_there(self) -> bool:
        return self.sync.fd is not None

    def broke(self, error: Exception) -> bool:
        return isinstance(error, OSError)


def transport_of(sync: Any) -> Transport:
    """The transport that the class of a link names. Logs and links of programs may name none."""
    made: type[Transport] = globals()[getattr(sync, "_aio_transport", "Transport")]
    return made(sync)
