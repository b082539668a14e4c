"""Writing whole frames to a stream that may take only part of one.

A frame that was begun is always finished, because half a frame makes the peer drop what follows.
What the peer does not take is queued up to a bound; beyond it, whole frames are dropped and
counted.
"""

from __future__ import annotations

import errno
import os
from _thread import allocate_lock
from collections import deque

from .chunked import ChunkedLink
from .forks import follow_forks

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

MAX_UNSENT = 1 << 20
# What one call of the system is offered.
SEND_SIZE = 1 << 16


class DescriptorPort:
    """A file, pipe or serial port of this system, `file`, to write to as a socket: it takes what there is room for."""

    def __init__(self, file: Any) -> None:
        self._file = file

    def send(self, data: bytes) -> int:
        try:
            fd = self._file.fileno()
        except ValueError:  # it was closed
            raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE)) from None
        return os.write(fd, data)


class _Queue:
    """Frames that wait, as the bytes of them that were not sent, and which these are."""

    def __init__(self) -> None:
        self.data = bytearray()
        self._lengths: deque[int] = deque()
        # Bytes of the first frame that were sent.
        self._begun = 0

    def add(self, frame: bytes) -> None:
        self._lengths.append(len(frame))
        self.data.extend(frame)

    def take_off(self, sent: int) -> None:
        """So many bytes were sent."""
        del self.data[:sent]
        sent += self._begun
        lengths = self._lengths
        try:
            while lengths and sent >= lengths[0]:
                sent -= lengths.popleft()
        except IndexError:  # another thread has just counted them
            pass
        self._begun = sent

    def forget(self) -> int:
        """How many frames there are, each of which is counted once."""
        count = 0
        try:
            while True:
                self._lengths.popleft()
                count += 1
        except IndexError:
            return count


class StreamWriter:
    """Outgoing bytes of a non-blocking stream socket, from any number of threads.

    One thread sends at a time and takes along what others put into the queue meanwhile. Nobody
    waits for it, so that a signal handler that writes in the middle of a write is no deadlock.
    """

    def __init__(self, max_unsent: int = MAX_UNSENT) -> None:
        self._max_unsent = max_unsent
        self._queue = _Queue()
        self.dropped_frames = 0
        self.bytes_sent = 0
        self._sending = allocate_lock()
        follow_forks(self, StreamWriter._renew)

    @property
    def unsent(self) -> bytearray:
        """What waits in the queue."""
        return self._queue.data

    def write(self, port: Any, frame: bytes, note: Callable[[bool], Any] = bool) -> None:
        """Send `frame` after what is queued; OSError when the connection is gone, and then `clear` counts the frame.

        Here and below, `note` is told whether something is left in the queue. One thread at a
        time does so, and the last one knows best.
        """
        if len(self._queue.data) + len(frame) > self._max_unsent:
            self._make_room(port, note)
            if len(self._queue.data) + len(frame) > self._max_unsent:
                self.dropped_frames += 1
                return
        queue = self._queue
        queue.add(frame)
        if queue is not self._queue:  # another thread has forgotten it meanwhile
            self.dropped_frames += queue.forget()
        self.flush(port, note)

    def _make_room(self, port: Any, note: Callable[[bool], Any]) -> None:
        try:
            self.flush(port, note)
        except OSError:
            self.dropped_frames += 1  # the frame that waits for room
            raise

    def flush(self, port: Any, note: Callable[[bool], Any] = bool) -> None:
        """Send as much of the queue as the peer takes now."""
        # A fork may put another lock in place of the one that is to be released.
        while (turn := self._sending).acquire(blocking=False):
            try:
                goes_on = self._send_some(port)
            finally:
                note(bool(self._queue.data))
                turn.release()
            # Looked at after the lock was released: what came in between is nobody else's.
            if not (goes_on and self._queue.data):
                return

    def _send_some(self, port: Any) -> bool:
        """Send from the head of the queue; whether the peer may take more."""
        queue = self._queue
        data = queue.data
        if not data:
            return True
        try:
            # A copy, because others append to the queue meanwhile.
            sent = port.send(bytes(data[:SEND_SIZE]))
        except (BlockingIOError, InterruptedError):
            return False
        queue.take_off(sent)
        self.bytes_sent += sent
        return True

    def clear(self, note: Callable[[bool], Any] = bool) -> None:
        """Drop and count what is queued: the connection it was meant for is gone."""
        # Replaced, not emptied: a thread that is sending still uses up the old one.
        queue, self._queue = self._queue, _Queue()
        self.dropped_frames += queue.forget()
        turn = self._sending
        if turn.acquire(blocking=False):  # or that thread tells
            try:
                note(bool(self._queue.data))
            finally:
                turn.release()

    def _renew(self) -> None:
        """A thread that did not come along was sending: what it was at is finished where it runs. What merely
        waits may be finished by this process, if the connection is its."""
        if self._sending.locked():
            self._sending = allocate_lock()
            self._queue = _Queue()


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
        """Drop and count what is queued: the connection it was meant for is gone."""
        self._writer.clear(self._note_unsent)

    def _note_unsent(self, waits: bool) -> None:
        self._has_unsent = waits
