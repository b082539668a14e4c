"""Sinks: what a bridge sees, published over MQTT, Zenoh and WebSocket by a thread on the batch iterator.

`PREFIX/out` gets all frames as they are, those of a batch one behind the other, and `PREFIX/SYSTEM/COMPONENT/TYPE` each
message as JSON. A sink hands over one batch at a time and waits until it has left. Frames that come meanwhile wait in the
bridge's tap, which is bounded: a slow sink loses the oldest frames, which are counted, and slows nothing.
"""

from __future__ import annotations

import json
import socket
import threading
import time
from contextlib import ExitStack, suppress
from urllib.parse import SplitResult, unquote, urlsplit

from mavwire._extras import extra
from mavwire._threads import start_thread

from .errors import ConfigError
from .inspector_tables import plain

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any, Protocol, Self

    from mavwire._native import FrameBatch

    from .bridge import Bridge

    class Publisher(Protocol):
        """Where a sink's bytes go."""

        @property
        def dropped(self) -> int:
            """Frames that it dropped because their receivers are too slow."""

        def is_wanted(self) -> bool:
            """Whether anyone gets it."""

        def put(self, key: str, data: bytes, frames: int = 1) -> None:
            """Publish what so many frames are in, OSError if that is not possible now."""

        def flush(self, seconds: float) -> bool:
            """Wait so long until what was put has left, and say whether it has; OSError if it is lost."""

        def close(self) -> None:
            """End the connection."""


DEFAULT_PREFIX = "mavlink"
MQTT_PORT, MQTTS_PORT = 1883, 8883
FORMS = (
    "mqtt://HOST/PREFIX, mqtts://USER:PASSWORD@HOST:PORT/PREFIX, zenoh:, zenoh:tcp/HOST:PORT "
    "or ws://HOST:PORT/PREFIX"
)
MAX_PUBLISHERS = 16_384
# How often a sink whose batch has not left yet looks whether it shall end, and after how long it says that this is slow.
INTERVAL = 0.25
SLOW = 5.0
# How long `close` waits for all of them together.
CLOSE_TIME = 1.5
# Bytes that the system may buffer for MQTT. They count as published, and newer frames cannot replace them.
SEND_BUFFER = 64 * 1024


