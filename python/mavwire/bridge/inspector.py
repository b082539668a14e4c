"""The web inspector: a page that shows what a bridge sees, and the WebSocket that feeds it.

A thread for each connection, as for metrics. It asks the bridge for counts and for the newest values of what the page has
open, and sends them once the page has seen what was sent before; so a slow browser gets the newest values and not those that
waited for it, and frames cost nothing here, however many come.
"""

from __future__ import annotations

import hmac
import os
import secrets
import time
from http import HTTPStatus
from urllib.parse import parse_qs, urlsplit

from .inspection import View
from .serving import Handler, HttpServer, is_loopback
from .slow_peer import PATIENCE, send_all

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

    from .bridge import Bridge
    from .web_socket import WebSocket

PAGE = os.path.join(os.path.dirname(__file__), "inspector.html")
# Seconds between two updates of values, and of everything else.
VALUES_INTERVAL = 0.1
TABLES_INTERVAL = 0.5
# Texts that may be on their way to a page: two updates.
MAX_UNSEEN = 4
CHUNK = 256 * 1024


class _Handler(Handler):
    def get(self) -> None:
        address = urlsplit(self.path)
        if not self._is_allowed(address.query):
            return
        answers = {"/": self._page, "/ws": self._tell, "/recording": self._recording}
        answer = answers.get(address.path)
        if answer is None:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        try:
            answer()
        except RuntimeError:
            self.send_error(HTTPStatus.SERVICE_UNAVAILABLE, "the bridge has stopped")

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
        try:
            log = open(recording["path"], "rb")
        except OSError:
            self.send_error(HTTPStatus.NOT_FOUND, "the log is not where it was begun")
            return
        with log as file:
            left = os.fstat(file.fileno()).st_size
            name = os.path.basename(recording["path"])
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", "application/octet-stream")
            self.send_header("Content-Length", str(left))
            self.send_header("Content-Disposition", f'attachment; filename="{name}"')
            self.end_headers()
            while left > 0 and (chunk := file.read(min(CHUNK, left))):
                send_all(self.connection, chunk)
                left -= len(chunk)

    def _tell(self) -> None:
        """Switch to WebSocket, and tell until the browser goes or the bridge ends."""
        self.talk(lambda web: _Conversation(web, self.server.owner).run())


class _Conversation:
    """One browser: what it says is heard between two updates."""

    def __init__(self, web: WebSocket, owner: Inspector) -> None:
        self._web = web
        self._owner = owner
        self._view = View(owner.bridge)
        self._unseen = 0

    def run(self) -> None:
        """Until either side ends it. ValueError for nonsense, OSError if the browser vanishes."""
        next_tables = seen = 0.0
        while not self._owner.is_ending:
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
                self._web.send(text)
            if not self._listen(now + VALUES_INTERVAL) or now > seen + PATIENCE:
                return

    def _listen(self, until: float) -> bool:
        """Hear what the browser says up to a moment; False if it says no more."""
        while (left := until - time.monotonic()) > 0:
            heard = self._web.hear(left)
            if heard is None:
                return False
            for said in heard:
                if isinstance(said, bytes):
                    raise ValueError("requests are texts")
                self._unseen = max(0, self._unseen - self._view.hear(said))
        return True


class Inspector(HttpServer):
    """Serves the page, until it is closed. OSError if the port is taken, ImportError without wsproto.

    On other addresses than loopback it asks for a token, which `url` has.
    """

    handler = _Handler
    purpose = "inspector"

    def __init__(
        self,
        bridge: Bridge,
        host: str,
        port: int,
        token: str | None = None,
        names: Iterable[str] = (),
    ) -> None:
        import wsproto  # noqa: F401 - without it no browser would get more than an empty page

        self.token = token or ("" if is_loopback(host) else secrets.token_urlsafe(16))
        super().__init__(bridge, host, port, names)

    def answers_to(self, host: str) -> bool:
        """By whatever name it is asked for, if the token is needed all the same."""
        return bool(self.token) or super().answers_to(host)

    @property
    def note(self) -> str:
        """Where the page is."""
        return f"inspector at {self.url}"

    @property
    def url(self) -> str:
        """The address of the page."""
        query = f"?token={self.token}" if self.token else ""
        return f"http://{self.shown_address}/{query}"
