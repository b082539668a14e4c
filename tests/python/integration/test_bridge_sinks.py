"""Sinks beside real ones: Mosquitto, and a Zenoh peer in a process of its own."""

from __future__ import annotations

import json
import queue
import shutil
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from mavwire import Bridge
from mavwire.bridge import ConfigError
from mavwire.bridge.sinks import open_sink
from unit.bridge_tools import LIMIT, wait_until
from unit.link_tools import heartbeat

BROKER = shutil.which("mosquitto", path="/usr/sbin:/usr/local/sbin:/usr/bin:/usr/local/bin")


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


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
    port = free_port()
    (tmp_path / "conf").write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
    with Bridge() as bridge, open_sink(bridge, f"mqtt://127.0.0.1:{port}/field/one") as sink:
        bridge.send(heartbeat())
        wait_until("the error", lambda: sink.error == "the broker does not answer")
        broker = subprocess.Popen([BROKER, "-c", str(tmp_path / "conf")], stderr=subprocess.DEVNULL)
        try:
            came: queue.Queue[tuple[str, bytes]] = queue.Queue()
            client = Client(CallbackAPIVersion.VERSION2)
            client.on_message = lambda *message: came.put((message[2].topic, message[2].payload))
            subscribed: queue.Queue[bool] = queue.Queue()
            client.on_subscribe = lambda *_: subscribed.put(True)
            client.on_connect = lambda *_: client.subscribe("field/#")
            client.reconnect_delay_set(1, 1)
            client.connect_async("127.0.0.1", port)
            client.loop_start()
            assert subscribed.get(timeout=LIMIT)

            def connected() -> bool:
                bridge.send(heartbeat(sysid=7, seq=5))
                return sink.published > 0

            wait_until("the broker", connected)
            (raw_topic, raw), (topic, text) = came.get(timeout=LIMIT), came.get(timeout=LIMIT)
            assert (raw_topic, topic) == ("field/one/out", "field/one/7/1/HEARTBEAT")
            check(raw[:21], text)
            client.disconnect()
            client.loop_stop()
        finally:
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
    port = free_port()
    peer = subprocess.Popen(
        [sys.executable, "-c", SUBSCRIBER, str(port)], stdout=subprocess.PIPE, text=True
    )
    try:
        assert peer.stdout is not None and peer.stdout.readline() == "ready\n"
        came: dict[str, bytes] = {}
        with Bridge() as bridge, open_sink(bridge, f"zenoh:tcp/127.0.0.1:{port}"):
            lines: queue.Queue[Any] = queue.Queue()
            import threading

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


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("kafka://x", "is no sink; say mqtt://"),
        ("mqtt:", "no address of an MQTT broker"),
        ("mqtt://host:99999/", "wrong: Port out of range"),
        ("mqtt://host/a/#", "no address of an MQTT broker"),
    ],
)
def test_wrong_addresses(text: str, wrong: str) -> None:
    with Bridge() as bridge, pytest.raises(ConfigError, match=wrong):
        open_sink(bridge, text)