class Sink:
    """Publishes until it is closed or the bridge stops. `published` counts frames that left, the unknown ones in
    `PREFIX/out` alone; `failed` those of batches that did not leave whole, the last time for the reason in `error`.
    """

    def __init__(self, bridge: Bridge, publisher: Publisher, prefix: str, name: str) -> None:
        self.name = name
        self.published = 0
        self.failed = 0
        self.error: str | None = None
        self._closing = threading.Event()
        self._publisher = publisher
        self._prefix = prefix
        with ExitStack() as undo:
            undo.callback(publisher.close)
            self._batches = bridge.frames()
            undo.callback(self._batches.close)
            self._thread = start_thread(self._run, "mavwire-sink")
            undo.pop_all()
        self._listed = bridge.sinks
        self._listed.append(self)

    @property
    def note(self) -> str:
        """A line for the user about it."""
        return f"publishing to {self.name}"

    @property
    def dropped(self) -> int:
        """Frames that were dropped because the other end, or this one, was too slow."""
        return self._batches.dropped + self._publisher.dropped

    def stats(self) -> dict[str, Any]:
        """Its entry in `Bridge.stats()`."""
        return {
            "name": self.name,
            "published": self.published,
            "failed": self.failed,
            "dropped": self.dropped,
            "error": self.error,
        }

    def _run(self) -> None:
        try:
            for batch in self._batches:
                if self._publisher.is_wanted():
                    self._publish(batch)
        finally:
            self._publisher.close()

    def _publish(self, batch: FrameBatch) -> None:
        try:
            self._publisher.put(f"{self._prefix}/out", batch.raw, len(batch))
            for message in batch:
                self._put(message)
            begun = time.monotonic()
            while not self._publisher.flush(INTERVAL):
                if self._closing.is_set():
                    raise OSError("closed before all had left")
                if time.monotonic() - begun > SLOW:
                    self.error = "the broker accepts data too slowly"
        except OSError as error:
            self.failed += len(batch)
            self.error = str(error)
        else:
            self.published += len(batch)
            self.error = None

    def _put(self, message: Any) -> None:
        if message.get_msgId() < 0:
            return  # the dialect does not know it
        who = f"{message.get_srcSystem()}/{message.get_srcComponent()}"
        key = f"{self._prefix}/{who}/{message.get_type()}"
        self._publisher.put(key, json.dumps(described(message)).encode())

    def close(self) -> None:
        """Publish no more, and hang up. An other end that does not let go within CLOSE_TIME is left to the thread."""
        close_all([self])

    def _begin_to_close(self) -> None:
        self._closing.set()
        self._batches.close()

    def _finish_closing(self, deadline: float) -> None:
        self._thread.join(max(deadline - time.monotonic(), 0))
        if self in self._listed:
            self._listed.remove(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def close_all(sinks: Iterable[Sink]) -> None:
    """Close sinks side by side: however many of them are stuck, this takes CLOSE_TIME at most."""
    sinks, deadline = list(sinks), time.monotonic() + CLOSE_TIME
    for sink in sinks:
        sink._begin_to_close()
    for sink in sinks:
        sink._finish_closing(deadline)


def described(message: Any) -> dict[str, Any]:
    """A message as JSON can hold it: who sent it and when, its type, and its fields by name."""
    return {
        "type": message.get_type(),
        "system": message.get_srcSystem(),
        "component": message.get_srcComponent(),
        "sequence": message.get_seq(),
        "time": message._timestamp,
        "fields": {name: plain(getattr(message, name)) for name in message.fieldnames},
    }


def open_sink(
    bridge: Bridge, text: str, *, password: str | None = None, names: Iterable[str] = ()
) -> Sink:
    """A sink as a user writes it: one of FORMS. `password`: for an address that has only a user.

    `names`: of the hosts whose pages may read over WebSocket, and that a proxy in front of it answers to.
    ConfigError for another text, ImportError if the client library is missing, OSError if it cannot
    be opened. A broker that does not answer yet is tried again and again.
    """
    names, (word, _, place) = tuple(names), text.partition(":")
    word, shown = word.lower(), text
    if "@" in text and word != "zenoh":
        shown = f"{word}://{text.rpartition('@')[2]}"  # without the password
    if password is not None and word not in ("mqtt", "mqtts"):
        raise ConfigError(f"{shown}: only a broker of MQTT is told a password")
    if names and word != "ws":
        raise ConfigError(f"{shown}: only ws: answers to names")
    if word == "zenoh":
        publisher, prefix = _zenoh(place), DEFAULT_PREFIX
    elif word in ("mqtt", "mqtts"):
        publisher, prefix = _mqtt(text, password)
    elif word == "ws":
        from .web_sink import WebSocketPublisher

        url, port, prefix = _split(text)
        if port is None or url.query or "@" in url.netloc:
            raise ConfigError("a WebSocket needs a port to listen on: ws://HOST:PORT/PREFIX")
        try:
            publisher = WebSocketPublisher(bridge, url.hostname or "127.0.0.1", port, prefix, names)
        except OSError as error:
            raise OSError(error.errno, error.strerror or str(error), text) from None
        shown = publisher.url
    else:
        raise ConfigError(f"{shown!r} is no sink; say {FORMS}")
    return Sink(bridge, publisher, prefix, shown)


def _split(text: str) -> tuple[SplitResult, int | None, str]:
    """An address, its port and the prefix that it names. Error texts do not show it: it may have a password."""
    try:
        url = urlsplit(text)
        port, prefix = url.port, unquote(url.path, errors="strict").strip("/") or DEFAULT_PREFIX
    except ValueError:
        reason = f"a sink's port or host is wrong; say {FORMS}"
        raise ConfigError(f"{reason}, and in a user or password %2F for / and %40 for @") from None
    if not prefix.isprintable():
        raise ConfigError(f"a sink's prefix has characters that nobody sees: {prefix!r}")
    return url, port, prefix


def _mqtt(text: str, password: str | None) -> tuple[Publisher, str]:
    url, port, prefix = _split(text)
    if not url.hostname or url.query:
        raise ConfigError(f"no address of an MQTT broker; say {FORMS}")
    if "#" in text or "#" in prefix or "+" in prefix:
        raise ConfigError("topics that MQTT publishes to have neither # nor +")
    secure = url.scheme == "mqtts"
    user = None if url.username is None else unquote(url.username)
    if url.password is not None:
        if password is not None:
            reason = "a password stands in the address and beside it; say one"
            raise ConfigError(reason)
        password = unquote(url.password)
    if password is not None and user is None:
        raise ConfigError("a password needs a user: mqtts://USER@HOST")
    port = port or (MQTTS_PORT if secure else MQTT_PORT)
    return _Mqtt(url.hostname, port, secure, user, password), prefix


class _Mqtt:
    """A client of a broker, which connects by itself, again and again."""

    dropped = 0

    def __init__(
        self, host: str, port: int, secure: bool, user: str | None, password: str | None
    ) -> None:
        with extra("mqtt"):
            from paho.mqtt.client import Client
            from paho.mqtt.enums import CallbackAPIVersion

        self._client = Client(CallbackAPIVersion.VERSION2)
        self._client.reconnect_delay_set(1, 8)
        if secure:
            self._client.tls_set()
        if user is not None:
            self._client.username_pw_set(user, password)
        self._refusal: str | None = None
        self._client.on_connect = self._hear
        self._client.on_socket_open = _limit_send_buffer
        self._client.connect_async(host, port)
        self._client.loop_start()
        self._last: Any = None

    def _hear(self, client: Any, data: Any, flags: Any, code: Any, properties: Any) -> None:
        """Keep the broker's reason if it refuses a connection."""
        self._refusal = str(code) if code.is_failure else None

    def is_wanted(self) -> bool:
        """A broker may keep what nobody subscribes to."""
        return True

    def put(self, key: str, data: bytes, frames: int = 1) -> None:
        if not self._client.is_connected():
            refusal = self._refusal
            raise OSError(
                f"the broker says: {refusal}" if refusal else "the broker does not answer"
            )
        self._last = self._client.publish(key, data)

    def flush(self, seconds: float) -> bool:
        try:
            self._last.wait_for_publish(seconds)
            return bool(self._last.is_published())
        except (RuntimeError, ValueError) as error:
            raise OSError(str(error)) from None

    def close(self) -> None:
        self._client.disconnect()
        connection: Any = self._client.socket()
        with suppress(OSError):
            if connection is not None and self._last is not None and not self.flush(0):
                # The client's thread would send all that is left first, however slowly that is taken.
                connection.shutdown(socket.SHUT_RDWR)
        self._client.loop_stop()


def _limit_send_buffer(client: Any, data: Any, connection: Any) -> None:
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)


