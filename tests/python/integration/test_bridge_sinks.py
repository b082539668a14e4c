"""Sinks beside real ones: Mosquitto, and a Zenoh peer in a process of its own."""

from __future__ import annotations

import json
import queue
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from mavwire import Bridge
from mavwire.bridge import BridgeError, ConfigError, sinks
from mavwire.bridge.sinks import Sink, open_sink
from unit.bridge_tools import LIMIT, wait_until
from unit.link_tools import heartbeat

BROKER = shutil.which("mosquitto", path="/usr/sbin:/usr/local/sbin:/usr/bin:/usr/local/bin")


@contextmanager
def port_for_a_server() -> Iterator[int]:
    """A port that no connection of anyone gets, and that a server may listen on."""
    with socket.socket() as holder:
        holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        holder.bind(("127.0.0.1", 0))
        yield int(holder.getsockname()[1])


def check(raw: bytes, text: bytes) -> None:
    """What came of a HEARTBEAT of system 7."""
    assert raw == heartbeat(sysid=7, seq=5)
    told = json.loads(text)
    assert (told["type"], told["system"], told["component"], told["sequence"]) == (
        "HEARTBEAT", 7, 1, 5,
    )  # fmt: skip
    assert told["fields"]["autopilot"] == 3 and told["time"] > 1e9


@pytest.mark.skipif(BROKER is None, reason="no Mosquitto: apt-get install mosquitto")
def test_mqtt(tmp_path: Path) -> None:
    pytest.importorskip(
        "paho.mqtt", reason="paho-mqtt is not installed: pip install 'mavwire[mqtt]'"
    )
    from paho.mqtt.client import Client
    from paho.mqtt.enums import CallbackAPIVersion

    assert BROKER is not None
    conf = tmp_path / "conf"
    with (
        port_for_a_server() as port,
        Bridge() as bridge,
        open_sink(bridge, f"mqtt://127.0.0.1:{port}/field/one") as sink,
    ):
        conf.write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
        bridge.send(heartbeat())
        wait_until("the error", lambda: sink.error == "the broker does not answer")
        (told,) = bridge.stats()["sinks"]
        assert (told["name"], told["failed"], told["published"]) == (sink.name, 1, 0)
        client = Client(CallbackAPIVersion.VERSION2)
        broker = subprocess.Popen([BROKER, "-c", str(conf)], stderr=subprocess.DEVNULL)
        try:
            came: queue.Queue[tuple[str, bytes]] = queue.Queue()
            client.on_message = lambda *message: came.put((message[2].topic, message[2].payload))
            subscribed = threading.Event()
            client.on_subscribe = lambda *_: subscribed.set()
            client.on_connect = lambda *_: client.subscribe("field/#")
            client.reconnect_delay_set(1, 1)
            client.connect_async("127.0.0.1", port)
            client.loop_start()
            wait_until("it", lambda: subscribed.is_set() or broker.poll() is not None)
            if not subscribed.is_set():
                pytest.skip("Mosquitto does not start here")

            def connected() -> bool:
                bridge.send(heartbeat(sysid=7, seq=5))
                return sink.published > 0

            wait_until("the broker", connected)
            (raw_topic, raw), (topic, text) = came.get(timeout=LIMIT), came.get(timeout=LIMIT)
            assert (raw_topic, topic) == ("field/one/out", "field/one/7/1/HEARTBEAT")
            check(raw[:21], text)
            client.disconnect()
        finally:
            client.loop_stop()
            broker.terminate()
            broker.wait(LIMIT)


SUBSCRIBER = """
import sys, zenoh
config = zenoh.Config()
config.insert_json5("listen/endpoints", '["tcp/127.0.0.1:%s"]' % sys.argv[1])
config.insert_json5("scouting/multicast/enabled", "false")
with zenoh.open(config) as session:
    subscriber = session.declare_subscriber("mavlink/**")
    print("ready", flush=True)
    for sample in subscriber:
        print(sample.key_expr, bytes(sample.payload).hex(), flush=True)
"""


def test_zenoh() -> None:
    pytest.importorskip("zenoh", reason="zenoh is not installed: pip install 'mavwire[zenoh]'")
    with port_for_a_server() as port:
        publish_to_a_peer(port)


