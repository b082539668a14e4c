"""WebSocket links: MAVLink frames in binary messages, as a server for one client or as a client.

The protocol itself is wsproto's, which is loaded when the first such link is opened.
"""

from __future__ import annotations

import errno
import os

from mavwire._native import Exclusive, TlsPort

from . import Any
from .chunked import READ_SIZE
from .names import connect_to
from .one_client import OneClientLink, listen_on
from .reconnecting import ReconnectingLink
from .stream import StreamLink, StreamWriter, receive
from .waiting import prepare_tcp, set_close_on_exec, split_host_port

# How long a server's answer to the opening handshake may take.
HANDSHAKE_TIMEOUT = 5.0


class _WebSocketLink(StreamLink):
    """A socket under a wsproto connection: the part that both ends share."""

    batch_bytes = 0  # each frame is a WebSocket message
    # The connection that was made last: its socket and its protocol.
    _made: tuple[Any, Any] = (None, None)

    def __init__(
        self, fd: int | None, address: str, source_system: int, source_component: int
    ) -> None:
        self.port = None
        self._writer = StreamWriter()
        self._reading = Exclusive()
        super().__init__(
            fd, address, source_system=source_system, source_component=source_component
        )

    @property
    def ws(self) -> Any:
        """wsproto's object for the connection; None without one."""
        port, ws = self._made
        return ws if port is self.port else None

    def _start(self, port: Any, ws: Any) -> None:
        port.setblocking(False)
        set_close_on_exec(port.fileno())
        self._made = port, ws
        self.port, self.fd = port, port.fileno()

    def close_port(self) -> None:
        """Drop the connection; the link itself stays usable."""
        self._let_go(self.port)

    def _send_event(self, event: Any) -> None:
        """Send an event of the protocol; drop the connection if that fails."""
        port, ws = self.port, self.ws
        if port is None or ws is None:  # another thread dropped the connection
            return
        try:
            self._send_frame(port, ws.send(event))
        except OSError:
            self._let_go(port)

    def recv(self, n: int | None = None) -> bytes:
        """All bytes of one read; empty without data or peer, and while another thread reads."""
        return self._reading.run(self._read) or b""

    def _read(self) -> bytes:
        raise NotImplementedError

    def _receive(self) -> bytes:
        """The payload of the binary messages that one read completes."""
        port, ws = self.port, self.ws
        if port is None or ws is None:  # another thread dropped the connection
            return b""
        try:
            self._send_rest(port)
            data = receive(port, READ_SIZE)
        except OSError:
            self._let_go(port)
            return b""
        return b"" if data is None else self._handle(port, ws, data)

    def _handle(self, port: Any, ws: Any, data: bytes) -> bytes:
        from wsproto.utilities import LocalProtocolError, RemoteProtocolError

        try:
            ws.receive_data(data or None)
        except (RemoteProtocolError, LocalProtocolError, UnicodeDecodeError):
            # UnicodeDecodeError: a header of the handshake that is not ASCII.
            self._let_go(port)
            return b""
        received = self._take_events(port, ws)
        if not data:
            self._let_go(port)
        return received

    def _take_events(self, port: Any, ws: Any) -> bytes:
        """Act on what was received; the payload of binary messages in it."""
        from wsproto.utilities import LocalProtocolError, RemoteProtocolError

        received = b""
        try:
            for event in ws.events():
                received += self._on_event(event)
                if self.ws is not ws:
                    break
        except (RemoteProtocolError, LocalProtocolError, ValueError):
            # ValueError: this process was forked while another thread read, which it never ends.
            self._let_go(port)
        return received

    def _on_event(self, event: Any) -> bytes:
        """Act on one protocol event; the payload if it is a piece of a binary message."""
        from wsproto import events

        if isinstance(event, events.BytesMessage):
            return bytes(event.data)
        if isinstance(event, events.Request):
            self._send_event(events.AcceptConnection())
        elif isinstance(event, events.Ping):
            self._send_event(event.response())
        elif isinstance(event, events.CloseConnection):
            self._send_event(event.response())
            self.close_port()
        elif isinstance(event, events.RejectConnection):
            self.close_port()
        return b""

    def _established(self) -> bool:
        from wsproto.connection import ConnectionState

        ws = self.ws
        return ws is not None and ws.state is ConnectionState.OPEN

    def _write_message(self, buf: bytes) -> None:
        """Send one frame as one binary message."""
        from wsproto.events import BytesMessage
        from wsproto.utilities import LocalProtocolError

        try:
            self._send_event(BytesMessage(data=bytes(buf)))
        except LocalProtocolError:  # the receiving thread has just heard that it ends
            self._writer.dropped_frames += 1


class mavwebsocket(_WebSocketLink, OneClientLink):
    """A server for one client at a time; `device` is the host:port to listen on."""

    def __init__(
        self,
        device: str,
        source_system: int = 255,
        source_component: int = 0,
        use_native: bool = False,
    ) -> None:
        import wsproto  # noqa: F401  (fail now, not in the middle of a session)

        self.listen_addr = split_host_port(device, "WebSocket server")
        self.listen = listen_on(self.listen_addr)
        super().__init__(
            self.listen.fileno(), f"wsserver:{device}",
            source_system=source_system, source_component=source_component,
        )  # fmt: skip

    def _accept(self) -> bool:
        from wsproto import ConnectionType, WSConnection

        port = self._next_client()
        if port is None:
            return False
        self._start(port, WSConnection(ConnectionType.SERVER))
        return self._welcome()

    def _patience(self) -> float:
        return super()._patience() if self._established() else HANDSHAKE_TIMEOUT

    def _read(self) -> bytes:
        if self.port is None and not self._accept():
            return self._nothing_received()
        return self._receive()

    def write(self, buf: bytes) -> None:
        """Send one frame to the client; without one it is dropped and counted."""
        if self._established():
            self._write_message(buf)
        else:
            self._writer.dropped_frames += 1