def _zenoh(endpoint: str) -> Publisher:
    with extra("zenoh"):
        import zenoh

    config = zenoh.Config()
    if endpoint:
        try:
            config.insert_json5("connect/endpoints", json.dumps([endpoint]))
        except zenoh.ZError:
            reason = f"{endpoint!r} is no endpoint of Zenoh; say tcp/HOST:PORT"
            raise ConfigError(f"zenoh: {reason}") from None
        config.insert_json5("scouting/multicast/enabled", "false")
        # One that does not answer yet is tried again, in the background.
        config.insert_json5("connect/exit_on_failure", "false")
        config.insert_json5("connect/timeout_ms", "0")
    try:
        return _Zenoh(zenoh.open(config))
    except zenoh.ZError as error:
        raise OSError(f"zenoh:{endpoint}: {error}") from None


class _Zenoh:
    """A session with a publisher for each key, of which there are as many as kinds of messages."""

    dropped = 0

    def __init__(self, session: Any) -> None:
        self._session = session
        self._publishers: dict[str, Any] = {}

    def is_wanted(self) -> bool:
        """Someone may come at any time."""
        return True

    def put(self, key: str, data: bytes, frames: int = 1) -> None:
        import zenoh

        try:
            if len(self._publishers) >= MAX_PUBLISHERS:
                for publisher in self._publishers.values():
                    publisher.undeclare()
                self._publishers.clear()  # someone makes up addresses
            if key not in self._publishers:
                # Zenoh would not count what it drops. With BLOCK the sink drops and counts.
                block = zenoh.CongestionControl.BLOCK
                self._publishers[key] = self._session.declare_publisher(
                    key, congestion_control=block
                )
            self._publishers[key].put(data)
        except zenoh.ZError as error:
            raise OSError(str(error)) from None

    def flush(self, seconds: float) -> bool:
        """True: `put` has sent everything before it returns."""
        return True

    def close(self) -> None:
        self._session.close()