def publish_to_a_peer(port: int) -> None:
    """The peer listens on the port."""
    peer = subprocess.Popen(
        [sys.executable, "-c", SUBSCRIBER, str(port)], stdout=subprocess.PIPE, text=True
    )
    try:
        assert peer.stdout is not None
        if peer.stdout.readline() != "ready\n":
            pytest.skip("a Zenoh peer does not start here")
        came: dict[str, bytes] = {}
        with Bridge() as bridge, open_sink(bridge, f"zenoh:tcp/127.0.0.1:{port}"):
            lines: queue.Queue[Any] = queue.Queue()
            reader = threading.Thread(
                target=lambda: [lines.put(line.split()) for line in peer.stdout or ()], daemon=True
            )
            reader.start()

            def arrived() -> bool:
                bridge.send(heartbeat(sysid=7, seq=5))
                while not lines.empty():
                    key, data = lines.get()
                    came[key] = bytes.fromhex(data)
                return len(came) == 2

            wait_until("both", arrived)
        check(came["mavlink/out"][:21], came["mavlink/7/1/HEARTBEAT"])
    finally:
        peer.terminate()
        peer.wait(LIMIT)


def test_a_broker_that_refuses_is_told_from_one_that_is_silent() -> None:
    pytest.importorskip(
        "paho.mqtt", reason="paho-mqtt is not installed: pip install 'mavwire[mqtt]'"
    )
    with socket.create_server(("127.0.0.1", 0)) as broker, Bridge() as bridge:
        broker.settimeout(LIMIT)
        with open_sink(bridge, f"mqtt://rover:bad@127.0.0.1:{broker.getsockname()[1]}/x") as sink:
            connection, _ = broker.accept()
            with connection:
                assert connection.recv(1000)
                connection.sendall(bytes([0x20, 2, 0, 5]))  # CONNACK of version 3.1.1

                def told() -> bool:
                    bridge.send(heartbeat())
                    return sink.error == "the broker says: Not authorized"

                wait_until("the reason", told)


class SlowBroker:
    """Accepts one client of MQTT 3.1.1, and reads nothing more of it until `go_on` is set."""

    def __init__(self) -> None:
        self.go_on = threading.Event()
        self.connected = threading.Event()
        self.came = bytearray()
        self._listener = socket.socket()
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self._listener.bind(("127.0.0.1", 0))
        self._listener.listen()
        self.port = int(self._listener.getsockname()[1])
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        with suppress(OSError):
            connection, _ = self._listener.accept()
            with connection:
                connection.recv(1000)
                connection.sendall(bytes([0x20, 2, 0, 0]))  # CONNACK
                self.connected.set()
                self.go_on.wait()
                while data := connection.recv(65536):
                    self.came += data

    def __enter__(self) -> SlowBroker:
        return self

    def __exit__(self, *exception: object) -> None:
        self.go_on.set()
        self._listener.close()


def send_many(bridge: Bridge) -> int:
    """More than the system takes for a broker that does not read."""
    for _ in range(20):
        bridge.send(heartbeat(sysid=7) * 1000)
    return 20_000


def test_a_slow_broker_gets_one_batch_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip(
        "paho.mqtt", reason="paho-mqtt is not installed: pip install 'mavwire[mqtt]'"
    )
    monkeypatch.setattr(sinks, "SLOW", 0.1)
    with SlowBroker() as broker, Bridge() as bridge:
        with open_sink(bridge, f"mqtt://127.0.0.1:{broker.port}") as sink:
            assert broker.connected.wait(LIMIT)
            handed: list[int] = []
            put = sink._publisher.put  # type: ignore[attr-defined]

            def counted(key: str, data: bytes, frames: int = 0) -> None:
                handed.append(frames)
                put(key, data, frames)

            monkeypatch.setattr(sink._publisher, "put", counted)  # type: ignore[attr-defined]
            sent = send_many(bridge)
            wait_until("it", lambda: sink.error == "the broker accepts data too slowly")
            time.sleep(0.5)
            assert sum(handed) < sent and sum(handed) - sink.published <= 1024
            assert sink.failed == 0
            broker.go_on.set()
            wait_until("all", lambda: sink.published + sink.dropped == sent)
            assert (sink.failed, sink.error) == (0, None)
        wait_until("the end", lambda: broker.came.endswith(bytes([0xE0, 0])))  # DISCONNECT
        assert broker.came.count(b"mavlink/7/1/HEARTBEAT") == sink.published


def test_a_slow_broker_keeps_nobody() -> None:
    pytest.importorskip(
        "paho.mqtt", reason="paho-mqtt is not installed: pip install 'mavwire[mqtt]'"
    )
    with SlowBroker() as broker, Bridge() as bridge:
        sink = open_sink(bridge, f"mqtt://127.0.0.1:{broker.port}")
        assert broker.connected.wait(LIMIT)
        send_many(bridge)
        time.sleep(0.5)
        begun = time.monotonic()
        sink.close()
        assert time.monotonic() - begun < 2
        wait_until("its threads", lambda: "mavwire-sink" not in thread_names())
        assert not any(name.startswith("paho") for name in thread_names())


