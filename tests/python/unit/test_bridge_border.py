"""What frames go through at the border of a link, and what the bridge says of its own accord."""

from __future__ import annotations

import socket
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import pytest
from mavwire import Bridge
from mavwire.bridge import ConfigError, EndpointOptions, load_config
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import (
    LIMIT,
    TCP,
    UDP,
    command,
    peers,
    port_of,
    receive,
    report,
    udp_peer,
    wait_until,
)
from unit.link_tools import KEY, heartbeat, pack, signed

BEAT = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
EPOCH = 1_420_070_400


def now_signed(message: Any, later: int = 0) -> bytes:
    """Signed with the time of the clock, or some units later."""
    return signed(message, int((time.time() - EPOCH) * 100_000) + later)


def test_frames_leave_in_the_version_of_the_link() -> None:
    with Bridge() as bridge, udp_peer() as old, udp_peer() as new:
        bridge.add(f"udpout:127.0.0.1:{old.getsockname()[1]}", name="old", version=1)
        bridge.add(f"udpout:127.0.0.1:{new.getsockname()[1]}", name="new", version=2)
        status = mavlink.MAVLink_open_drone_id_arm_status_message(1, b"a")  # id 12918
        bridge.send(heartbeat(seq=3) + pack(status, 4) + heartbeat(seq=5, v1=True))
        assert [receive(old), receive(old)] == [heartbeat(seq=n, v1=True) for n in (3, 5)]
        assert [receive(new) for _ in range(3)] == [heartbeat(3), pack(status, 4), heartbeat(5)]
        wait_until("the count", lambda: report(bridge, "old")["unconverted"] == 1)


def test_signatures_are_verified_and_taken_off_on_the_way_in() -> None:
    with Bridge() as bridge, udp_peer() as station:
        bridge.add(
            UDP, name="radio", signing_key=KEY, verify_in=True, strip_in=True,
            allow_unsigned_in=["RADIO_STATUS"],
        )  # fmt: skip
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station")
        status = pack(mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7), 1, 51, 68)
        with udp_peer(bridge, "radio") as stranger, udp_peer(bridge, "radio") as vehicle:
            stranger.send(heartbeat(sysid=66))
            early = pack(mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7), 0, 51, 68)
            stranger.send(early)
            assert receive(station) == early
            wait_until("it", lambda: sum(one["unverified"] for one in peers(bridge, "radio")) == 1)
            bridge.send(heartbeat(seq=9, sysid=255))
            assert receive(station) == heartbeat(seq=9, sysid=255)
            frame = now_signed(BEAT)
            for one in (frame, frame, heartbeat(), status):
                vehicle.send(one)
            bare = receive(station)
            assert bare == heartbeat(seq=bare[4]), "without its signature"
            assert receive(station) == status
            own = wait_until("its entry", lambda: [
                one for one in peers(bridge, "radio") if one["unverified"] == 2
            ])  # fmt: skip
            assert own[0]["received"] == 2
            bridge.send(command(1))
            assert receive(vehicle) == command(1)
            (other,) = [one for one in peers(bridge, "radio") if one["unverified"] == 1]
            assert (other["sent"], other["received"]) == (0, 1), "who proves nothing gets nothing"


def test_signatures_far_ahead_of_the_clock_can_be_refused() -> None:
    """R52."""
    with Bridge() as bridge, udp_peer() as station, udp_peer() as vehicle:
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station")
        bridge.add(UDP, name="radio", signing_key=KEY, verify_in=True, strip_in=True, max_ahead_in=600)  # fmt: skip
        vehicle.connect(("127.0.0.1", port_of(bridge, "radio")))
        vehicle.send(now_signed(BEAT, later=1200 * 100_000))
        wait_until("it", lambda: sum(one["unverified"] for one in peers(bridge, "radio")) == 1)
        vehicle.send(now_signed(BEAT, later=60 * 100_000))
        assert receive(station)[:1] == b"\xfd"
        assert sum(one["unverified"] for one in peers(bridge, "radio")) == 1


