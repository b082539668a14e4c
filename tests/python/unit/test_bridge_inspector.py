"""The web inspector over real sockets: what it tells a page, and whom it tells nothing."""

from __future__ import annotations

import json
import math
import socket
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: pip install 'mavwire[web]'")
pytest.importorskip("wsproto", reason="wsproto is not installed: pip install 'mavwire[ws]'")

from mavwire import Bridge, open_log
from mavwire.bridge import Recording, web_server
from mavwire.bridge.inspector_server import MAX_UNSEEN, TABLES_INTERVAL, Inspector
from mavwire.bridge.inspector_tables import MAX_COMPONENTS, View, plain
from mavwire.bridge.web_server import MAX_REQUEST
from mavwire.dialects.v20 import all as mavlink
from mavwire.dialects.v20 import upstream
from mavwire.events import EventDefinitions
from unit.bridge_tools import LIMIT, UDP, udp_peer, wait_until
from unit.link_tools import heartbeat, pack
from unit.web_tools import PageClient, WebSocketClient

HOSTILE = "<img src=x onerror=alert(1)>"


@pytest.fixture
def bridge() -> Iterator[Bridge]:
    with Bridge([UDP]) as running:
        yield running


@pytest.fixture
def inspector(bridge: Bridge) -> Iterator[Inspector]:
    with Inspector(bridge, "127.0.0.1", 0) as running:
        yield running


def fetch(port: int, path: str, headers: dict[str, str] | None = None) -> Any:
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", headers=headers or {})
    with urllib.request.urlopen(request, timeout=LIMIT) as answer:
        return answer.headers, answer.read()


def refused(port: int, path: str, headers: dict[str, str] | None = None) -> int:
    with pytest.raises(urllib.error.HTTPError) as raised:
        fetch(port, path, headers)
    raised.value.close()
    return int(raised.value.code)


def test_a_page_is_told_what_comes_and_the_values_of_what_it_opens(
    bridge: Bridge, inspector: Inspector
) -> None:
    with udp_peer(bridge, UDP) as vehicle, PageClient(inspector.port, "/ws") as page:
        armed = mavlink.MAVLink_heartbeat_message(2, 3, 217, 0, 4, 3)
        vehicle.send(pack(armed, 0, 7))
        attitude = mavlink.MAVLink_attitude_message(1, 0.25, math.nan, 0, 0, 0, 0)
        vehicle.send(pack(attitude, 1, 7))
        tables = page.until(lambda told: told.get("kinds") and len(told["kinds"]) == 2 and told)
        (beat, angles) = tables["kinds"]
        assert (beat[:4], angles[:4], beat[5]) == ([7, 1, 0, 1], [7, 1, 30, 1], UDP)
        assert {link["name"] for link in tables["links"]} == {UDP, "program"}
        assert [one["system"] for one in tables["components"]] == [7]
        page.send({"open": [[7, 1, 0], [7, 1, 30], [9, 9, 9]]})
        values = page.until(lambda told: told.get("values"))
        assert set(values) == {"7/1/0", "7/1/30"}
        beat_values, angle_values = values["7/1/0"][1], values["7/1/30"][1]
        assert beat_values[0] == [2, "MAV_TYPE_QUADROTOR"]
        flags = (
            "CUSTOM_MODE_ENABLED GUIDED_ENABLED STABILIZE_ENABLED MANUAL_INPUT_ENABLED SAFETY_ARMED"
        )
        assert set(beat_values[2][1].split(" | ")) == {
            f"MAV_MODE_FLAG_{one}" for one in flags.split()
        }
        assert angle_values[:3] == [[1, ""], [0.25, ""], ["nan", ""]]
        vehicle.send(pack(mavlink.MAVLink_attitude_message(2, 0.5, 0, 0, 0, 0, 0), 2, 7))
        newer = page.until(
            lambda told: told.get("values", {}).get("7/1/30", [0, [[1]]])[1][0][0] == 2
        )
        assert newer


def test_a_page_that_does_not_keep_up_gets_the_newest_values(
    bridge: Bridge, inspector: Inspector
) -> None:
    def turn(roll: int) -> None:
        bridge.send(pack(mavlink.MAVLink_attitude_message(roll, roll, 0, 0, 0, 0, 0), roll % 256))
        wait_until("it", lambda: getattr(bridge.latest("ATTITUDE"), "roll", None) == roll)

    turn(0)
    with WebSocketClient(inspector.port, "/ws") as page:
        page.send({"open": [[1, 1, 30]]})
        seen: list[Any] = []
        page.until(lambda told: seen.append(told) or len(seen) == MAX_UNSEEN)
        for roll in range(1, 6):
            turn(roll)
            # Time for some updates, if it sent any.
            start = bridge.stats()["uptime"]
            wait_until("time", lambda: bridge.stats()["uptime"] > start + TABLES_INTERVAL / 2)  # noqa: B023
        page.send({"seen": MAX_UNSEEN})
        rolls = page.until(lambda told: "values" in told and told["values"]["1/1/30"][1][1])
        assert rolls == [5, ""], "and nothing that waited"


