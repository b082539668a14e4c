"""A web server beside a bridge: aiohttp on a thread, and the rules for who may ask.

The base of the inspector, the metrics and the WebSocket sink.
"""

from __future__ import annotations

import asyncio
import ipaddress
import logging
import re
import socket
from contextlib import ExitStack, closing
from urllib.parse import urlsplit

from mavwire._extras import extra
from mavwire._threads import start_thread

with extra("web"):
    from aiohttp import WSMsgType, web

# `web` is aiohttp's, for the servers.
__all__ = ["INTERVAL", "PATIENCE", "WebServer", "closed_after", "is_loopback", "web"]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable
    from typing import Any, Self

    from .bridge import Bridge

    Tell = Callable[[web.WebSocketResponse], Awaitable[None]]

MAX_CONNECTIONS = 64
# Seconds for a request to arrive, and how long a page may be silent.
REQUEST_TIME = 10.0
PATIENCE = 30.0
# How often a conversation looks whether it shall end, and how long the end of all of them may take twice.
INTERVAL = 0.1
CLOSE_TIME = 0.5
# A request over WebSocket is shorter.
MAX_REQUEST = 16 * 1024
# Standard error belongs to the program.
_SILENT = logging.Logger("mavwire.web", logging.CRITICAL + 1)


class WebServer:
    """Answers requests about a bridge on a thread, until it is closed. OSError if the port is taken.

    `names`: further host names that it answers to, such as that of a proxy in front of it.
    """

    purpose: str

    def __init__(self, bridge: Bridge, host: str, port: int, names: Iterable[str] = ()) -> None:
        self.bridge = bridge
        self.connections: set[_Connection] = set()
        self._host = host
        self._names = frozenset(name.lower() for name in names)
        self._is_closing = False
        self._stop = asyncio.Event()
        with ExitStack() as undo:
            self._socket = undo.enter_context(_listening(host, port))
            self.port: int = self._socket.getsockname()[1]
            """The port it listens on."""
            # Not the loop of a policy that the program may have set.
            self._loop = undo.enter_context(closing(asyncio.SelectorEventLoop()))
            self._thread = start_thread(self._run, "mavwire-web")
            undo.pop_all()

    @property
    def is_ending(self) -> bool:
        """Whether it was closed, or the bridge was stopped."""
        return self._is_closing or not self.bridge.running

    @property
    def note(self) -> str:
        """A line for the user about it."""
        return f"{self.purpose} on port {self.port}"

    @property
    def shown_address(self) -> str:
        """Host and port as in a URL that others can open."""
        address = _address(self._host)
        host = socket.gethostname() if address and address.is_unspecified else self._host
        return f"{f'[{host}]' if ':' in host else host}:{self.port}"

    def close(self) -> None:
        """Answer no more, and end all conversations."""
        self._is_closing = True
        if self._thread.is_alive():  # a forked child has no such thread
            self._loop.call_soon_threadsafe(self._stop.set)
            self._thread.join()
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    # -- on the thread

    def _run(self) -> None:
        with asyncio.Runner(loop_factory=lambda: self._loop) as runner:
            runner.run(self._serve())

    async def _serve(self) -> None:
        self._loop.set_exception_handler(lambda *_: None)
        server = web.Server(self._answer)
        listener = await self._loop.create_server(
            lambda: _Connection(self, server, self._loop), sock=self._socket
        )
        await self._stop.wait()
        listener.close()
        server.pre_shutdown()
        await server.shutdown(CLOSE_TIME)

    async def _answer(self, request: web.BaseRequest) -> web.StreamResponse:
        connection = request.protocol
        assert isinstance(connection, _Connection)
        connection.deadline.cancel()
        try:
            self.check(request)
            response = await self.get(request)
            return response if response.prepared else closed_after(response)
        except web.HTTPException as error:
            closed_after(error)
            raise
        except RuntimeError:
            reason = "the bridge has stopped"
            return closed_after(web.Response(status=503, text=reason))

    def check(self, request: web.BaseRequest) -> None:
        """Refuse a page of another site that asks in its visitor's name: the names in Host and Origin must be ours."""
        if request.method != "GET":
            raise web.HTTPMethodNotAllowed(request.method, ["GET"])
        host, origin = request.headers.get("Host"), request.headers.get("Origin")
        if host is None and origin is None:
            return  # no browser: these say whom they ask
        if not self.answers_to(host or "") or not (
            origin is None or self.welcomes(origin, host or "")
        ):
            raise web.HTTPForbidden(
                text="not for this host or origin: names = [...] in the configuration file adds one"
            )

    def answers_to(self, host: str) -> bool:
        """Whether a Host header may name this server. Anyone can have another name lead here, and its page ask."""
        name = re.sub(r":[0-9]*$", "", host.lower()).strip("[]")
        if is_loopback(name) or name in self._names:
            return True
        if is_loopback(self._host):
            return False
        return _address(name) is not None or name in _own_names(self._host)

    def welcomes(self, origin: str, host: str) -> bool:
        """Whether a page from `origin` may ask who was asked for as `host`: ours may, over a proxy with TLS too."""
        try:
            url = urlsplit(origin.lower())
            return url.scheme in ("http", "https") and (
                url.netloc == host.lower() or url.hostname in self._names
            )
        except ValueError:
            return False

    async def get(self, request: web.BaseRequest) -> web.StreamResponse:
        """The answer to a request. RuntimeError once the bridge has stopped."""
        raise NotImplementedError

    async def talk(
        self, request: web.BaseRequest, tell: Tell, hear: Callable[[str], None] | None = None
    ) -> web.WebSocketResponse:
        """Switch to WebSocket. `tell` sends until it returns; `hear` gets each text, and raises ValueError for nonsense."""
        socket = web.WebSocketResponse(
            timeout=CLOSE_TIME / 2, max_msg_size=MAX_REQUEST, compress=False
        )
        await socket.prepare(request)
        request.protocol.is_web_socket = True  # type: ignore[attr-defined]

        async def tell_all() -> None:
            try:
                await tell(socket)
            except (OSError, RuntimeError):  # the other side vanished, or the bridge has stopped
                pass
            await socket.close(code=1001, message=b"the bridge has stopped")

        async with asyncio.TaskGroup() as group:
            telling = group.create_task(tell_all())
            try:
                async for message in socket:
                    if hear and message.type is not WSMsgType.TEXT:
                        raise ValueError("requests are texts")
                    if hear:
                        hear(message.data)
            except ValueError:
                await socket.close(code=1007, message=b"not understood")
            telling.cancel()
        return socket


