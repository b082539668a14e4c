"""The sink that others connect to: frames and messages over WebSocket.

A path names what a reader wants: `/PREFIX/out` all frames as they are, in binary messages, and
`/PREFIX/SYSTEM/COMPONENT/TYPE` messages as JSON, where `*` and what is left out stand for any. Those that wait together are
one text, a list. A reader that is slower than the traffic gets the newest of each kind, and slows nobody.
"""

from __future__ import annotations

import socket
import threading
from http import HTTPStatus
from typing import NamedTuple
from urllib.parse import quote, unquote, urlsplit

from .serving import Handler, HttpServer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from .bridge import Bridge
    from .web_socket import WebSocket

# What may wait for a reader; beyond it only the newest of each kind does.
MAX_WAITING = 512 * 1024
# What the system may hold back for it besides, which nobody can replace by something newer.
SEND_BUFFER = 64 * 1024
# The libraries of most readers take a message of 1 MiB.
MAX_TEXT = 256 * 1024
# How often a reader is listened to that gets nothing.
INTERVAL = 0.1
RAW = "out"


class _Item(NamedTuple):
    """What is published under a key, and how many frames are in it."""

    key: str
    data: bytes
    frames: int = 1


class _Reader:
    """What waits for one connection. `wanted` are the parts of a key, `*` for any."""

    def __init__(self, wanted: list[str]) -> None:
        self._wanted = wanted
        self._is_raw = wanted == [RAW]
        self._news = threading.Condition()
        self._waiting: list[_Item] = []
        self._size = 0
        self.dropped = 0

    def offer(self, batch: list[_Item]) -> None:
        """Have it sent what it wants of a batch."""
        mine = [item for item in batch if self._wants(item.key.split("/"))]
        if not mine:
            return
        with self._news:
            self._waiting += mine
            self._size += sum(len(item.data) for item in mine)
            if self._size > MAX_WAITING:
                self._keep_newest()
            self._news.notify()

    def _wants(self, parts: list[str]) -> bool:
        if len(parts) == 1 or self._is_raw:
            return parts == self._wanted
        return all(want in ("*", part) for want, part in zip(self._wanted, parts, strict=False))

    def _keep_newest(self) -> None:
        """Keep the newest of each kind, and of more kinds than there is room for those that came last."""
        kept: list[_Item] = []
        seen: set[str] = set()
        size = 0
        for item in reversed(self._waiting):
            is_newest = item.key not in seen
            seen.add(item.key)
            if is_newest and (not kept or size + len(item.data) <= MAX_WAITING // 2):
                kept.append(item)
                size += len(item.data)
            else:
                self.dropped += item.frames
        self._waiting = kept[::-1]
        self._size = size

    def messages(self) -> Iterator[str | bytes]:
        """What waits, if need be after waiting for it a little."""
        with self._news:
            if not self._waiting:
                self._news.wait(INTERVAL)
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


class _Handler(Handler):
    def get(self) -> None:
        wanted = self.server.owner.wanted(unquote(urlsplit(self.path).path))
        if wanted is None:
            self.send_error(HTTPStatus.NOT_FOUND, "nothing is published under this name")
            return
        self.talk(lambda web: self.server.owner.tell(web, _Reader(wanted), self.connection))


class WebSocketPublisher(HttpServer):
    """Where a sink's bytes go: to whoever is connected. OSError if the port is taken, ImportError without wsproto."""

    handler = _Handler

    def __init__(
        self, bridge: Bridge, host: str, port: int, prefix: str, names: Iterable[str]
    ) -> None:
        import wsproto  # noqa: F401 - without it nobody could connect

        self._prefix = prefix
        self._batch: list[_Item] = []
        self._lock = threading.Lock()
        self._readers: set[_Reader] = set()
        self._dropped = 0
        super().__init__(bridge, host, port, names)

    @property
    def url(self) -> str:
        """Where readers connect to."""
        return f"ws://{self.shown_address}/{quote(self._prefix)}"

    @property
    def readers(self) -> int:
        """How many are connected."""
        with self._lock:
            return len(self._readers)

    # -- what a sink asks for

    def is_wanted(self) -> bool:
        """Whether someone is there."""
        return self.readers > 0

    @property
    def dropped(self) -> int:
        """Frames that readers did not get because they were too slow."""
        with self._lock:
            return self._dropped + sum(reader.dropped for reader in self._readers)

    def put(self, key: str, data: bytes, frames: int = 1) -> None:
        """Have it sent with the rest of the batch."""
        self._batch.append(_Item(key.removeprefix(f"{self._prefix}/"), data, frames))

    def flush(self, seconds: float) -> bool:
        """Nothing to do: each reader has its own queue."""
        batch, self._batch = self._batch, []
        with self._lock:
            readers = list(self._readers)
        for reader in readers:
            reader.offer(batch)
        return True

    # -- readers

    def wanted(self, path: str) -> list[str] | None:
        """The parts of the keys that a path names, None for one that names nothing."""
        name = path.strip("/")
        if name not in ("", self._prefix) and not name.startswith(f"{self._prefix}/"):
            return None
        parts = [part for part in name.removeprefix(self._prefix).split("/") if part]
        return parts if len(parts) <= 3 else None

    def tell(self, web: WebSocket, reader: _Reader, connection: socket.socket) -> None:
        """Send what comes until either side ends it. OSError if the reader vanishes."""
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        with self._lock:
            self._readers.add(reader)
        try:
            while not self.is_ending:
                for message in reader.messages():
                    web.send(message)
                if web.hear(0) is None:  # what it says is nothing to us
                    return
        finally:
            with self._lock:
                self._readers.discard(reader)
                self._dropped += reader.dropped
