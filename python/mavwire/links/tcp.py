"""TCP client links: connect with retries, notice the end once, connect again if asked to."""

from __future__ import annotations

import time

from . import Any, Callable
from .chunked import READ_SIZE
from .names import connect_to
from .reconnecting import ReconnectingLink
from .stream import receive
from .waiting import prepare_tcp, set_close_on_exec, split_host_port

# How long one attempt may take.
CONNECT_TIMEOUT = 5.0


class mavtcp(ReconnectingLink):
    """`device` is host:port. `retries` connection attempts, `reconnect_delay` seconds apart."""

    _aio_transport = "StreamClient"
    _socket_kind = "TCP"

    def __init__(
        self,
        device: str,
        autoreconnect: bool = False,
        source_system: int = 255,
        source_component: int = 0,
        retries: int = 6,
        reconnect_delay: float = 1,
        use_native: bool = False,
    ) -> None:
        self.destination_addr: Any = split_host_port(device, "TCP")
        self._open(f"tcp:{device}", autoreconnect, retries, reconnect_delay,
                   source_system, source_component)  # fmt: skip

    def _open(
        self, address: str, autoreconnect: bool, retries: int, reconnect_delay: float,
        source_system: int, source_component: int,
    ) -> None:  # fmt: skip
        self.autoreconnect = autoreconnect
        self.retries = retries
        self.reconnect_delay = reconnect_delay
        self.fd: int | None = None
        self._begin_unconnected()
        self.do_connect()
        super().__init__(self.fd, address, source_system=source_system,
                         source_component=source_component)  # fmt: skip
        self._read_stream()

    def _connect(self) -> Any:
        """One connection attempt: a connected, still blocking socket."""
        host, number = self.destination_addr
        port = connect_to(host, number, CONNECT_TIMEOUT)
        try:
            prepare_tcp(port)
        except BaseException:
            port.close()
            raise
        return port

    def do_connect(self) -> None:
        """Connect, trying `retries` times but at least once; raises the last error."""
        attempts = 0
        while True:
            attempts += 1
            try:
                self._use(self._connect())
                return
            except OSError as error:
                if attempts >= self.retries:
                    raise
                print(f"{error} sleeping")
                time.sleep(self.reconnect_delay)

    def _install(self, port: Any) -> None:
        port.setblocking(False)
        set_close_on_exec(port.fileno())
        self.portdead = False
        self.port, self.fd = port, port.fileno()

    def close(self) -> None:
        """Close the link for good."""
        self.autoreconnect = False
        super().close()

    def _release(self) -> None:
        self._disconnect()

    def _disconnect(self) -> None:
        super()._let_go(self.port)

    def handle_disconnect(self) -> None:
        """The peer broke the connection."""
        print(f"Connection reset or closed by peer on {self._socket_kind} socket")
        self.reconnect()

    def handle_eof(self) -> None:
        """The peer closed the connection."""
        print(f"EOF on {self._socket_kind} socket")
        self.reconnect()

    def _end(self, port: Any, handle: Callable[[], None]) -> bool:
        """The end of the connection `port` was noticed: let go of it, and have it handled. False if another thread
        has done so, as it may be the next connection's turn by then."""
        if not self._let_go(port):
            return False
        handle()
        return True

    def _let_go(self, port: Any) -> bool:
        if port is self.port:
            self.portdead = True
        if not super()._let_go(port):
            return False
        self._connection_ended()
        return True

    def reconnect(self) -> None:
        """Begin to connect again, if asked to and if the last attempt is long enough ago.

        That goes on beside the program; `port` is None until it succeeds.
        """
        if self._begin_attempt():
            print("Attempting reconnect")

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes; empty when nothing is there or the connection is gone."""
        port = self.port
        if port is None:
            self._check_open()
            self.reconnect()
            return b""
        try:
            self._raise_read_error()
            self._send_rest(port)
            data = receive(port, READ_SIZE if n is None else n)
        except OSError:  # no ConnectionError if the peer stopped answering
            if self._end(port, self.handle_disconnect) and not self.autoreconnect:
                raise
            return b""
        if data is None:
            return b""
        if not data:
            self._end(port, self.handle_eof)
        return data

    def write(self, buf: bytes) -> None:
        """Send one frame whole, or drop it whole when the peer is gone or has stopped reading."""
        port = self.port
        if port is None:
            self.reconnect()
            self._writer.dropped_frames += 1
            return
        try:
            self._send_frame(port, buf)
        except OSError:
            self._end(port, self.handle_disconnect)