def split_device(device: str) -> tuple[str, str, str]:
    """`PROTOCOL:HOST:PORT[:RESOURCE]` as protocol, `HOST:PORT` and resource. ValueError otherwise."""
    protocol, _, rest = device.partition(":")
    host, bracket, rest = rest.rpartition("]") if rest.startswith("[") else ("", "", rest)
    parts = rest.split(":", 2)
    if len(parts) < 2:
        raise ValueError("WebSocket ports must be specified as protocol:host:port")
    resource = parts[2] if len(parts) > 2 else ""
    return protocol, f"{host}{bracket}{parts[0]}:{parts[1]}", resource


def _status(ws: Any) -> str:
    """With what status a server refused to open the WebSocket `ws`, if it said one."""
    from wsproto.events import RejectConnection

    for event in ws.events():
        if isinstance(event, RejectConnection):
            return f": HTTP status {event.status_code}"
    return ""


class mavwebsocket_client(_WebSocketLink, ReconnectingLink):
    """`device` is `ws:host:port[:resource]` or `wss:...`. A server that is not up, or goes, is tried
    again until it is there."""

    autoreconnect = True
    # The process that connected; one that was forked from it has no say in the end of the connection.
    _process = 0

    def __init__(
        self,
        device: str,
        source_system: int = 255,
        source_component: int = 0,
        use_native: bool = False,
        reconnect_delay: float = 1,
    ) -> None:
        protocol, address, resource = split_device(device)
        import wsproto  # noqa: F401  (fail now, not in the middle of a session)

        self.secure = protocol == "wss"
        self.destination_addr = split_host_port(address, "WebSocket")
        self.resource = resource
        self.reconnect_delay = reconnect_delay
        self._begin_unconnected()
        super().__init__(
            None, device, source_system=source_system, source_component=source_component
        )
        self.connect()

    def connect(self) -> bool:
        """Connect and shake hands, blocking; whether the server was there to be connected to. OSError
        where something else answers."""
        try:
            port = self._reach()
        except OSError as error:
            self._note_failure(error)
            return False
        self._use(self._opened(port))
        return self._established()

    def _connect(self) -> tuple[Any, Any]:
        """A socket and the WebSocket on it, open."""
        return self._opened(self._reach())

    def _reach(self) -> Any:
        """A socket; OSError where the server is not up yet."""
        return connect_to(*self.destination_addr, HANDSHAKE_TIMEOUT)

    def _opened(self, port: Any) -> tuple[Any, Any]:
        """`port` and the WebSocket on it."""
        try:
            prepare_tcp(port)
            if self.secure:
                import ssl

                context = ssl.create_default_context()
                port = context.wrap_socket(port, server_hostname=self.destination_addr[0])
            ws = self._shake_hands(port)
        except BaseException:
            port.close()
            raise
        return TlsPort(port) if self.secure else port, ws

    def _shake_hands(self, port: Any) -> Any:
        """The WebSocket on `port`, which still blocks."""
        from time import monotonic

        from wsproto import ConnectionType, WSConnection
        from wsproto.connection import ConnectionState
        from wsproto.events import Request
        from wsproto.utilities import RemoteProtocolError

        ws = WSConnection(ConnectionType.CLIENT)
        host, number = self.destination_addr
        if ":" in host:
            host = f"[{host}]"
        request = Request(host=f"{host}:{number}", target=f"/{self.resource.lstrip('/')}")
        deadline = monotonic() + HANDSHAKE_TIMEOUT
        try:
            port.sendall(ws.send(request))
            data = b"..."
            while data and ws.state is ConnectionState.CONNECTING:
                port.settimeout(max(deadline - monotonic(), 0.001))
                data = port.recv(READ_SIZE)
                ws.receive_data(data or None)
        except TimeoutError:
            raise TimeoutError(f"no WebSocket handshake from {self.address}") from None
        except (RemoteProtocolError, UnicodeDecodeError) as error:
            reason = f"{self.address} does not speak WebSocket: {error}"
            if not data:
                reason = f"{self.address} hung up during the WebSocket handshake"
            raise OSError(errno.EPROTO, reason) from error
        if ws.state is not ConnectionState.OPEN:
            reason = f"{self.address} refused the WebSocket handshake{_status(ws)}"
            raise OSError(errno.EPROTO, reason)
        return ws

    def _install(self, connection: tuple[Any, Any]) -> None:
        self._process = os.getpid()
        self._start(*connection)

    def _disconnect(self) -> None:
        self.close_port()

    def _let_go(self, port: Any) -> bool:
        is_over = super()._let_go(port)
        if is_over:
            self._connection_ended()
        return is_over

    def _release(self) -> None:
        """Close the connection, telling the server."""
        if self._established() and self._process == os.getpid():
            from contextlib import suppress

            from wsproto.events import CloseConnection
            from wsproto.utilities import LocalProtocolError

            with suppress(LocalProtocolError):  # it is being closed anyway
                self._send_event(CloseConnection(code=1000))
        self.close_port()

    def _read(self) -> bytes:
        self._check_open()
        port, ws = self.port, self.ws
        if ws is None:
            self._begin_attempt()
            return b""
        # Frames may have come along with the end of the handshake.
        return self._take_events(port, ws) or self._receive()

    def write(self, data: bytes) -> None:
        """Send one frame; while the server is not there it is dropped and counted."""
        if self._established():
            self._write_message(data)
            return
        self._begin_attempt()
        self._writer.dropped_frames += 1
