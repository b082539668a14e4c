"""What the bridge's HTTP servers have in common: a thread that accepts, and one for each of a few connections."""

from __future__ import annotations

import errno
import io
import ipaddress
import re
import socket
import socketserver
import threading
import time
from collections import Counter
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit

from .slow_peer import send_all

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any, Self

    from .bridge import Bridge
    from .web_socket import WebSocket

MAX_CONNECTIONS = 64
# Where the system has no more descriptors or memory for a connection.
EXHAUSTED = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)


class HttpServer:
    """Answers HTTP requests about a bridge on threads, until it is closed. OSError if the port is taken.

    `names`: by what else than its address and the name of this machine it may be asked for, as through a proxy in front
    of it.
    """

    handler: type[Handler]
    purpose: str

    def __init__(self, bridge: Bridge, host: str, port: int, names: Iterable[str] = ()) -> None:
        self.bridge = bridge
        self.closing = threading.Event()
        self._host = host
        self._names = frozenset(name.lower() for name in names)
        server_class = _ServerV6 if ":" in host else _Server
        self._server = server_class((host, port), self.handler)
        self._server.owner = self
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(0.1,), name="mavwire-http", daemon=True
        )
        try:
            start(self._thread)
        except OSError:
            self._server.server_close()
            raise

    @property
    def is_ending(self) -> bool:
        """Whether it was closed, or the bridge was stopped."""
        return self.closing.is_set() or not self.bridge.running

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self._server.server_address[1])

    @property
    def note(self) -> str:
        """What a user is told of it."""
        return f"{self.purpose} on port {self.port}"

    @property
    def is_local(self) -> bool:
        """Whether only this machine reaches it."""
        return is_loopback(self._host)

    @property
    def shown_address(self) -> str:
        """Host and port as in a URL that others can open."""
        host = socket.gethostname() if _is_any(self._host) else self._host
        return f"{f'[{host}]' if ':' in host else host}:{self.port}"

    def answers_to(self, host: str) -> bool:
        """Whether a Host header may name this server. Anyone can have another name lead here, and its page ask."""
        name = re.sub(r":[0-9]*$", "", host.lower()).strip("[]")
        if is_loopback(name) or name in self._names:
            return True
        return not self.is_local and (_address(name) is not None or name in _own_names(self._host))

    def welcomes(self, origin: str, host: str) -> bool:
        """Whether a page from `origin` may ask who was asked for as `host`: ours may, over a proxy with TLS too."""
        try:
            url = urlsplit(origin.lower())
            return url.scheme in ("http", "https") and (
                url.netloc == host.lower() or url.hostname in self._names
            )
        except ValueError:
            return False

    def close(self) -> None:
        """Answer no more."""
        self.closing.set()
        if self._thread.is_alive():  # which it is not in a forked child
            self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class _Places:
    """So many at once, and three quarters of them from one address: nobody shuts all others out."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._taken: Counter[str] = Counter()

    def take(self, host: str, always: bool = False) -> bool:
        """Take a place for someone from `host`; False if there is none."""
        with self._lock:
            free = self._taken.total() < MAX_CONNECTIONS
            allowed = always or (free and self._taken[host] < MAX_CONNECTIONS * 3 // 4)
            self._taken[host] += allowed
            return allowed

    def leave(self, host: str) -> None:
        """Someone from `host` goes."""
        with self._lock:
            self._taken[host] -= 1
            self._taken += Counter()  # without those that are gone


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    # A client that says nothing is given up after the handler's time, and nobody waits for it.
    block_on_close = False
    owner: Any

    def __init__(self, *arguments: Any) -> None:
        self._requests, self._talks = _Places(), _Places()
        super().__init__(*arguments)

    def server_bind(self) -> None:
        """Bind, and ask no name server what this machine is called: there may be none."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = str(self.server_address[0]), self.server_address[1]

    def get_request(self) -> tuple[socket.socket, Any]:
        try:
            return super().get_request()
        except OSError as error:
            if error.errno in EXHAUSTED:
                self.owner.closing.wait(0.1)  # who asks again at once gets the same answer
            raise

    def process_request(self, request: Any, client_address: Any) -> None:
        if not self._requests.take(client_address[0]):
            self.shutdown_request(request)
            return
        try:
            super().process_request(request, client_address)
        except BaseException:  # there is no thread for it
            self._requests.leave(client_address[0])
            raise

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._requests.leave(client_address[0])

    def talk(self, host: str, run: Callable[[], None]) -> bool:
        """Run what takes long, such as a WebSocket, in a place apart from those of requests; False if there is none."""
        if not self._talks.take(host):
            return False
        self._requests.leave(host)
        try:
            run()
        finally:
            self._talks.leave(host)
            self._requests.take(host, always=True)
        return True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that went away or talks nonsense is its own affair."""


class _ServerV6(_Server):
    address_family = socket.AF_INET6


class _InTime(io.RawIOBase):
    """What comes over a connection up to a deadline: who says a byte now and then is given up too."""

    def __init__(self, connection: socket.socket, seconds: float) -> None:
        self._connection = connection
        self._end = time.monotonic() + seconds

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        left = self._end - time.monotonic()
        if left <= 0:
            raise TimeoutError
        self._connection.settimeout(left)
        return self._connection.recv_into(buffer)


class Handler(BaseHTTPRequestHandler):
    """Says as little about itself as it can, and one answer on each connection."""

    server: _Server
    timeout = 10.0
    server_version = "mavwire"
    sys_version = ""
    protocol_version = "HTTP/1.1"

    def setup(self) -> None:
        super().setup()
        self.rfile.close()
        self.rfile = io.BufferedReader(_InTime(self.connection, self.timeout))

    def get(self) -> None:
        """Answer a GET request."""
        raise NotImplementedError

    def do_GET(self) -> None:
        self.connection.settimeout(self.timeout)
        if self._is_meant():
            self.get()

    def _is_meant(self) -> bool:
        """The names in Host and Origin are ours: no other site's page asks in its visitor's name."""
        host, origin = self.headers.get("Host"), self.headers.get("Origin")
        if host is None and origin is None:
            return True  # no browser: these say whom they ask
        host, owner = host or "", self.server.owner
        if not owner.answers_to(host) or not (origin is None or owner.welcomes(origin, host)):
            self.send_error(
                HTTPStatus.FORBIDDEN, "not for this host or origin: --http-name adds one"
            )
            return False
        return True

    def talk(self, run: Callable[[WebSocket], None]) -> None:
        """Switch to WebSocket, if that is what is asked for, and run a conversation; OSError if the other side vanishes."""
        from wsproto.utilities import ProtocolError

        from .web_socket import WebSocket

        def accept_and_run() -> None:
            web = WebSocket.accept(self)
            if web is None:
                return
            try:
                run(web)
                if self.server.owner.is_ending:
                    web.close(1001, "the bridge has stopped")
            except (ProtocolError, ValueError):
                web.close(1007, "not understood")
            except RuntimeError:
                web.close(1001, "the bridge has stopped")

        if not self.server.talk(self.client_address[0], accept_and_run):
            self.send_error(HTTPStatus.SERVICE_UNAVAILABLE, "too many others are connected")

    def answer(self, content_type: str, body: bytes, headers: dict[str, str] | None = None) -> None:
        """200 with a body."""
        self.send_response(200)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(body)))
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.end_headers()
        send_all(self.connection, body)

    def end_headers(self) -> None:
        """No second request on this connection, and no guesses at what the body is."""
        if not self.close_connection:
            self.close_connection = True
            self.send_header("Connection", "close")
        self.send_header("X-Content-Type-Options", "nosniff")
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: standard error belongs to the program."""


def start(thread: threading.Thread) -> None:
    """Start a thread. OSError where the system has none left."""
    try:
        thread.start()
    except RuntimeError as error:
        raise OSError(errno.EAGAIN, str(error)) from error


def _own_names(host: str) -> set[str]:
    """What a server is called that listens on `host`, with the names that this machine has for itself."""
    machine = socket.gethostname().lower()
    short = machine.partition(".")[0]
    return {host.lower(), machine, short, f"{short}.local"}


def is_loopback(host: str) -> bool:
    """Whether a name or an address leads to this machine alone."""
    address = _address(host)
    return host == "localhost" if address is None else address.is_loopback


def _is_any(host: str) -> bool:
    address = _address(host)
    return address is not None and address.is_unspecified


def _address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """None for a name."""
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None
