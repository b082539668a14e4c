"""The WebSocket sink: who connects gets frames and messages, and the newest batch if it is too slow for all."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: pip install 'mavwire[web]'")
pytest.importorskip("wsproto", reason="wsproto is not installed: pip install 'mavwire[ws]'")

from mavwire import Bridge, mavutil
from mavwire.bridge.metrics import prometheus
from mavwire.bridge.sinks import Sink, open_sink
from mavwire.bridge.web_sink import MAX_TEXT, MAX_WAITING, _Item, _Reader
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import LIMIT, wait_until
from unit.link_tools import heartbeat, pack
from unit.web_tools import WebSocketClient


@pytest.fixture
def bridge() -> Iterator[Bridge]:
    with Bridge() as running:
        yield running


@pytest.fixture
def sink(bridge: Bridge) -> Iterator[Sink]:
    with open_sink(bridge, "ws://127.0.0.1:0/field/one") as running:
        yield running


def port(sink: Sink) -> int:
    return int(sink._publisher.port)  # type: ignore[attr-defined]


def wait_for_readers(sink: Sink, count: int) -> None:
    wait_until("readers", lambda: sink._publisher.readers == count)  # type: ignore[attr-defined]


def attitude(seq: int, sysid: int = 7) -> bytes:
    message = mavlink.MAVLink_attitude_message(seq, seq / 4, 0, 0, 0, 0, 0)
    return bytes(pack(message, seq % 256, sysid))


def test_readers_get_what_their_path_names(bridge: Bridge, sink: Sink) -> None:
    assert sink.note == f"publishing to ws://127.0.0.1:{port(sink)}/field/one"
    link = mavutil.mavlink_connection(f"ws:127.0.0.1:{port(sink)}:field/one/out")
    paths = ("/", "/field/one/7", "/field/one/*/*/ATTITUDE")
    with (
        WebSocketClient(port(sink), paths[0]) as every,
        WebSocketClient(port(sink), paths[1]) as system,
        WebSocketClient(port(sink), paths[2]) as kind,
    ):
        wait_for_readers(sink, 4)
        frames = [heartbeat(seq=5, sysid=7), heartbeat(seq=6, sysid=8), attitude(9)]
        bridge.send(b"".join(frames))
        beat = link.recv_match(blocking=True, timeout=LIMIT)
        assert bytes(beat.get_msgbuf()) == frames[0]

        def collect(client: WebSocketClient, count: int) -> list[tuple[Any, ...]]:
            told: list[Any] = []
            client.until(lambda some: told.extend(some) or len(told) == count)
            return [(one["system"], one["type"], one["sequence"]) for one in told]

        beats, turn = [(7, "HEARTBEAT", 5), (8, "HEARTBEAT", 6)], (7, "ATTITUDE", 9)
        assert collect(every, 3) == [*beats, turn]
        assert collect(system, 2) == [beats[0], turn]
        assert collect(kind, 1) == [turn]
        bridge.send(attitude(10))
        (told,) = kind.until(list)
        assert told["fields"]["roll"] == 2.5 and told["time"] > 1e9
    link.close()
    wait_for_readers(sink, 0)
    wait_until("the count", lambda: sink.published == 4)
    assert (sink.failed, sink.dropped, sink.error) == (0, 0, None)


def test_nothing_is_made_for_nobody(bridge: Bridge) -> None:
    class Nobody:
        dropped = asked = 0

        def is_wanted(self) -> bool:
            self.asked += 1
            return False

        def close(self) -> None: ...

    nobody: Any = Nobody()  # without the method that takes what is made
    with Sink(bridge, nobody, "mavlink", "nobody") as sink:
        for _ in range(2):
            before = nobody.asked
            bridge.send(heartbeat())
            wait_until("the batch", lambda: nobody.asked > before)  # noqa: B023
        assert (sink.published, sink.failed) == (0, 0)


def test_the_bridge_tells_of_its_sinks(bridge: Bridge, sink: Sink) -> None:
    (told,) = bridge.stats()["sinks"]
    assert told == {
        "name": sink.name, "published": 0, "failed": 0, "dropped": 0, "error": None,
    }  # fmt: skip
    assert f'mavwire_bridge_sink_failed_total{{sink="{sink.name}"}} 0' in prometheus(bridge.stats())
    sink.close()
    assert bridge.stats()["sinks"] == []


def test_a_slow_reader_gets_what_is_newest(bridge: Bridge, sink: Sink) -> None:
    count = 10_000
    with WebSocketClient(port(sink), "/") as slow:
        wait_for_readers(sink, 1)
        for start in range(0, count, 100):
            bridge.send(b"".join(attitude(start + n) for n in range(100)))
        wait_until("all", lambda: sink.published == count)
        numbers: list[int] = []

        def take(told: list[Any]) -> bool:
            numbers.extend(one["fields"]["time_boot_ms"] for one in told)
            return numbers[-1] == count - 1

        slow.until(take)
        assert len(numbers) < count and numbers == sorted(numbers)
        assert sink.dropped == count - len(numbers)


def test_what_waits_is_bounded_and_the_newest() -> None:
    reader, raw = _Reader([]), _Reader(["out"])
    fill = "x" * (MAX_WAITING // 8)
    for n in range(20):
        texts = {name: json.dumps(f"{name}{n}{fill}").encode() for name in "AB"}
        batch = [_Item(("1", "1", name), text) for name, text in texts.items()]
        for one in (reader, raw):
            one.offer([_Item(("out",), b"frames %d" % n, 300), *batch])
    got = list(reader.messages())
    assert all(len(text) <= MAX_TEXT + 2 * len(fill) for text in got)
    told = [message for text in got for message in json.loads(text)]
    assert [message.strip("x") for message in told[-2:]] == ["A19", "B19"]
    assert len(told) + reader.dropped == 40 and sum(map(len, told)) <= MAX_WAITING
    assert list(raw.messages()) == [b"frames %d" % n for n in range(20)]
    # One that is longer than what may wait.
    for frames in (300, 20):
        raw.offer([_Item(("out",), bytes(MAX_WAITING + 1), frames)])
    assert [len(data) for data in raw.messages()] == [MAX_WAITING + 1]
    assert raw.dropped == 300, "frames, not batches"


@pytest.mark.parametrize(
    ("path", "headers", "status"),
    [
        ("/field", {}, 404),
        ("/field/two", {}, 404),
        ("/field/one/1/2/3/4", {}, 404),
        ("/field/one", {"Origin": "http://evil.example"}, 403),
        ("/field/one", {"Origin": "http://dashboard.example:3000"}, 101),
    ],
)
def test_who_may_read(bridge: Bridge, path: str, headers: dict[str, str], status: int) -> None:
    with (
        open_sink(bridge, "ws://127.0.0.1:0/field/one", names=["dashboard.example"]) as sink,
        WebSocketClient(port(sink), path, headers) as client,
    ):
        assert client.status == status


def test_readers_are_told_of_the_end(bridge: Bridge) -> None:
    with (
        open_sink(bridge, "ws://:0") as sink,
        WebSocketClient(port(sink), "/mavlink/out") as client,
    ):
        client.send("whatever it says")
        wait_for_readers(sink, 1)
        bridge.stop()
        assert client.closed() == 1001


def test_a_prefix_is_named_as_in_any_url(bridge: Bridge) -> None:
    with open_sink(bridge, "ws://127.0.0.1:0/my%20rover/%C3%A4") as sink:
        assert sink.name.endswith("/my%20rover/%C3%A4")
        path = sink.name.partition(f":{port(sink)}")[2]
        with WebSocketClient(port(sink), f"{path}/1") as client:
            assert client.status == 101
