"""Writing whole frames to a stream socket that may take only part of one.

A frame that was begun is always finished, because half a frame makes the peer drop what follows.
What the peer does not take is queued up to a bound; beyond it, whole frames are dropped and
counted.
"""

from __future__ import annotations

from .chunked import ChunkedLink

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

MAX_UNSENT = 1 << 20
# What one call of the system is offered.
SEND_SIZE = 1 << 16


class StreamWriter:
    """Outgoing bytes of a non-blocking stream socket, from any number of threads.

    One thread sends at a time and takes along what others put into the queue meanwhile. Nobody
    waits for it, so that a signal handler that writes in the middle of a write is no deadlock.
    """

    def __init__(self, max_unsent: int = MAX_UNSENT) -> None:
        from _thread import allocate_lock

        self._max_unsent = max_unsent
        self.unsent = bytearray()
        self.dropped_frames = 0
        self._sending = allocate_lock()

    def write(self, port: Any, frame: bytes, note: Callable[[bool], Any] = bool) -> None:
        """Send `frame` after what is queued; OSError when the connection is gone.

        Here and below, `note` is told whether something is left in the queue. One thread at a
        time does so, and the last one knows best.
        """
        if len(self.unsent) + len(frame) > self._max_unsent:
            self.flush(port, note)
        if len(self.unsent) + len(frame) > self._max_unsent:
            self.dropped_frames += 1
            return
        self.unsent.extend(frame)
        self.flush(port, note)

    def flush(self, port: Any, note: Callable[[bool], Any] = bool) -> None:
        """Send as much of the queue as the peer takes now."""
        while self._sending.acquire(blocking=False):
            try:
                goes_on = self._send_some(port)
            finally:
                note(bool(self.unsent))
                self._sending.release()
            # Looked at after the lock was released: what came in between is nobody else's.
            if not (goes_on and self.unsent):
                return

    def _send_some(self, port: Any) -> bool:
        """Send from the head of the queue; whether the peer may take more."""
        queue = self.unsent
        if not queue:
            return True
        try:
            # A copy, because others append to the queue meanwhile.
            sent = port.send(bytes(queue[:SEND_SIZE]))
        except (BlockingIOError, InterruptedError):
            return False
        del queue[:sent]
        return True

    def clear(self, note: Callable[[bool], Any] = bool) -> None:
        """Forget the queue: the connection it was meant for is gone."""
        # Replaced, not emptied: a thread that is sending still uses up the old one.
        self.unsent = bytearray()
        if self._sending.acquire(blocking=False):  # or that thread tells
            try:
                note(bool(self.unsent))
            finally:
                self._sending.release()


class StreamLink(ChunkedLink):
    """A link over a stream socket: frames leave it whole or not at all."""

    _writer: StreamWriter

    @property
    def frames_dropped(self) -> int:
        """Frames that were not sent because the peer was gone or had stopped reading."""
        return self._writer.dropped_frames

    def _send_frame(self, port: Any, frame: bytes) -> None:
        """Send or queue a frame; OSError when the connection `port` is gone."""
        self._writer.write(port, frame, self._note_unsent)

    def _send_rest(self, port: Any) -> None:
        """Send what was queued, as far as the peer takes it now."""
        if self._has_unsent or self._writer.unsent:
            self._writer.flush(port, self._note_unsent)

    def _forget_unsent(self) -> None:
        """Forget the queue: the connection it was meant for is gone."""
        self._writer.clear(self._note_unsent)

    def _note_unsent(self, waits: bool) -> None:
        self._has_unsent = waits
