"""What the bridge's HTTP servers have in common: a thread that accepts, and one for each of a few connections."""

from __future__ import annotations

import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Self

    from .bridge import Bridge

MAX_CONNECTIONS = 64


class HttpServer:
    """Answers HTTP requests about a bridge on threads, until it is closed. OSError if the port is taken."""

    handler: type[Handler]
    purpose: str

    def __init__(self, bridge: Bridge, host: str, port: int) -> None:
        self.bridge = bridge
        self.closing = threading.Event()
        server_class = _ServerV6 if ":" in host else _Server
        self._server = server_class((host, port), self.handler)
        self._server.owner = self
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(0.1,), name="mavwire-http", daemon=True
        )
        self._thread.start()

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self._server.server_address[1])

    @property
    def note(self) -> str:
        """What a user is told of it."""
        return f"{self.purpose} on port {self.port}"

    def close(self) -> None:
        """Answer no more."""
        self.closing.set()
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    # A client that says nothing is given up after the handler's time, and nobody waits for it.
    block_on_close = False
    owner: Any

    def __init__(self, *arguments: Any) -> None:
        self._free = threading.BoundedSemaphore(MAX_CONNECTIONS)
        super().__init__(*arguments)

    def process_request(self, request: Any, client_address: Any) -> None:
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that went away or talks nonsense is its own affair."""


class _ServerV6(_Server):
    import socket

    address_family = socket.AF_INET6


class Handler(BaseHTTPRequestHandler):
    """Says as little about itself as it can, and one answer on each connection."""

    server: _Server
    timeout = 10.0
    server_version = "mavwire"
    sys_version = ""
    protocol_version = "HTTP/1.1"

    def get(self) -> None:
        """Answer a GET request."""
        raise NotImplementedError

    def do_GET(self) -> None:
        self.get()

    def answer(self, content_type: str, body: bytes, headers: dict[str, str] | None = None) -> None:
        """200 with a body."""
        self.send_response(200)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(body)))
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def end_headers(self) -> None:
        """No second request on this connection, and no guesses at what the body is."""
        if not self.close_connection:
            self.close_connection = True
            self.send_header("Connection", "close")
        self.send_header("X-Content-Type-Options", "nosniff")
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: standard error belongs to the program."""
