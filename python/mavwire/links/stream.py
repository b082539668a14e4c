"""Writing whole frames to a stream that may take only part of one. `StreamWriter` does it natively."""

from __future__ import annotations

from mavwire._native import DescriptorPort, StreamWriter

from . import Any
from .chunked import ChunkedLink

__all__ = ["DescriptorPort", "StreamLink", "StreamWriter", "receive"]


def receive(port: Any, n: int) -> bytes | None:
    """Up to `n` bytes of a non-blocking port; None while nothing waits, empty at its end."""
    try:
        data: bytes = port.recv(n)
    except (BlockingIOError, InterruptedError):
        return None
    return data


class StreamLink(ChunkedLink):
    """A link over a stream socket: frames leave it whole or not at all."""

    batch_bytes = 1 << 16

    @property
    def frames_dropped(self) -> int:
        """Frames that were not sent because the peer was gone or had stopped reading."""
        return self._writer.dropped_frames

    def _send_frame(self, port: Any, frame: bytes) -> None:
        """Send or queue a frame; OSError when the connection `port` is gone."""
        self._writer.write(port, frame)

    def _send_rest(self, port: Any) -> None:
        """Send what was queued, as far as the peer takes it now."""
        if self._has_unsent:
            self._writer.flush(port)

    def _forget_unsent(self) -> None:
        """Drop and count what is queued: the connection it was meant for is gone."""
        self._writer.clear()

    def _idle_fd(self) -> int | None:
        """The descriptor to wait on without a connection."""
        return None

    def _let_go(self, port: Any) -> bool:
        """Close the connection `port`; False if that was done before, as it may be the next one's turn by then."""
        return self._end_connection(port, self._idle_fd())
