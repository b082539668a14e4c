"""Bridges between simulated vehicles and ground stations, in rings, in floods, and on the command line."""

from __future__ import annotations

import json
import os
import signal
import socket
import sys
import threading
import urllib.request
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import pytest
from integration.processes import announced_ports, mavwire
from mavwire import Bridge, mavutil, open_log
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Vehicle, serve
from unit.bridge_tools import (
    LIMIT,
    TCP,
    UDP,
    command,
    peers,
    port_of,
    read_exactly,
    receive,
    report,
    udp_peer,
    wait_until,
)
from unit.link_tools import heartbeat, pack

pytestmark = pytest.mark.usefixtures("mavlink20")


def message(link: Any, name: str, condition: str | None = None) -> Any:
    found = link.recv_match(condition, name, blocking=True, timeout=LIMIT)
    assert found is not None, f"no {name}"
    return found


def test_two_stations_and_two_vehicles() -> None:
    with Bridge() as bridge:
        bridge.add(UDP, name="vehicles")
        bridge.add(TCP, name="stations")
        vehicles = f"udpout:127.0.0.1:{port_of(bridge, 'vehicles')}"
        device = f"tcp:127.0.0.1:{port_of(bridge, 'stations')}"
        first, second = (
            mavutil.mavlink_connection(device, source_system=system) for system in (254, 255)
        )
        try:
            with serve(vehicles, Vehicle(), Vehicle("px4", sysid=2), speed=5):
                for station in (first, second):
                    for system in (1, 2):
                        message(station, "HEARTBEAT", f"HEARTBEAT.get_srcSystem()=={system}")
                first.mav.param_request_read_send(1, 1, b"BATT_CAPACITY", -1)
                assert message(first, "PARAM_VALUE").get_srcSystem() == 1
                second.mav.command_long_send(
                    2, 1, mavlink.MAV_CMD_REQUEST_MESSAGE, 0, 148, *[0] * 6
                )
                assert message(second, "AUTOPILOT_VERSION").get_srcSystem() == 2
                heard = {(one["system"], one["component"]) for one in bridge.stats()["components"]}
                assert {(1, 1), (2, 1), (254, 0), (255, 0)} <= heard
                assert bridge.latest("HEARTBEAT", 2).autopilot == mavlink.MAV_AUTOPILOT_PX4
        finally:
            first.close()
            second.close()


