"""Getting a lost connection back, with growing pauses and without blocking anybody.

An attempt may take seconds: names, hosts that do not answer, handshakes. So it is made in a thread. Receiving and
sending start it once it is due.
"""

from __future__ import annotations

from _thread import start_new_thread
from time import monotonic

from mavwire._native import Exclusive

from . import Any, warn
from .mavfile import IDLE_INTERVAL
from .stream import StreamLink, StreamWriter

# Pauses between attempts double up to this many times the first one.
MAX_BACKOFF = 16


class Backoff:
    """Pauses between attempts, each twice as long as the one before."""

    def __init__(self) -> None:
        self._factor = 1

    def next_pause(self, delay: float) -> float:
        """Seconds until the next attempt; `delay` is the first pause."""
        pause = delay * self._factor
        self._factor = min(self._factor * 2, MAX_BACKOFF)
        return pause

    def reset(self) -> None:
        """The other end has proved itself: begin with the first pause again."""
        self._factor = 1


class RetryingLink(StreamLink):
    """A link that is opened again, and keeps why that failed."""

    # Why the last attempt to connect failed; None when it succeeded.
    connect_error: OSError | None = None

    def _note_failure(self, error: OSError) -> None:
        """Keep why connecting failed, and log it unless it was the same the last time. Of a link that was closed
        meanwhile it is no news: nobody tries again."""
        if self._closed:
            return
        # Without the frames it went through, which hold the link and what it has tried.
        last, self.connect_error = self.connect_error, error.with_traceback(None)
        if str(error) != str(last):
            reason = error.strerror or str(error)
            if str(self.address) not in reason:
                reason = f"{self.address}: {reason}"
            warn("%s; trying again", reason)

    def _note_success(self) -> None:
        if self.connect_error is not None:
            self.connect_error = None


class ReconnectingLink(RetryingLink):
    """A client over a stream socket. With `autoreconnect` a lost connection is made again."""

    _aio_transport = "Client"
    autoreconnect: bool
    reconnect_delay: float
    # When the link was connected, and the messages that it had received by then.
    _connected_at = 0.0
    _count_before = 0

    def _begin_unconnected(self) -> None:
        self.port: Any = None
        self._writer = StreamWriter()
        self._backoff = Backoff()
        self._next_attempt = 0.0
        self._connecting = Exclusive()

    # -- what a transport provides

    def _connect(self) -> Any:
        """A connection, made without touching the link; may block. OSError without another end."""
        raise NotImplementedError

    def _install(self, connection: Any) -> None:
        """Read and write `connection` from now on, and at once, since a fork sees what was done so far."""
        raise NotImplementedError

    def _disconnect(self) -> None:
        """Let go of the connection, if there is one; `fd` is None until there is another."""
        raise NotImplementedError

    # -- what it gets

    def _use(self, connection: Any) -> None:
        """Take over a connection, unless the link was closed while that was made."""
        self._forget_unsent()  # it may end inside a frame that another connection began
        self._drop_partial()
        self._connected_at, self._count_before = monotonic(), self.mav_count
        self._note_success()
        self._install(connection)
        if self._closed:
            self._disconnect()

    def _begin_attempt(self) -> bool:
        """Begin to connect beside the caller; False if nobody asked, or it is too early or under way."""
        is_due = self.port is None and monotonic() >= self._next_attempt
        if not self.autoreconnect or self._closed or not is_due or self._connecting.locked():
            return False
        self._next_attempt = monotonic() + IDLE_INTERVAL  # the thread may begin later
        try:
            start_new_thread(self._connecting.run, (self._attempt,))
        except RuntimeError:  # there is no thread to be had, as at the end of the program
            self._put_off()
            return False
        return True

    def _attempt(self) -> None:
        if self.port is not None:
            return
        try:
            self._use(self._connected())
        except OSError as error:  # not there yet
            self._note_failure(error)

    def _connected(self) -> Any:
        try:
            return self._connect()
        finally:
            self._put_off()

    def _put_off(self) -> None:
        """The next attempt is after a pause, also after a success: a peer may only hang up."""
        self._next_attempt = monotonic() + self._backoff.next_pause(self.reconnect_delay)

    def _connection_ended(self) -> None:
        """A connection that brought a message and lasted for the first pause is made again at once."""
        has_lasted = monotonic() - self._connected_at >= self.reconnect_delay
        if has_lasted and self.mav_count != self._count_before:
            self._count_before = self.mav_count
            self._backoff.reset()
            self._next_attempt = 0.0

    def select(self, timeout: float) -> bool:
        """Wait until data may be there; for a connection, not for long."""
        if self.fd is None and self.autoreconnect:
            timeout = min(timeout, IDLE_INTERVAL)
        return super().select(timeout)
