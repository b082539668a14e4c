"""The sink that others connect to: frames and messages over WebSocket.

A path names what a reader wants: `/PREFIX/out` all frames as they are, in binary messages, and
`/PREFIX/SYSTEM/COMPONENT/TYPE` messages as JSON, where `*` and a missing part mean any. Those that wait together are
one text, a list. A reader that is slower than the traffic gets the newest batch, and slows nobody.
"""

from __future__ import annotations

import asyncio
import socket
from concurrent.futures import Future
from contextlib import suppress
from typing import NamedTuple
from urllib.parse import quote

from .web_server import INTERVAL, WebServer, web

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from .bridge import Bridge

# Bytes that may wait for a reader. Beyond it only the newest batch waits.
MAX_WAITING = 512 * 1024
# Bytes that the system may hold back besides. Newer ones cannot replace those.
SEND_BUFFER = 64 * 1024
# The libraries of most readers take a message of 1 MiB.
MAX_TEXT = 256 * 1024
RAW = "out"


class _Item(NamedTuple):
    """One publication: the parts of its key, its bytes, and the number of frames in them."""

    key: tuple[str, ...]
    data: bytes
    frames: int = 1


class _Reader:
    """The queue of one connection. `wanted` are the parts of a key, `*` for any."""

    def __init__(self, wanted: list[str]) -> None:
        self._wanted = tuple(wanted)
        self._is_raw = wanted == [RAW]
        self._news = asyncio.Event()
        self._waiting: list[_Item] = []
        self._size = 0
        self.dropped = 0

    def offer(self, batch: list[_Item]) -> None:
        """Have it sent what it wants of a batch."""
        mine = [item for item in batch if self._wants(item.key)]
        if not mine:
            return
        size = sum(len(item.data) for item in mine)
        if self._size + size > MAX_WAITING:  # it is too slow: the newest batch is left
            self.dropped += sum(item.frames for item in self._waiting)
            self._waiting, self._size = [], 0
        self._waiting += mine
        self._size += size
        self._news.set()

    async def wait(self) -> None:
        """Wait a little for something to send."""
        with suppress(TimeoutError):
            async with asyncio.timeout(INTERVAL):
                await self._news.wait()
        self._news.clear()

    def _wants(self, key: tuple[str, ...]) -> bool:
        if len(key) == 1 or self._is_raw:
            return key == self._wanted
        return all(want in ("*", part) for want, part in zip(self._wanted, key, strict=False))

    def messages(self) -> Iterator[str | bytes]:
        """The waiting messages, which leave the queue."""
        waiting, self._waiting, self._size = self._waiting, [], 0
        if self._is_raw:
            yield from (item.data for item in waiting)
            return
        part: list[str] = []
        size = 0
        for item in waiting:
            if size > MAX_TEXT:
                yield f"[{','.join(part)}]"
                part, size = [], 0
            part.append(item.data.decode())
            size += len(item.data)
        if part:
            yield f"[{','.join(part)}]"


class WebSocketPublisher(WebServer):
    """Sends a sink's bytes to all clients that are connected. OSError if the port is taken."""

    def __init__(
        self, bridge: Bridge, host: str, port: int, prefix: str, names: Iterable[str]
    ) -> None:
        self._prefix = prefix
        self._batch: list[_Item] = []
        self._readers: set[_Reader] = set()
        self.dropped = 0
        """Frames that readers did not get because they were too slow."""
        super().__init__(bridge, host, port, names)

    @property
    def readers(self) -> int:
        """How many are connected."""
        return len(self._readers)

    @property
    def url(self) -> str:
        """Where readers connect to."""
        return f"ws://{self.shown_address}/{quote(self._prefix)}"

    # -- what a sink asks for

    def is_wanted(self) -> bool:
        """Whether someone is there."""
        return self.readers > 0

    def put(self, key: str, data: bytes, frames: int = 1) -> None:
        """Have it sent with the rest of the batch."""
        parts = tuple(key.removeprefix(f"{self._prefix}/").split("/"))
        self._batch.append(_Item(parts, data, frames))

    def flush(self, seconds: float) -> bool:
        """Hand the batch to the readers, of whom each has its own queue."""
        batch, self._batch = self._batch, []
        taken: Future[None] = Future()
        self._loop.call_soon_threadsafe(self._offer, batch, taken)
        with suppress(TimeoutError):
            taken.result(seconds)
            return True
        return False

    # -- readers

    def _offer(self, batch: list[_Item], taken: Future[None]) -> None:
        for reader in self._readers:
            before = reader.dropped
            reader.offer(batch)
            self.dropped += reader.dropped - before
        taken.set_result(None)

    async def get(self, request: web.BaseRequest) -> web.WebSocketResponse:
        wanted = self.wanted(request.path)
        if wanted is None:
            raise web.HTTPNotFound(text="nothing is published under this name")
        transport = request.transport
        if transport is not None:
            connection: socket.socket = transport.get_extra_info("socket")
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        return await self.talk(request, lambda web_socket: self._tell(web_socket, _Reader(wanted)))

    def wanted(self, path: str) -> list[str] | None:
        """The parts of the keys that a path names, None for one that names nothing."""
        name = path.strip("/")
        if name not in ("", self._prefix) and not name.startswith(f"{self._prefix}/"):
            return None
        parts = [part for part in name.removeprefix(self._prefix).split("/") if part]
        return parts if len(parts) <= 3 else None

    async def _tell(self, web_socket: web.WebSocketResponse, reader: _Reader) -> None:
        """Send what comes until either side ends it."""
        self._readers.add(reader)
        try:
            while not self.is_ending:
                await reader.wait()
                for message in reader.messages():
                    if isinstance(message, str):
                        await web_socket.send_str(message)
                    else:
                        await web_socket.send_bytes(message)
        finally:
            self._readers.discard(reader)