@pytest.mark.parametrize("key", [{}, {"signing_key": KEY, "verify_in": True}])
def test_strangers_keep_nobody_out(key: dict[str, Any]) -> None:
    """Who has the key, or anything to say at all where none is needed."""
    with Bridge() as bridge:
        bridge.add(TCP, name="door", **key)
        where = ("127.0.0.1", port_of(bridge, "door"))
        with ExitStack() as stack:
            for _ in range(64):
                stack.enter_context(socket.create_connection(where, LIMIT))
            wait_until("them", lambda: len(peers(bridge, "door")) == 64)

            def served() -> bool:
                refused = report(bridge, "door")["refused"]
                with socket.create_connection(where, LIMIT) as member:
                    with suppress(OSError):
                        member.sendall(
                            now_signed(BEAT) if key else BEAT.pack(mavlink.MAVLink(None))
                        )
                    wait_until("its fate", lambda: bridge.latest("HEARTBEAT")
                               or report(bridge, "door")["refused"] > refused)  # fmt: skip
                return bridge.latest("HEARTBEAT") is not None

            wait_until("a place", served)
            assert len(peers(bridge, "door")) <= 64


def test_two_bridges_sign_what_goes_between_them(tmp_path: Path) -> None:
    key = tmp_path / "key"
    key.write_text(KEY.hex() + "\n")
    options: dict[str, Any] = {
        "signing_key_file": key, "verify_in": True, "sign_out": True, "strip_in": True,
    }  # fmt: skip
    with Bridge() as left, Bridge() as right, udp_peer() as station:
        left.add(TCP, name="between", **options)
        port = report(left, "between")["endpoint"].rpartition(":")[2]
        right.add(f"tcp:127.0.0.1:{port}", name="between", **options)
        right.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station", strip_out=True)
        wait_until("the connection", lambda: report(right, "between")["state"] == "up")
        wait_until("its other end", lambda: peers(left, "between"))
        right.send(heartbeat(seq=1, sysid=255))  # who speaks first proves itself
        assert wait_until("it", lambda: left.latest("HEARTBEAT", 255)).get_msgbuf()[2] == 0
        assert receive(station) == heartbeat(seq=1, sysid=255)
        left.send(heartbeat(seq=2))
        left.send(now_signed(BEAT))
        assert receive(station) == heartbeat(seq=2)
        assert receive(station)[2] == 0, "the vehicle's own signature is replaced, then off"
        assert sum(one["unverified"] for one in right.stats()["links"]) == 0


def test_links_that_only_read_and_links_that_are_silent() -> None:
    with Bridge() as bridge:
        bridge.add(UDP, name="viewers", read_only=True)
        bridge.add(UDP, name="vehicles")
        bridge.add(UDP, name="mute", silent=True)
        with (
            udp_peer(bridge, "viewers") as viewer,
            udp_peer(bridge, "vehicles") as vehicle,
            udp_peer(bridge, "mute") as mute,
        ):
            vehicle.send(heartbeat(sysid=1))
            wait_until("a vehicle", lambda: peers(bridge, "vehicles"))
            viewer.send(heartbeat(sysid=255))
            wait_until("a viewer", lambda: peers(bridge, "viewers"))
            mute.send(heartbeat(sysid=2))
            wait_until("another", lambda: peers(bridge, "mute"))
            viewer.send(command(1))
            wait_until("both", lambda: peers(bridge, "viewers")[0]["filtered_in"] == 2)
            wait_until("it", lambda: bridge.latest("HEARTBEAT", 2))
            assert receive(vehicle) == heartbeat(sysid=2)
            vehicle.send(heartbeat(seq=1))
            assert receive(viewer) == heartbeat(sysid=2)
            assert receive(viewer) == heartbeat(seq=1)
            wait_until("the count", lambda: peers(bridge, "mute")[0]["filtered_out"] >= 1)
            assert peers(bridge, "mute")[0]["sent"] == 0
            assert {one["system"] for one in bridge.stats()["components"]} == {1, 2}


def test_the_bridge_beats_and_asks_ardupilot_for_its_streams() -> None:
    with Bridge() as bridge, udp_peer() as vehicle:
        out = f"udpout:127.0.0.1:{vehicle.getsockname()[1]}"
        bridge.add(out, name="vehicle", heartbeat=0.05, request_streams=4, own_system=9)
        parse = mavlink.MAVLink(None).parse_char
        data, where = vehicle.recvfrom(300)
        beats = [parse(data), parse(receive(vehicle))]
        assert [beat.get_seq() for beat in beats] == [0, 1]
        assert (beats[0].get_srcSystem(), beats[0].get_srcComponent()) == (9, 240)
        assert beats[0].type == mavlink.MAV_TYPE_ONBOARD_CONTROLLER, "and no ground station"
        vehicle.sendto(heartbeat(sysid=3), where)
        requests: list[Any] = []
        while len(requests) < 7:
            message = parse(receive(vehicle))
            requests += [message] if message.get_type() == "REQUEST_DATA_STREAM" else []
        assert {(one.target_system, one.req_message_rate, one.start_stop) for one in requests} == {
            (3, 4, 1)
        }
        assert len({one.req_stream_id for one in requests}) == 7


