"""The programs of docs/bridge.md that publish what a bridge sees: as they stand there, beside stand-ins
of their clients, and beside a real NATS server and Kafka's own mock brokers where these are installed.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import LIMIT, wait_until
from unit.link_tools import heartbeat, pack

ROOT = Path(__file__).parents[3]
STAND_INS = Path(__file__).with_name("stand_ins")
PACKAGE_FOLDER = str(Path(mavutil.__file__).parents[1])
NATS_SERVER = shutil.which("nats-server", path=os.environ.get("PATH", "") + ":/usr/sbin")
ATTITUDE = pack(mavlink.MAVLink_attitude_message(1, 0.5, 0.25, -1.5, 0, 0, 0), 3, 7)


def free_port(kind: int) -> int:
    """A port that nobody has at this moment."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def program(name: str) -> str:
    """The program of the documentation that imports a module."""
    blocks = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs" / "bridge.md").read_text(), re.DOTALL
    )
    (found,) = [block for block in blocks if re.search(rf"\b(import|from)\b.*\b{name}\b", block)]
    return str(found)


@contextmanager
def running(
    name: str, stand_in: bool, replaced: dict[str, str] | None = None
) -> Iterator[subprocess.Popen[str]]:
    """The program of that name, and telemetry that it hears."""
    port = free_port(socket.SOCK_DGRAM)
    text = program(name)
    for old, new in {"0.0.0.0:14550": f"127.0.0.1:{port}", **(replaced or {})}.items():
        assert old in text
        text = text.replace(old, new)
    folders = [str(STAND_INS)] * stand_in + [PACKAGE_FOLDER]
    process = subprocess.Popen(
        [sys.executable, "-c", text],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(folders)},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    ended = threading.Event()

    def fly() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            while not ended.wait(0.05):
                for frame in (heartbeat(seq=2, sysid=7), ATTITUDE):
                    vehicle.sendto(frame, ("127.0.0.1", port))

    thread = threading.Thread(target=fly)
    thread.start()
    try:
        yield process
    finally:
        ended.set()
        thread.join()
        process.kill()
        process.communicate()


def lines(process: subprocess.Popen[str], count: int) -> list[Any]:
    """The first lines that a program prints, as JSON."""
    assert process.stdout is not None and process.stderr is not None
    killer = threading.Timer(LIMIT, process.kill)
    killer.start()
    try:
        got = [process.stdout.readline() for _ in range(count)]
    finally:
        killer.cancel()
    assert all(got), process.stderr.read()
    return [json.loads(line) for line in got]


def test_nats_with_a_stand_in() -> None:
    with running("nats", stand_in=True) as process:
        told = lines(process, 4)
    assert {tuple(one) for one in told} == {
        ("mavlink.7.1", heartbeat(seq=2, sysid=7).hex()),
        ("mavlink.7.1", ATTITUDE.hex()),
    }


def test_kafka_with_a_stand_in() -> None:
    with running("confluent_kafka", stand_in=True) as process:
        told = lines(process, 4)
    assert {(topic, key) for topic, key, _, _ in told} == {("mavlink", "7/1")}
    assert heartbeat(seq=2, sysid=7).hex() in {frame for _, _, frame, _ in told}
    assert all(stamp > 1e12 for _, _, _, stamp in told), "milliseconds"


def test_ros_with_a_stand_in() -> None:
    with running("rclpy", stand_in=True) as process:
        ((topic, told),) = lines(process, 1)
    assert (topic, told["header"]["frame_id"]) == ("attitude", "vehicle_7")
    assert told["vector"] == {"x": 0.5, "y": 0.25, "z": -1.5}
    assert told["header"]["stamp"]["sec"] > 1e9
    assert 0 <= told["header"]["stamp"]["nanosec"] < 1e9


@pytest.mark.skipif(NATS_SERVER is None, reason="no NATS server: apt-get install nats-server")
def test_nats() -> None:
    nats: Any = pytest.importorskip("nats", reason="nats-py is not installed: pip install nats-py")
    assert NATS_SERVER is not None
    port = free_port(socket.SOCK_STREAM)
    server = subprocess.Popen(
        [NATS_SERVER, "-a", "127.0.0.1", "-p", str(port)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        wait_until("the server", lambda: server.poll() is not None or answers(port))
        if server.poll() is not None:
            pytest.skip("the NATS server does not start here")

        async def listen() -> set[tuple[str, bytes]]:
            client = await nats.connect(f"nats://127.0.0.1:{port}")
            subscription = await client.subscribe("mavlink.>")
            await client.flush()
            came = set()
            while len(came) < 2:
                message = await subscription.next_msg(LIMIT)
                came.add((message.subject, message.data))
            await client.close()
            return came

        with running("nats", stand_in=False, replaced={"127.0.0.1:4222": f"127.0.0.1:{port}"}):
            came = asyncio.run(listen())
        assert came == {("mavlink.7.1", heartbeat(seq=2, sysid=7)), ("mavlink.7.1", ATTITUDE)}
    finally:
        server.kill()
        server.wait()


def answers(port: int) -> bool:
    """Somebody listens there."""
    try:
        socket.create_connection(("127.0.0.1", port), LIMIT).close()
    except OSError:
        return False
    return True


def test_kafka() -> None:
    """librdkafka brings brokers of its own for tests, which speak Kafka's protocol over TCP."""
    kafka: Any = pytest.importorskip(
        "confluent_kafka",
        reason="confluent-kafka is not installed: pip install confluent-kafka",
    )
    cluster = kafka.Producer({"test.mock.num.brokers": 1})
    (broker,) = cluster.list_topics("mavlink", timeout=LIMIT).brokers.values()
    servers = f"{broker.host}:{broker.port}"
    consumer = kafka.Consumer(
        {"bootstrap.servers": servers, "group.id": "test", "auto.offset.reset": "earliest"}
    )
    try:
        consumer.assign([kafka.TopicPartition("mavlink", n, 0) for n in partitions(cluster)])
        with running("confluent_kafka", False, {"127.0.0.1:9092": servers}):
            came: set[tuple[bytes, bytes]] = set()

            def both() -> bool:
                message = consumer.poll(0.1)
                if message is not None and message.error() is None:
                    came.add((message.key(), message.value()))
                    assert message.timestamp()[1] > 1e12
                return len(came) == 2

            wait_until("both", both)
        assert came == {(b"7/1", heartbeat(seq=2, sysid=7)), (b"7/1", ATTITUDE)}
    finally:
        consumer.close()


def partitions(cluster: Any) -> list[int]:
    """Those of the topic."""
    return list(cluster.list_topics("mavlink", timeout=LIMIT).topics["mavlink"].partitions)