class _Connection(web.RequestHandler):
    """A connection for one request, which has to arrive in time."""

    def __init__(
        self, owner: WebServer, server: web.Server, loop: asyncio.AbstractEventLoop
    ) -> None:
        super().__init__(server, loop=loop, access_log=None, logger=_SILENT, lingering_time=0)  # type: ignore[arg-type]
        self._owner = owner
        self.is_web_socket = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        full = len(self._owner.connections) >= MAX_CONNECTIONS
        self._owner.connections.add(self)
        abort = transport.abort  # type: ignore[attr-defined]
        self.deadline = self._loop.call_later(0 if full else REQUEST_TIME, abort)

    def connection_lost(self, exc: BaseException | None) -> None:
        super().connection_lost(exc)
        self.deadline.cancel()
        self._owner.connections.discard(self)

    def eof_received(self) -> bool:  # type: ignore[override]
        """Keep a connection whose client has finished sending, so that it gets its answer."""
        return not self.is_web_socket

    def handle_error(self, *arguments: Any, **named: Any) -> web.StreamResponse:
        return closed_after(super().handle_error(*arguments, **named))


def closed_after(response: web.StreamResponse) -> web.StreamResponse:
    """A response that says little of the server, and after which the connection is closed."""
    response.headers.update({"Server": "mavwire", "X-Content-Type-Options": "nosniff"})
    response.force_close()
    return response


def _listening(host: str, port: int) -> socket.socket:
    if ":" not in host:
        return socket.create_server((host, port))
    both = socket.has_dualstack_ipv6()
    return socket.create_server((host, port), family=socket.AF_INET6, dualstack_ipv6=both)


def _own_names(host: str) -> set[str]:
    """Names of a server that listens on `host`: that one, and the names of this machine."""
    machine = socket.gethostname().lower()
    short = machine.partition(".")[0]
    return {host.lower(), machine, short, f"{short}.local"}


def is_loopback(host: str) -> bool:
    """Whether a name or an address leads to this machine alone."""
    address = _address(host)
    return host == "localhost" if address is None else address.is_loopback


def _address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """None for a name."""
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None