def test_latency_and_drops_of_the_system_are_told() -> None:
    with Bridge() as bridge, udp_peer() as station:
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station")
        assert report(bridge, "station")["latency"] == {"p50": None, "p99": None, "p99.9": None}
        for seq in range(50):
            bridge.send(heartbeat(seq=seq))
            receive(station)
        wait_until("them", lambda: report(bridge, "station")["sent"] == 50)
        latency = report(bridge, "station")["latency"]
        assert 0 <= latency["p50"] <= latency["p99"] <= latency["p99.9"]
        assert report(bridge, "station")["overrun"] in (0, None)
        assert report(bridge, "program")["overrun"] is None


@pytest.mark.parametrize(
    ("options", "wrong"),
    [
        ({"version": 3}, "version must be a number from 1 to 2"),
        ({"verify_in": True}, "verify_in needs signing_key"),
        ({"signing_key": KEY}, "signing_key does nothing without verify_in or sign_out"),
        ({"allow_unsigned_in": ["RADIO_STATUS"]}, "does nothing without verify_in"),
        ({"max_ahead_in": 60}, "max_ahead_in does nothing without verify_in"),
        (
            {"max_ahead_in": -1, "verify_in": True, "signing_key": KEY},
            "max_ahead_in must be 0 seconds or more",
        ),
        ({"own_system": 9}, "own_system does nothing without heartbeat"),
        ({"sign_out": True}, "sign_out needs signing_key"),
        ({"sign_out": True, "signing_key": KEY, "version": 1}, "carry no signature"),
        ({"sign_out": True, "signing_key": KEY, "strip_out": True}, "exclude each other"),
        ({"signing_key": "abc"}, "32 bytes, or 64 hexadecimal digits"),
        ({"signing_key": b"abc"}, "32 bytes, or 64 hexadecimal digits"),
        ({"signing_key": KEY, "signing_key_file": "x"}, "not both"),
        ({"signing_key_file": "/no/such/file"}, "/no/such/file: No such file"),
        ({"signing_key_file": 7}, "signing_key_file must be a path"),
        ({"heartbeat": 0}, "heartbeat must be 0.01 seconds or more"),
        ({"request_streams": 0}, "request_streams must be a number from 1 to 1000"),
        ({"own_system": 0}, "own_system must be a number from 1"),
        ({"urgent": "HEARTBEAT"}, "urgent must be a list"),
        ({"urgent": ["NOPE"]}, "urgent: the dialect has no message"),
        ({"read_only": 1}, "read_only must be true or false"),
    ],
)
def test_wrong_options(options: dict[str, Any], wrong: str) -> None:
    with pytest.raises(ConfigError, match=wrong):
        Bridge().add(UDP, **options)


def test_a_file_says_it_too_and_no_key_is_shown(tmp_path: Path) -> None:
    file = tmp_path / "bridge.toml"
    file.write_text(
        f'[[link]]\nendpoint = "{UDP}"\nsigning_key = "{KEY.hex()}"\nsign_out = true\n'
        'urgent = ["COMMAND_LONG"]\nheartbeat = 1.0\n'
    )
    bridge = Bridge.from_options(load_config(file))
    (link,) = bridge._links
    assert isinstance(link, EndpointOptions) and (link.border.key, link.urgent) == (KEY, [76])
    assert link.automation.heartbeat == 1.0
    assert repr(KEY) not in repr(link) and KEY.hex() not in repr(link)


def test_heartbeats_are_urgent_where_bytes_are_few() -> None:
    def urgent(**options: Any) -> list[int]:
        bridge = Bridge()
        bridge.add(UDP, **options)
        return bridge._links[0].urgent

    assert (urgent(), urgent(bytes_per_second=300)) == ([], [0])
    assert urgent(bytes_per_second=300, urgent=[76]) == [76, 0]
    assert urgent(bytes_per_second=300, urgent=[0, 76]) == [0, 76]
