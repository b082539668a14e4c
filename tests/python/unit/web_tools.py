"""A WebSocket client, for the tests of the web inspector."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable
from typing import Any

from unit.bridge_tools import LIMIT
from wsproto import ConnectionType, WSConnection
from wsproto.events import (
    AcceptConnection,
    BytesMessage,
    CloseConnection,
    RejectConnection,
    Request,
    TextMessage,
)

RECEIVE_BUFFER = 64 * 1024


class WebSocketClient:
    """Connected once made; `status` is that of a server that refuses."""

    def __init__(self, port: int, path: str, headers: dict[str, str] | None = None) -> None:
        self._web = WSConnection(ConnectionType.CLIENT)
        self._socket = socket.socket()
        self._socket.settimeout(LIMIT)
        # However much the system would hold for a reader: a slow one is to be slow.
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
        self._socket.connect(("127.0.0.1", port))
        self._texts: list[str] = []
        self._part = ""
        self.binary = b""
        self.status = 0
        self.close_code: int | None = None
        extra = [(name.encode(), value.encode()) for name, value in (headers or {}).items()]
        request = Request(host=f"127.0.0.1:{port}", target=path, extra_headers=extra)
        self._socket.sendall(self._web.send(request))
        while not self.status:
            self._receive()

    def _receive(self) -> None:
        data = self._socket.recv(65536)
        self._web.receive_data(data or None)
        for event in self._web.events():
            if isinstance(event, AcceptConnection):
                self.status = 101
            elif isinstance(event, RejectConnection):
                self.status = event.status_code
            elif isinstance(event, TextMessage):
                self._part += event.data
                if event.message_finished:
                    self._texts.append(self._part)
                    self._part = ""
            elif isinstance(event, BytesMessage):
                self.binary += event.data
            elif isinstance(event, CloseConnection):
                self.close_code = self.close_code or event.code

    def send(self, message: object) -> None:
        """A text, or anything else as JSON."""
        text = message if isinstance(message, str) else json.dumps(message)
        self._socket.sendall(self._web.send(TextMessage(text)))

    def send_raw(self, data: bytes) -> None:
        """Bytes as they are."""
        self._socket.sendall(data)

    def until(self, wanted: Callable[[Any], Any]) -> Any:
        """What `wanted` makes of the first message that it makes anything of."""
        while True:
            while self._texts:
                found = wanted(json.loads(self._texts.pop(0)))
                self.saw()
                if found:
                    return found
            assert self.close_code is None, f"closed with {self.close_code}"
            self._receive()

    def saw(self) -> None:
        """A text was dealt with."""

    def closed(self) -> int:
        """Wait for the server to close; its code."""
        while self.close_code is None:
            self._receive()
        return self.close_code

    def close(self) -> None:
        """Hang up."""
        self._socket.close()

    def __enter__(self) -> WebSocketClient:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class PageClient(WebSocketClient):
    """One that tells the web inspector what it has seen, as its page does."""

    def saw(self) -> None:
        self.send({"seen": 1})
