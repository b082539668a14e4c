"""The web inspector: a page that shows what a bridge sees, and the WebSocket that feeds it.

A thread for each connection, as for metrics. It asks the bridge for counts and for the newest values of what the page has
open, and sends them once the page has seen what was sent before; so a slow browser gets the newest values and not those that
waited for it, and frames cost nothing here, however many come. wsproto speaks the WebSocket protocol, as on mavwire's
WebSocket links.
"""

from __future__ import annotations

import hmac
import ipaddress
import os
import re
import secrets
import select
import socket
import time
from http import HTTPStatus
from urllib.parse import parse_qs, urlsplit

from .inspection import View
from .serving import Handler, HttpServer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .bridge import Bridge

PAGE = os.path.join(os.path.dirname(__file__), "inspector.html")
# Seconds between two updates of values, and of everything else.
VALUES_INTERVAL = 0.1
TABLES_INTERVAL = 0.5
# A request of the page is shorter.
MAX_REQUEST = 16 * 1024
# Texts that may be on their way to a page: two updates.
MAX_UNSEEN = 4
# A page that sees nothing of them for so long is given up.
PATIENCE = 30.0
CHUNK = 256 * 1024


class _Handler(Handler):
    def get(self) -> None:
        address = urlsplit(self.path)
        if not self._is_meant() or not self._is_allowed(address.query):
            return
        answers = {"/": self._page, "/ws": self._talk, "/recording": self._recording}
        answer = answers.get(address.path)
        if answer is None:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        try:
            answer()
        except RuntimeError:
            self.send_error(HTTPStatus.SERVICE_UNAVAILABLE, "the bridge has stopped")

    # -- who may ask

    def _is_meant(self) -> bool:
        """The names in Host and Origin are ours: no other site's page asks in its visitor's name."""
        host = self.headers.get("Host", "")
        origin = self.headers.get("Origin")
        foreign = origin is not None and origin.lower() != f"http://{host.lower()}"
        if foreign or not self.server.owner.answers_to(host):
            self.send_error(HTTPStatus.FORBIDDEN, "not for this host or origin")
            return False
        return True

    def _is_allowed(self, query: str) -> bool:
        token = self.server.owner.token
        given = parse_qs(query).get("token", [""])[0]
        if token and not hmac.compare_digest(given.encode(), token.encode()):
            self.send_error(
                HTTPStatus.FORBIDDEN, "the address lacks the token that the bridge printed"
            )
            return False
        return True

    # -- what there is

    def _page(self) -> None:
        nonce = secrets.token_urlsafe(16)
        with open(PAGE, encoding="utf-8") as file:
            page = file.read().replace("NONCE", nonce)
        policy = (
            f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; "
            "connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'none'"
        )
        headers = {
            "Content-Security-Policy": policy,
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "no-store",
        }
        self.answer("text/html; charset=utf-8", page.encode(), headers)

    def _recording(self) -> None:
        """The log that is being written, as far as it is."""
        recording = self.server.owner.bridge.stats()["recording"]
        if recording is None:
            self.send_error(HTTPStatus.NOT_FOUND, "nothing is recorded")
            return
        with open(recording["path"], "rb") as file:
            left = os.fstat(file.fileno()).st_size
            name = os.path.basename(recording["path"])
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", "application/octet-stream")
            self.send_header("Content-Length", str(left))
            self.send_header("Content-Disposition", f'attachment; filename="{name}"')
            self.end_headers()
            while left > 0 and (chunk := file.read(min(CHUNK, left))):
                self.wfile.write(chunk)
                left -= len(chunk)

    def _talk(self) -> None:
        """Switch to WebSocket, and tell until the browser goes or the bridge ends."""
        from wsproto import ConnectionType, WSConnection
        from wsproto.events import AcceptConnection
        from wsproto.utilities import ProtocolError

        web = WSConnection(ConnectionType.SERVER)
        headers = [(name.lower().encode(), value.encode()) for name, value in self.headers.items()]
        try:
            web.initiate_upgrade_connection(headers, self.path.encode())
            next(web.events())
            accepted = web.send(AcceptConnection())
        except (ProtocolError, StopIteration):
            self.send_error(HTTPStatus.BAD_REQUEST, "this address speaks WebSocket")
            return
        self.close_connection = True
        self.connection.settimeout(PATIENCE)
        self.connection.sendall(accepted)
        _Conversation(self.connection, web, self.server.owner).run()


