"""TCP server links: one client at a time, and the next one when it has gone."""

from __future__ import annotations

from mavwire._native import Exclusive

from . import Any
from .chunked import READ_SIZE
from .one_client import OneClientLink, listen_on
from .stream import StreamWriter, receive
from .waiting import split_host_port


class mavtcpin(OneClientLink):
    """`device` is the host:port to listen on; `retries` is accepted and unused."""

    def __init__(
        self,
        device: str,
        source_system: int = 255,
        source_component: int = 0,
        retries: int = 3,
        use_native: bool = False,
    ) -> None:
        self.listen_addr = split_host_port(device, "TCP")
        self.listen = listen_on(self.listen_addr)
        self.port: Any = None
        self._writer = StreamWriter()
        self._accepting = (
            Exclusive()
        )  # threads that receive and threads that send may both be about to
        super().__init__(
            self.listen.fileno(), f"tcpin:{device}",
            source_system=source_system, source_component=source_component,
        )  # fmt: skip
        self._read_stream(serves_one=True)

    def _has_client(self) -> bool:
        """Whether there is a client, one who waits being taken; False while another thread takes one."""
        return self.port is not None or bool(self._accepting.run(self._take_client))

    def _take_client(self) -> bool:
        return self.port is not None or self._accept()

    def _accept(self) -> bool:
        """Take a waiting client; whether there is one."""
        port = self._next_client()
        if port is None:
            return False
        self.port, self.fd = port, port.fileno()
        return self._welcome()

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes of the client; empty when there are none, or no client."""
        if not self._has_client():
            return self._nothing_received()
        port = self.port
        if port is None:  # another thread closed it just now
            return b""
        try:
            self._raise_read_error()
            self._send_rest(port)
            data = receive(port, READ_SIZE if n is None else n)
        except OSError:  # no ConnectionError if the client stopped answering
            data = b""
        if data is None:
            return b""
        if not data:
            self._let_go(port)
        return data

    def _look_for_client(self) -> None:
        """Take a client who waits, for programs that only send."""
        if self._closed:
            return
        try:
            self._has_client()
        except OSError:
            if not self._closed:  # or another thread has just closed the link
                raise

    def write(self, buf: bytes) -> None:
        """Send one frame whole to the client, or to the next who waits; without one, or when it is stuck, drop it."""
        if self.port is None:
            self._look_for_client()
        port = self.port
        if port is None:
            self._writer.dropped_frames += 1
            return
        try:
            self._send_frame(port, buf)
        except OSError:
            self._let_go(port)