def thread_names() -> list[str]:
    return [thread.name for thread in threading.enumerate()]


class Stuck:
    """An end that blocks, such as Zenoh, whose `put` waits for the other side."""

    dropped = 0

    def __init__(self) -> None:
        self.go_on, self.entered, self.closed = (threading.Event() for _ in range(3))

    def is_wanted(self) -> bool:
        return True

    def put(self, key: str, data: bytes, frames: int = 1) -> None:
        self.entered.set()
        self.go_on.wait(LIMIT)

    def flush(self, seconds: float) -> bool:
        return True

    def close(self) -> None:
        self.closed.set()


@pytest.mark.parametrize("ends", ["sink", "bridge"])
def test_ends_that_block_are_left_behind_together(ends: str) -> None:
    with Bridge() as bridge:
        stuck = [Stuck() for _ in range(1 if ends == "sink" else 4)]
        opened = [Sink(bridge, one, "mavlink", "stuck") for one in stuck]
        bridge.send(heartbeat())
        assert all(one.entered.wait(LIMIT) for one in stuck)
        begun = time.monotonic()
        (opened[0].close if ends == "sink" else bridge.stop)()
        assert time.monotonic() - begun < 2 and not any(one.closed.is_set() for one in stuck)
        assert bridge.sinks == []
        for one in stuck:
            one.go_on.set()
        assert all(one.closed.wait(LIMIT) for one in stuck)


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("kafka://x", "is no sink; say mqtt://"),
        ("mqtt:", "no address of an MQTT broker"),
        ("mqtt://host:99999/", "port or host is wrong; say mqtt://"),
        ("mqtt://host/a%23", r"have neither # nor \+"),
        ("ws://:1/a%00", "characters that nobody sees"),
        ("ws://:1/%ff", "port or host is wrong"),
        ("mqtt://host/a/#", r"have neither # nor \+"),
        ("mqtt://host/a/+/b", r"have neither # nor \+"),
        ("ws://127.0.0.1/", "needs a port"),
        ("ws://a@127.0.0.1:1", "needs a port"),
    ],
)
def test_wrong_addresses(text: str, wrong: str) -> None:
    with Bridge() as bridge, pytest.raises(ConfigError, match=wrong):
        open_sink(bridge, text)


@pytest.mark.parametrize(
    "text", ["XMPP://rover:hunter2@host", "mqtts://rover:hunter2/x@host", "mqtt://rover:hunter2@"]
)
def test_a_password_is_told_to_nobody(text: str) -> None:
    with Bridge() as bridge, pytest.raises(ConfigError) as raised:
        open_sink(bridge, text)
    assert "hunt" not in str(raised.value) and "mqtt://" in str(raised.value)


@pytest.mark.parametrize(
    ("text", "options", "wrong"),
    [
        ("ws://127.0.0.1:0", {"password": "s3cret"}, "only a broker of MQTT is told a password"),
        ("zenoh:", {"password": "s3cret"}, "only a broker of MQTT is told a password"),
        ("mqtt://host", {"password": "s3cret"}, "a password needs a user"),
        ("mqtt://a:b@host", {"password": "s3cret"}, "in the address and beside it"),
        ("mqtt://a@host", {"names": ["rover.example"]}, "only ws: answers to names"),
        ("zenoh:", {"names": ["rover.example"]}, "only ws: answers to names"),
    ],
)
def test_what_a_sink_has_no_use_for_is_an_error(
    text: str, options: dict[str, Any], wrong: str
) -> None:
    with Bridge() as bridge, pytest.raises(ConfigError, match=wrong) as raised:
        open_sink(bridge, text, **options)
    assert "s3cret" not in str(raised.value)


def test_a_sink_of_a_bridge_that_does_not_run() -> None:
    pytest.importorskip("aiohttp", reason="aiohttp is not installed: pip install 'mavwire[web]'")
    pytest.importorskip("wsproto", reason="wsproto is not installed: pip install 'mavwire[ws]'")
    with port_for_a_server() as port:
        with pytest.raises(BridgeError, match="not running"):
            open_sink(Bridge(), f"ws://127.0.0.1:{port}")
        with pytest.raises(OSError):
            socket.create_connection(("127.0.0.1", port), LIMIT)


def test_wrong_addresses_of_zenoh() -> None:
    pytest.importorskip("zenoh", reason="zenoh is not installed: pip install 'mavwire[zenoh]'")
    with Bridge() as bridge, pytest.raises(ConfigError, match="'x' is no endpoint of Zenoh"):
        open_sink(bridge, "zenoh:x")
