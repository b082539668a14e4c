"""The web inspector: a page that shows what a bridge sees, and the WebSocket that feeds it.

It asks the bridge for counts and for the newest values of what a page has open, and sends them once the page has seen what
was sent before. So a slow browser gets the newest values and none that waited, and frames cost nothing here.
"""

from __future__ import annotations

import asyncio
import hmac
import os
import secrets
import time
from collections.abc import Iterable

from .bridge import Bridge
from .inspector_tables import View
from .web_server import INTERVAL, PATIENCE, WebServer, closed_after, is_loopback, web

PAGE = os.path.join(os.path.dirname(__file__), "inspector.html")
# Seconds between two updates of everything. Values are updated each INTERVAL.
TABLES_INTERVAL = 0.5
# Texts that may be on their way to a page: two updates.
MAX_UNSEEN = 4
CHUNK = 64 * 1024


class _Conversation:
    """One browser."""

    def __init__(self, owner: Inspector) -> None:
        self._owner = owner
        self._view = View(owner.bridge)
        self._unseen = 0

    async def tell(self, socket: web.WebSocketResponse) -> None:
        """Send updates until the bridge ends, or the page sees none of them for long."""
        next_tables, seen = 0.0, time.monotonic()
        while not self._owner.is_ending and (now := time.monotonic()) < seen + PATIENCE:
            texts: list[str | None] = []
            if self._unseen < MAX_UNSEEN:
                seen = now
                if now >= next_tables:
                    next_tables = now + TABLES_INTERVAL
                    texts.append(self._view.tables())
                texts.append(self._view.values())
            for text in filter(None, texts):
                self._unseen += 1
                await socket.send_str(text)
            await asyncio.sleep(now + INTERVAL - time.monotonic())

    def hear(self, text: str) -> None:
        """Take in a message of the page. ValueError for nonsense."""
        self._unseen = max(0, self._unseen - self._view.hear(text))


class Inspector(WebServer):
    """Serves the page, until it is closed. OSError if the port is taken.

    On other addresses than loopback it asks for a token, which `url` has.
    """

    def __init__(
        self,
        bridge: Bridge,
        host: str,
        port: int,
        token: str | None = None,
        names: Iterable[str] = (),
    ) -> None:
        self.token = token or ("" if is_loopback(host) else secrets.token_urlsafe(16))
        super().__init__(bridge, host, port, names)

    def answers_to(self, host: str) -> bool:
        """With a token any host name will do: the name proves nothing more."""
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

    def check(self, request: web.BaseRequest) -> None:
        super().check(request)
        given = request.query.get("token", "").encode(errors="replace")
        if self.token and not hmac.compare_digest(given, self.token.encode()):
            reason = "the address lacks the token that the bridge printed"
            raise web.HTTPForbidden(text=reason)

    async def get(self, request: web.BaseRequest) -> web.StreamResponse:
        if request.path == "/":
            return _page()
        if request.path == "/ws":
            conversation = _Conversation(self)
            return await self.talk(request, conversation.tell, conversation.hear)
        if request.path == "/recording":
            return await self._recording(request)
        raise web.HTTPNotFound

    async def _recording(self, request: web.BaseRequest) -> web.StreamResponse:
        """The log that is being written, as far as it is."""
        recording = self.bridge.stats()["recording"]
        if recording is None:
            raise web.HTTPNotFound(text="nothing is recorded")
        try:
            log = open(recording["path"], "rb")
        except OSError:
            raise web.HTTPNotFound(text="the log is not where it was begun") from None
        with log:
            left = os.fstat(log.fileno()).st_size
            name = os.path.basename(recording["path"])
            response = closed_after(web.StreamResponse())
            response.headers["Content-Disposition"] = f'attachment; filename="{name}"'
            response.content_length = left
            await response.prepare(request)
            while left > 0 and (chunk := log.read(min(CHUNK, left))):
                await response.write(chunk)
                left -= len(chunk)
        return response


def _page() -> web.Response:
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
    return web.Response(text=page, content_type="text/html", headers=headers)
