"""Servers for one client at a time: who holds the place, and when somebody else gets it.

A client that hangs, or that never was a MAVLink program, would otherwise shut out all others for as
long as its connection lasts. One that only listens may stay as long as nobody else waits.
"""

from __future__ import annotations

import errno
from time import monotonic, sleep

from . import Any, warn
from .readiness import wait_readable
from .stream import StreamLink
from .waiting import address_family, bind, prepare_tcp, set_close_on_exec

# A client that has sent no message for this long makes room when another one waits.
CLIENT_SILENCE = 60.0
# Errors of accepting once the link is closed. Other errors pass: there are no descriptors left, or no memory.
CLOSED = frozenset((errno.EBADF, errno.EINVAL, errno.ENOTSOCK))
# How long a reader leaves a client alone that cannot be accepted; seconds.
ACCEPT_PAUSE = 0.01


def listen_on(address: tuple[str, int]) -> Any:
    """A non-blocking socket that listens for one client on `address`."""
    import socket

    listener = socket.socket(address_family(address[0]), socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        bind(listener, address)
        listener.listen(1)
    except BaseException:
        listener.close()
        raise
    listener.setblocking(False)
    set_close_on_exec(listener.fileno())
    return listener


class OneClientLink(StreamLink):
    """A server for one client at a time; `listen` is its listening socket."""

    _aio_transport = "OneClientServer"
    listen: Any
    # Clients that had to go.
    clients_replaced = 0
    # Why the client at the door cannot be taken, as was logged.
    _accept_error: str | None = None
    # The last client was refused, which was logged.
    _is_refusing = False
    # When the client was heard, and how many messages the link had received by then.
    _heard_at = 0.0
    _heard_count = 0

    def _next_client(self) -> Any:
        """The socket of a waiting client, or None."""
        self._is_refusing = False
        try:
            port, _ = self.listen.accept()
        except (BlockingIOError, InterruptedError, ConnectionError):
            return None
        except OSError as error:
            if error.errno in CLOSED:
                raise
            self._say_why(error)
            self._is_refusing = True
            return None
        self._accept_error = None
        try:
            port.setblocking(False)
            prepare_tcp(port)
        except OSError:  # gone again
            port.close()
            return None
        set_close_on_exec(port.fileno())
        self._heard_at, self._heard_count = monotonic(), self.mav_count
        self._forget_unsent()
        self._drop_partial()
        return port

    def _nothing_received(self) -> bytes:
        """No bytes, for reading without a client. A client that cannot be accepted would be found waiting over and
        over, so this takes a moment then."""
        if self._is_refusing:
            sleep(ACCEPT_PAUSE)
        return b""

    def _welcome(self) -> bool:
        """True, for a client who was just taken, unless the link was closed meanwhile: OSError then."""
        if self._closed:
            self._let_go(self.port)
        self._check_open()
        return True

    def _say_why(self, error: OSError) -> None:
        """Log why a client has to wait, unless it is the same as before."""
        reason, last = str(error), self._accept_error
        if reason != last:
            self._accept_error = reason
            warn("%s: a client cannot be served: %s; trying again", self.address, reason)

    def _drop_silent_client(self) -> None:
        """Let a client go that says nothing while another one waits."""
        port = self.port
        if port is None:
            return
        now = monotonic()
        if self.mav_count != self._heard_count:
            self._heard_at, self._heard_count = now, self.mav_count
        is_over = now - self._heard_at >= self._patience() and self._somebody_waits()
        if is_over and self._let_go(port):
            self.clients_replaced += 1

    def _somebody_waits(self) -> bool:
        try:
            return wait_readable(self.listen, 0)
        except (OSError, ValueError):
            return False  # another thread is closing the link

    def _patience(self) -> float:
        """Seconds that a client may be silent while another one waits."""
        return CLIENT_SILENCE

    def _idle_fd(self) -> int | None:
        fd: int = self.listen.fileno()
        return fd if fd >= 0 else None

    def _release(self) -> None:
        self.listen.close()
        if not self._let_go(self.port):
            self.fd = None
