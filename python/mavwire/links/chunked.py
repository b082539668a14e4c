"""Receiving from live transports: take what has arrived, hand out one message at a time.

Messages that one read brought along are handed out before the next read. So the parser holds one
read at most, and the backlog of a slow consumer stays in the socket, where the system bounds it.

The native `LiveLink` does that for links that call `_read_stream` or `_read_datagrams`. Once a program replaces a
method, it calls the methods here instead.
"""

from __future__ import annotations

from mavwire._hooks import quick_methods
from mavwire._native import LiveLink

from . import Any
from .mavfile import link_dict, mavfile

# Reads per call without a message coming out of them: a peer that sends garbage faster than it
# is read must not keep a caller from looking at its timeout.
READS_PER_CALL = 64
READ_SIZE = 65536


class ChunkedLink(LiveLink, mavfile):
    """A link whose `recv(None)` returns everything that one read can bring."""

    __dict__ = link_dict
    # Methods that the native ones skip. If a program replaces one of them, the link is read through
    # the methods here.
    _quick_methods: list[tuple[type | None, str, Any]]
    # Descriptor and bytes of the native reader are those of this object.
    port: Any
    # The class of `mavwire.aio.transports` that keeps such a link in a loop.
    _aio_transport: str
    # Closed by the program, for good.
    _closed = False

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if cls.__module__.startswith(__package__):
            cls._quick_methods = quick_methods(cls, mavfile)

    def select(self, timeout: float) -> bool:
        """Whether there may be data within `timeout` seconds, or data that was read ahead."""
        return self._has_read_ahead or super().select(timeout)

    def _recv_by_methods(self) -> Any:
        self.pre_message()
        msg = None
        try:
            msg = self._parsed()
        finally:
            # Nothing has come, or garbage, be it raised or not: no reason to leave things undone.
            if msg is None or msg.get_type() == "BAD_DATA":
                self._drop_silent_client()
        if msg is not None:
            self._delivered(msg)
        return msg

    def _parsed(self) -> Any:
        """The next message of what was read, or of what reading brings; None without one."""
        msg = self.mav.parse_char(b"")
        reads = 0
        while msg is None and reads < READS_PER_CALL:
            # Until the first marker was seen, reads end with the frame, so that the next
            # begins with a marker even on a serial link joined in the middle of a frame.
            data = self._recv_own(self.mav.bytes_needed() if self.first_byte else None)
            if not data:
                return None
            data = self._arrived(data)  # which may replace the parser
            msg = self.mav.parse_char(data)
            reads += 1
        return msg

    def _recv_own(self, n: int | None) -> bytes:
        """`recv`, for the link's own parser."""
        return self.recv(n)

    def close(self) -> None:
        """Close the link for good."""
        self._closed = True
        try:
            self._release()
        except BaseException:  # as a signal handler raises half-way; nobody closes a link twice
            self._release()
            raise

    def _release(self) -> None:
        """Let go of what the transport holds, if it does; `fd` is None then."""
        raise NotImplementedError

    def _drop_silent_client(self) -> None:
        """Servers for one client at a time: called about once a second while no message arrives."""

    def _check_open(self) -> None:
        """OSError once the link is closed, so that a thread that receives from it ends."""
        if self._closed:
            import errno
            import os

            raise OSError(errno.EBADF, os.strerror(errno.EBADF))


ChunkedLink._quick_methods = quick_methods(ChunkedLink, mavfile)