class _Conversation:
    """One browser: what it says is heard between two updates."""

    def __init__(self, connection: socket.socket, web: Any, owner: Inspector) -> None:
        self._connection = connection
        self._web = web
        self._closing = owner.closing
        self._view = View(owner.bridge)
        self._said = ""
        self._unseen = 0

    def run(self) -> None:
        """Until either side ends it. OSError if the browser vanishes."""
        from wsproto.events import CloseConnection, TextMessage
        from wsproto.utilities import ProtocolError

        next_tables = seen = 0.0
        try:
            while not self._closing.is_set():
                now = time.monotonic()
                texts: list[str | None] = []
                if self._unseen < MAX_UNSEEN:
                    seen = now
                    if now >= next_tables:
                        next_tables = now + TABLES_INTERVAL
                        texts.append(self._view.tables())
                    texts.append(self._view.values())
                for text in filter(None, texts):
                    self._unseen += 1
                    self._connection.sendall(self._web.send(TextMessage(text)))
                if not self._listen(now + VALUES_INTERVAL) or now > seen + PATIENCE:
                    return
        except (ProtocolError, ValueError):
            self._connection.sendall(self._web.send(CloseConnection(1007, "not understood")))
        except RuntimeError:
            self._connection.sendall(
                self._web.send(CloseConnection(1001, "the bridge has stopped"))
            )

    def _listen(self, until: float) -> bool:
        """Hear what the browser says up to a moment; False if it says no more."""
        while (left := until - time.monotonic()) > 0:
            if not select.select([self._connection], [], [], left)[0]:
                return True
            data = self._connection.recv(65536)
            if not data:
                return False
            self._web.receive_data(data)
            for event in self._web.events():
                if not self._take(event):
                    return False
        return True

    def _take(self, event: Any) -> bool:
        from wsproto.events import BytesMessage, CloseConnection, Ping, TextMessage

        if isinstance(event, CloseConnection | Ping):
            self._connection.sendall(self._web.send(event.response()))
        elif isinstance(event, BytesMessage):
            raise ValueError("requests are texts")
        elif isinstance(event, TextMessage):
            self._said += event.data
            if len(self._said) > MAX_REQUEST:
                raise ValueError("too long for a request")
            if event.message_finished:
                said, self._said = self._said, ""
                self._unseen = max(0, self._unseen - self._view.hear(said))
        return not isinstance(event, CloseConnection)


class Inspector(HttpServer):
    """Serves the page, until it is closed. OSError if the port is taken, ImportError without wsproto.

    On other addresses than loopback it asks for a token, which `url` has.
    """

    handler = _Handler
    purpose = "inspector"

    def __init__(self, bridge: Bridge, host: str, port: int, token: str | None = None) -> None:
        import wsproto  # noqa: F401 - without it no browser would get more than an empty page

        self._host = host
        self._is_local = _is_loopback(host)
        self.token = token or ("" if self._is_local else secrets.token_urlsafe(16))
        super().__init__(bridge, host, port)

    @property
    def note(self) -> str:
        """Where the page is."""
        return f"inspector at {self.url}"

    @property
    def url(self) -> str:
        """The address of the page."""
        host = socket.gethostname() if _is_any(self._host) else self._host
        query = f"?token={self.token}" if self.token else ""
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}/{query}"

    def answers_to(self, host: str) -> bool:
        """Whether a Host header may name this server. On loopback another name is someone's trick."""
        if not self._is_local:
            return True  # any name may be right, and the token says who may ask
        name = re.sub(r":[0-9]*$", "", host.lower()).strip("[]")
        return name == "localhost" or _is_loopback(name)


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _is_any(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_unspecified
    except ValueError:
        return False