def test_made_up_addresses_do_not_flood_a_page(bridge: Bridge) -> None:

    count = MAX_COMPONENTS + 10
    bridge.send(b"".join(heartbeat(0, 1 + n // 200, 1 + n % 200) for n in range(count)))
    wait_until("all", lambda: len(bridge.stats()["components"]) == count)
    told = json.loads(View(bridge).tables())
    assert (len(told["components"]), told["hidden_components"]) == (MAX_COMPONENTS, 10)


def test_each_type_is_described_once(bridge: Bridge) -> None:

    bridge.send(heartbeat())
    bridge.send(pack(mavlink.MAVLink_attitude_message(1, 0, 0, 0, 0, 0, 0)))
    wait_until("both", lambda: len(bridge.kinds()) == 2)
    view = View(bridge)
    first, second = json.loads(view.tables()), json.loads(view.tables())
    assert set(first["types"]) == {"0", "30"} and second["types"] == {}
    assert first["types"]["30"]["name"] == "ATTITUDE"
    assert first["types"]["30"]["fields"][1][:3] == ["roll", "float", "rad"]


def test_kinds_of_messages_are_counted(bridge: Bridge) -> None:
    for seq in range(3):
        bridge.send(heartbeat(seq=seq, sysid=4))
    (kind,) = wait_until("them", lambda: [one for one in bridge.kinds() if one.frames == 3])
    assert (kind.id, kind.name, kind.system, kind.component, kind.link) == (
        0, "HEARTBEAT", 4, 1, "program",
    )  # fmt: skip


def test_values_are_what_javascript_can_hold() -> None:
    assert plain([1, 2.5, math.inf, 2**60, b"a\xff", HOSTILE]) == [
        1, 2.5, "inf", str(2**60), "a\ufffd", HOSTILE,
    ]  # fmt: skip


def test_the_page_is_whole_and_bound_to_itself(inspector: Inspector) -> None:
    headers, body = fetch(inspector.port, "/")
    text = body.decode()
    assert "NONCE" not in text and "http://" not in text and "https://" not in text
    policy = headers["Content-Security-Policy"]
    nonce = policy.partition("script-src 'nonce-")[2].partition("'")[0]
    assert len(nonce) > 15 and text.count(nonce) == 2 and "default-src 'none'" in policy
    assert nonce not in fetch(inspector.port, "/")[1].decode(), "another one each time"
    assert ".innerHTML" not in text and "insertAdjacentHTML" not in text


@pytest.mark.parametrize(
    ("headers", "path", "status"),
    [
        ({"Host": "evil.example"}, "/", 403),
        ({"Origin": "http://evil.example"}, "/ws", 403),
        ({"Origin": "null"}, "/ws", 403),
        ({}, "/ws", 400),
        ({}, "/recording", 404),
        ({}, "/../../etc/passwd", 404),
    ],
)
def test_others_are_refused(
    inspector: Inspector, headers: dict[str, str], path: str, status: int
) -> None:
    assert refused(inspector.port, path, headers) == status


def test_an_origin_of_its_own_is_welcome(inspector: Inspector) -> None:
    origin = {"Origin": f"http://127.0.0.1:{inspector.port}"}
    with PageClient(inspector.port, "/ws", origin) as page:
        assert page.status == 101
    # A proxy in front that speaks TLS and hands Host on.
    origin = {"Origin": f"https://127.0.0.1:{inspector.port}"}
    with PageClient(inspector.port, "/ws", origin) as page:
        assert page.status == 101
    with PageClient(inspector.port, "/ws", {"Origin": "http://127.0.0.1:1"}) as page:
        assert page.status == 403


@pytest.mark.parametrize("origin", ["", "http://[", "ftp://rover.example", "http://evil.example"])
def test_a_proxy_in_front_has_names_of_its_own(bridge: Bridge, origin: str) -> None:
    with Inspector(bridge, "127.0.0.1", 0, names=["Rover.example"]) as inspector:
        asked = {"Host": "rover.example"}
        assert b"mavwire bridge" in fetch(inspector.port, "/", asked)[1]
        assert fetch(inspector.port, "/", {**asked, "Origin": "https://rover.example:8443"})
        with PageClient(inspector.port, "/ws", {"Origin": "http://rover.example"}) as page:
            assert page.status == 101
        assert refused(inspector.port, "/", {"Host": "evil.example"}) == 403
        assert refused(inspector.port, "/", {**asked, "Origin": origin}) == 403


def test_other_addresses_than_loopback_need_the_token(bridge: Bridge) -> None:
    with Inspector(bridge, "0.0.0.0", 0) as inspector:
        query = f"?token={inspector.token}"
        assert len(inspector.token) > 15 and inspector.url.endswith(query)
        for path in ("/", "/ws", "/recording", "/?token=", "/?token=%C3%A4", f"/{query}x"):
            assert refused(inspector.port, path) == 403
        assert b"mavwire bridge" in fetch(inspector.port, f"/{query}", {"Host": "rover.local"})[1]
        with PageClient(inspector.port, f"/ws{query}") as page:
            assert page.status == 101


def test_the_recording_can_be_downloaded(tmp_path: Path) -> None:
    with (
        Bridge(record=Recording(tmp_path, flush_interval=0.001)) as bridge,
        Inspector(bridge, "127.0.0.1", 0) as inspector,
    ):
        bridge.send(heartbeat(seq=9))
        wait_until("the record", lambda: bridge.stats()["recording"]["records"])
        headers, log = fetch(inspector.port, "/recording")
        for file in tmp_path.iterdir():
            file.rename(tmp_path / "moved")
        assert refused(inspector.port, "/recording") == 404
    assert ".tlog" in headers["Content-Disposition"]
    (tmp_path / "copy").write_bytes(log)
    assert [msg.get_seq() for msg in open_log(tmp_path / "copy")] == [9]


def test_a_request_that_never_ends_is_given_up(
    monkeypatch: pytest.MonkeyPatch, inspector: Inspector
) -> None:
    monkeypatch.setattr(web_server, "REQUEST_TIME", 0.5)
    with socket.create_connection(("127.0.0.1", inspector.port), LIMIT) as drip:
        drip.settimeout(0.05)

        def given_up() -> bool:
            try:
                drip.sendall(b"G")  # each comes in time
                return not drip.recv(1)
            except TimeoutError:
                return False
            except OSError:
                return True

        wait_until("the end", given_up)


def test_no_name_server_is_asked(monkeypatch: pytest.MonkeyPatch, bridge: Bridge) -> None:
    """In the field there may be none, and asking would take its time."""
    monkeypatch.setattr(socket, "getfqdn", lambda *_: pytest.fail("asked"))
    with Inspector(bridge, "0.0.0.0", 0) as inspector:
        assert inspector.port


@pytest.mark.parametrize(
    "said",
    [
        "nonsense", "[]", "{}", '{"open": 7}', '{"open": [[1, 2]]}', '{"open": [[1, 2, -1]]}',
        '{"open": [[1, 2, true]]}', '{"seen": -1}', '{"seen": "a"}',
        '{"open": [["a", {}, []]]}', "[" * 5000,
    ],
)  # fmt: skip
def test_nonsense_ends_the_conversation_and_nothing_else(inspector: Inspector, said: str) -> None:
    with PageClient(inspector.port, "/ws") as page:
        page.send(said)
        assert page.closed() == 1007
    assert fetch(inspector.port, "/")[1]


def test_a_request_that_is_too_long_ends_the_conversation(inspector: Inspector) -> None:
    with PageClient(inspector.port, "/ws") as page:
        page.send("x" * (MAX_REQUEST + 1))
        assert page.closed() == 1009


def test_it_ends_with_the_bridge_and_when_it_is_closed(bridge: Bridge) -> None:
    inspector = Inspector(bridge, "127.0.0.1", 0)
    with PageClient(inspector.port, "/ws") as page:
        page.until(lambda told: "kinds" in told)
        bridge.stop()
        assert page.closed() == 1001
        assert refused(inspector.port, "/recording") == 503
    inspector.close()
    with Bridge() as other:
        inspector = Inspector(other, "127.0.0.1", 0)
        with PageClient(inspector.port, "/ws") as page:
            page.until(lambda told: "kinds" in told)
            inspector.close()
            assert page.closed() == 1001
    with pytest.raises(OSError):
        socket.create_connection(("127.0.0.1", inspector.port), 1)


def test_an_event_is_shown_in_words(bridge: Bridge) -> None:
    event = {
        "name": "denied",
        "message": "Arming denied: {1}",
        "arguments": [{"name": "a", "type": "uint8_t"}],
    }
    component = {"namespace": "px4", "event_groups": {"default": {"events": {"7": event}}}}
    definitions = json.dumps({"components": {"1": component}}).encode()
    arguments = [3, *[0] * 39]
    bridge.send(pack(upstream.MAVLink_event_message(0, 0, 1 << 24 | 7, 0, 0, 0x64, arguments)))
    wait_until("it", lambda: bridge.latest(410))
    view = View(bridge)
    view.hear('{"open": [[1, 1, 410]]}')
    number = [1 << 24 | 7, ""]
    for given, shown in (
        (None, number),
        (EventDefinitions(definitions), [number[0], "warning: Arming denied: 3"]),
    ):
        bridge.event_definitions = given
        (values,) = json.loads(view.values() or "")["values"].values()
        assert shown in values[1]