def test_two_bridges_in_a_ring() -> None:
    """Two ways from one bridge to the other: each frame arrives once, and none goes round."""
    with Bridge(dedup=LIMIT) as left, Bridge(dedup=LIMIT) as right, udp_peer() as station:
        left.add(UDP, name="vehicle")
        for name, kind in (("one", TCP), ("two", TCP)):
            right.add(kind, name=name)
            left.add(f"tcp:127.0.0.1:{port_of(right, name)}", name=name)
            wait_until("one end", lambda: peers(right, name))  # noqa: B023
            wait_until("the other", lambda: report(left, name)["state"] == "up")  # noqa: B023
        right.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station")
        frames = [heartbeat(seq=n % 256, sysid=1 + n // 256) for n in range(600)]
        with udp_peer(left, "vehicle") as vehicle:
            for frame in frames:
                vehicle.send(frame)
                assert receive(station) == frame, "each once, in order"
            total = sum(peer["received"] for name in ("one", "two") for peer in peers(right, name))
            assert total <= 2 * len(frames)
            copies = sum(one["duplicates"] for one in right.stats()["links"])
            assert copies <= len(frames)
            # Back to the vehicle over the ring.
            right.send(command(1))
            assert receive(vehicle) == command(1)
            right.send(heartbeat(sysid=255))
            assert receive(vehicle) == heartbeat(sysid=255)


def test_a_thousand_components() -> None:
    """1,000 senders, each known and reachable."""
    addresses = [(1 + n // 5, 1 + n % 5) for n in range(1000)]
    with Bridge([TCP, UDP]) as bridge, udp_peer(bridge, UDP) as station:
        where = ("127.0.0.1", port_of(bridge, TCP))
        with socket.create_connection(where, LIMIT) as vehicles:
            vehicles.sendall(b"".join(heartbeat(0, *address) for address in addresses))
            wait_until("all", lambda: len(bridge.stats()["components"]) == 1000)
            commands = [
                command(system, n % 256, part) for n, (system, part) in enumerate(addresses)
            ]
            for start in range(0, 1000, 50):
                for frame in commands[start : start + 50]:
                    station.send(frame)
                expected = b"".join(commands[start : start + 50])
                assert read_exactly(vehicles, len(expected)) == expected


def test_a_flood_from_hostile_peers() -> None:
    """Junk, damaged frames and made-up addresses on one link; the others go on."""
    junk = os.urandom(20_000) + b"\xfe\xff" * 5_000
    damaged = bytearray(heartbeat(sysid=66))
    damaged[-1] ^= 0xFF
    addresses = b"".join(heartbeat(0, 1 + n % 255, 1 + n // 255) for n in range(20_000))
    stop = threading.Event()

    def flood(port: int) -> None:
        address = ("127.0.0.1", port)
        # Removing the link resets the connection.
        with socket.create_connection(address, LIMIT) as hostile, suppress(OSError):
            while not stop.is_set():
                hostile.sendall(junk + bytes(damaged) * 100 + addresses)

    with Bridge() as bridge, udp_peer() as station:
        bridge.add(TCP, name="hostile")
        bridge.add(UDP, name="vehicle")
        bridge.add(
            f"udpout:127.0.0.1:{station.getsockname()[1]}",
            name="station",
            allow_messages_out=["ATTITUDE"],
        )
        thread = threading.Thread(target=flood, args=(port_of(bridge, "hostile"),))
        thread.start()
        try:
            wait_until("the flood", lambda: peers(bridge, "hostile"))
            with udp_peer(bridge, "vehicle") as vehicle:
                for n in range(30):
                    attitude = mavlink.MAVLink_attitude_message(n, 0, 0, 0, 0, 0, 0)
                    vehicle.send(pack(attitude, n, 3))
                    assert receive(station) == pack(attitude, n, 3)
            wait_until("the flood", lambda: report(bridge, "station")["filtered_out"] > 10_000)
        finally:
            stop.set()
            bridge.remove("hostile")  # which ends a thread that waits to send
            thread.join(LIMIT)
        wait_until("the count", lambda: report(bridge, "station")["sent"] == 30)
        assert report(bridge, "station")["dropped"] == 0, "the others went on"


def test_peers_that_come_in_numbers_are_turned_away_not_served_badly() -> None:
    with Bridge([TCP]) as bridge, ExitStack() as stack:
        where = ("127.0.0.1", port_of(bridge, TCP))

        def connect() -> socket.socket:
            return stack.enter_context(socket.create_connection(where, LIMIT))

        good = [connect() for _ in range(64)]
        for one in good:
            one.sendall(heartbeat())
        wait_until("them", lambda: [one["received"] for one in peers(bridge, TCP)] == [1] * 64)
        places = [one["peer"] for one in peers(bridge, TCP)]
        # Who said nothing for longer than this would have to go.
        heard = bridge.stats()["uptime"]
        wait_until("time", lambda: bridge.stats()["uptime"] > heard + 1.1)
        for _ in range(6):
            connect()
        wait_until("them", lambda: bridge.stats()["links"][0]["refused"] == 6)
        assert [one["peer"] for one in peers(bridge, TCP)] == places
        stack.close()
        wait_until("their end", lambda: not peers(bridge, TCP))
        with socket.create_connection(where, LIMIT):
            wait_until("a new one", lambda: peers(bridge, TCP))


def test_links_that_come_and_go_lose_nothing_on_the_others() -> None:
    with Bridge([TCP]) as bridge, udp_peer() as station:
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station")
        where = ("127.0.0.1", port_of(bridge, TCP))
        frames = [heartbeat(seq=n % 256, sysid=1 + n % 200) for n in range(2000)]
        with socket.create_connection(where, LIMIT) as vehicle:
            for n, frame in enumerate(frames):
                vehicle.sendall(frame)
                if n % 20 == 0:
                    bridge.add(UDP, name="guest")
                elif n % 20 == 10:
                    bridge.remove("guest")
                assert receive(station) == frame


# -- the command line


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_the_command_routes_records_and_tells(tmp_path: Path, end: signal.Signals) -> None:
    options = ["--master", UDP, "--out", TCP, "--record", str(tmp_path), "--json", "1h"]
    with mavwire("bridge", *options) as (process, lines):
        udp, tcp = announced_ports(lines)
        with socket.create_connection(("127.0.0.1", tcp), LIMIT) as station, udp_peer() as vehicle:
            vehicle.connect(("127.0.0.1", udp))
            station.sendall(heartbeat(sysid=255))
            for seq in range(10_000):
                # Whether the connection was accepted before the first of them, nobody knows.
                vehicle.send(heartbeat(seq=seq % 256))
                station.settimeout(0.01)
                try:
                    first = station.recv(1)
                    break
                except TimeoutError:
                    pass
            station.settimeout(LIMIT)
            assert len(first + read_exactly(station, 20)) == 21
        process.send_signal(end)
        assert process.stdout is not None
        out = process.stdout.read()
        assert process.wait(LIMIT) == 0
    stats = json.loads(out)
    assert {one["system"] for one in stats["components"]} >= {1}
    (log,) = tmp_path.iterdir()
    assert {msg.get_srcSystem() for msg in open_log(log)} >= {1}


def test_the_command_serves_the_page_where_it_says() -> None:
    with mavwire("bridge", UDP, "--http", ":0", "--metrics", ":0") as (process, lines):
        line = lines.get(timeout=LIMIT)
        assert "; metrics on port " in line
        url = line.partition("inspector at ")[2].partition(";")[0]
        with urllib.request.urlopen(url, timeout=LIMIT) as answer:
            assert b"mavwire bridge" in answer.read()
        process.send_signal(signal.SIGTERM)
        assert process.wait(LIMIT) == 0


def test_a_file_says_what_runs_beside_the_bridge(tmp_path: Path) -> None:
    pytest.importorskip("aiohttp", reason="aiohttp is not installed: pip install 'mavwire[web]'")
    config = tmp_path / "bridge.toml"
    config.write_text(f"""
json = 3600
[http]
listen = ":0"
names = ["rover.example"]
[[sink]]
address = "ws://:0/field"
[[link]]
endpoint = "{UDP}"
""")
    options = ["--config", str(config), "--http", "127.0.0.1:0"]
    with mavwire("bridge", *options) as (process, lines):
        line = lines.get(timeout=LIMIT)
        url = line.partition("inspector at ")[2].partition(";")[0]
        request = urllib.request.Request(url, headers={"Host": "rover.example"})
        with urllib.request.urlopen(request, timeout=LIMIT) as answer:
            assert b"mavwire bridge" in answer.read()
        assert "; publishing to ws://127.0.0.1:" in line
        process.send_signal(signal.SIGTERM)
        assert process.stdout is not None
        assert json.loads(process.stdout.read())["sinks"][0]["name"].endswith("/field")


@pytest.mark.parametrize(
    ("arguments", "code", "wrong"),
    [
        ([], 2, "nothing to route"),
        (["udpin"], 2, "'udpin' is no endpoint"),
        (["serial:/dev/no-such-device:57600"], 1, "no-such-device:57600: No such file"),
        (["--config", "/no/such/file"], 1, "/no/such/file: No such file"),
        ([UDP, UDP], 2, "another link is called"),
        ([UDP, "--json", "0"], 2, "--json must be 0.001 seconds or more"),
        ([UDP, "--record", "x", "--record-time", "0"], 2, "--record: max_age must be 1 seconds"),
        (
            [UDP, "--record", "x", "--record-flush", "0"],
            2,
            "--record: flush_interval must be 0.001",
        ),
        ([UDP, "--dedup", "soon"], 2, "not a time"),
        ([UDP, "--metrics", "here"], 2, "not [HOST]:PORT"),
        ([UDP, "--max-age", "0"], 2, "max_age must be 0.001 seconds or more"),
        ([UDP, "--sniffer-sysid", "256"], 2, "sniffer_sysid must be a number from 0 to 255"),
        ([UDP, "--http", "here"], 2, "not [HOST]:PORT"),
        ([UDP, "--sink", "kafka://x"], 2, "'kafka://x' is no sink; say mqtt://"),
        ([UDP, "--record-size", "1M"], 2, "--record-flush need --record"),
        ([UDP, "--record-flush", "1s"], 2, "--record-flush need --record"),
    ],
)
def test_start_up_errors_are_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, wrong: str
) -> None:
    from mavwire import cli

    try:
        assert cli.main(["bridge", *arguments]) == code
    except SystemExit as ended:  # argparse's own
        assert ended.code == code
    told = capsys.readouterr().err
    assert wrong in told and "Traceback" not in told


@pytest.mark.parametrize(
    "options", [["--metrics", ":0"], ["--http", ":0"], ["--sink", "ws://127.0.0.1:0"]]
)
def test_without_aiohttp_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], options: list[str]
) -> None:
    from mavwire import cli

    for name in ("metrics", "inspector_server", "web_sink", "web_server"):
        monkeypatch.delitem(sys.modules, f"mavwire.bridge.{name}", raising=False)
    monkeypatch.setitem(sys.modules, "aiohttp", None)
    assert cli.main(["bridge", UDP, *options]) == 1
    error = capsys.readouterr().err
    assert options[0] in error and "pip install 'mavwire[web]'" in error


def test_a_port_that_is_taken_and_a_wrong_line_are_named(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    from mavwire import cli

    with socket.create_server(("127.0.0.1", 0)) as taken:
        endpoint = f"tcpin:127.0.0.1:{taken.getsockname()[1]}"
        assert cli.main(["bridge", endpoint]) == 1
        assert f"{endpoint}: Address already in use" in capsys.readouterr().err
        for option in ("--metrics", "--http"):
            assert cli.main(["bridge", UDP, option, endpoint.removeprefix("tcpin:")]) == 1
            assert f"{option} 127.0.0.1:" in capsys.readouterr().err
        sink = f"{endpoint.replace('tcpin:', 'ws://')}/x"
        assert cli.main(["bridge", UDP, "--sink", sink]) == 1
        assert f"--sink: {sink}: Address already in use" in capsys.readouterr().err
        toml = tmp_path / "bridge.toml"
        where = endpoint.removeprefix("tcpin:")
        toml.write_text(f"[[link]]\nendpoint = '{UDP}'\n[metrics]\nlisten = '{where}'\n")
        assert cli.main(["bridge", "--config", str(toml)]) == 1
        assert "bridge.toml: metrics: Address already in use" in capsys.readouterr().err
    config = tmp_path / "main.conf"
    config.write_text("[General]\nTcpServerPort = 0\n[UdpEndpoint a]\nMod = Normal\n")
    assert cli.main(["bridge", "--config", str(config)]) == 2
    assert "main.conf:4: unknown option 'Mod'; did you mean 'Mode'?" in capsys.readouterr().err


def test_a_log_is_replayed_to_whoever_connects(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    frames = [heartbeat(seq=n, sysid=1 + n % 3) for n in range(200)] + [command(77)]
    stamps = range(1_600_000_000_000_000, 1_600_000_000_000_000 + 201 * 100_000, 100_000)
    log.write_bytes(b"".join(t.to_bytes(8, "big") + f for t, f in zip(stamps, frames, strict=True)))
    with udp_peer() as station:
        out = f"udpout:127.0.0.1:{station.getsockname()[1]}"
        with mavwire("replay", str(log), "--speed", "1000", "--out", out) as (process, lines):
            assert [receive(station) for _ in frames] == frames
            assert process.wait(LIMIT) == 0
            assert lines.get(timeout=LIMIT) == "201 frames"


def test_a_station_that_listens_gets_its_own_recorded_frames_too(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    frames = [heartbeat(seq=0), heartbeat(seq=1, sysid=255), command(1), heartbeat(seq=2)]
    log.write_bytes(b"".join(bytes(8) + frame for frame in frames))
    with (
        udp_peer() as station,
        mavwire("replay", str(log), "--out", UDP) as (process, lines),
    ):
        line = lines.get(timeout=LIMIT)
        assert line.startswith("waiting for udpin:")
        station.connect(("127.0.0.1", int(line.rpartition(":")[2])))
        station.send(heartbeat(sysid=255) + command(1))
        assert [receive(station) for _ in frames] == frames
        assert process.wait(LIMIT) == 0
        assert lines.get(timeout=LIMIT) == "4 frames"


def test_replay_names_what_it_cannot_reach(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from mavwire import cli

    log = tmp_path / "flight.tlog"
    log.write_bytes(bytes(8) + heartbeat())
    wrong = "serial:/dev/null:57600"
    assert cli.main(["replay", str(log), "--out", wrong]) == 1
    assert f"error: {wrong}: this is no serial port" in capsys.readouterr().err
    assert cli.main(["replay", str(tmp_path / "none.tlog")]) == 1
    assert "none.tlog: No such file" in capsys.readouterr().err


def test_replay_keeps_the_pace_of_the_log() -> None:
    from mavwire.cli.bridge.replay import replay

    now, sent = 0.0, []

    def sleep(seconds: float) -> None:
        nonlocal now
        now += seconds

    stamps = [100.0, 100.001, 100.002, 101.0, 99.0, 99.5, 500.0, 500.25]
    frames = [(stamp, bytes([n])) for n, stamp in enumerate(stamps)]
    count = replay(frames, lambda data: sent.append((round(now, 3), data)), 2.0, lambda: now, sleep)
    assert count == len(frames)
    assert sent == [
        (0.0, b"\0\1\2"),
        (0.5, b"\3\4"),
        (0.75, b"\5\6"),
        (0.875, b"\7"),
    ]
