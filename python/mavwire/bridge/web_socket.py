"""WebSocket on a connection of a bridge's HTTP server. wsproto speaks the protocol, as on mavwire's WebSocket links."""

from __future__ import annotations

from http import HTTPStatus

from mavwire.links.readiness import wait_readable

from .slow_peer import send_all

TYPE_CHECKING = False
if TYPE_CHECKING:
    import socket
    from collections.abc import Iterator
    from typing import Any, Self

    from .serving import Handler

# A request is shorter.
MAX_REQUEST = 16 * 1024


class WebSocket:
    """The server's end. OSError if the other side vanishes; ValueError or wsproto's ProtocolError if it talks nonsense."""

    def __init__(self, connection: socket.socket, web: Any) -> None:
        self._connection = connection
        self._web = web
        self._said = ""

    @classmethod
    def accept(cls, handler: Handler) -> Self | None:
        """What a request becomes that asks for it; None for another one, which is told so."""
        from h11 import ProtocolError as HttpError  # wsproto leaves headers to it
        from wsproto import ConnectionType, WSConnection
        from wsproto.events import AcceptConnection
        from wsproto.utilities import ProtocolError

        web = WSConnection(ConnectionType.SERVER)
        headers = [
            (name.lower().encode(), value.encode()) for name, value in handler.headers.items()
        ]
        try:
            web.initiate_upgrade_connection(headers, handler.path.encode())
            next(web.events())
            accepted = web.send(AcceptConnection())
        except (ProtocolError, HttpError, StopIteration):
            handler.send_error(HTTPStatus.BAD_REQUEST, "this address speaks WebSocket")
            return None
        handler.close_connection = True
        send_all(handler.connection, accepted)
        return cls(handler.connection, web)

    def send(self, message: str | bytes) -> None:
        """A text or a binary message."""
        from wsproto.events import BytesMessage, TextMessage

        self._send(TextMessage(message) if isinstance(message, str) else BytesMessage(message))

    def close(self, code: int, reason: str) -> None:
        """Say that it ends, and why."""
        from wsproto.events import CloseConnection

        self._send(CloseConnection(code, reason))

    def _send(self, event: Any) -> None:
        send_all(self._connection, self._web.send(event))

    def hear(self, seconds: float) -> list[str | bytes] | None:
        """What is said next, if it is said in time: whole texts, and pieces of what is binary; None at the end."""
        if not wait_readable(self._connection, seconds):
            return []
        data = self._connection.recv(65536)
        if not data:
            return None
        self._web.receive_data(data)
        heard = list(self._heard())
        return None if None in heard else [one for one in heard if one is not None]

    def _heard(self) -> Iterator[str | bytes | None]:
        from wsproto.events import BytesMessage, CloseConnection, Ping, TextMessage

        for event in self._web.events():
            if isinstance(event, CloseConnection | Ping):
                self._send(event.response())
            if isinstance(event, CloseConnection):
                yield None
            elif isinstance(event, BytesMessage):
                yield bytes(event.data)
            elif isinstance(event, TextMessage):
                self._said += event.data
                if len(self._said) > MAX_REQUEST:
                    raise ValueError("too long for a request")
                if event.message_finished:
                    said, self._said = self._said, ""
                    yield said
