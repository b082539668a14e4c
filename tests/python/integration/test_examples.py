"""Every example, run as a user runs it, against simulated vehicles."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mavwire import Bridge, mavutil, traffic
from mavwire.dialects.v20 import ardupilotmega as mavlink
from mavwire.sim import Impairment, Vehicle, serve
from unit.bridge_tools import wait_until
from unit.link_tools import KEY, free_port
from unit.sim_tools import PATIENT
from unit.terminal_tools import read_terminal

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "examples"
STATION = Path(__file__).with_name("drone_station.py")
TIMEOUT = 120


class Recorder(Vehicle):
    """A vehicle that remembers what it was sent."""

    heard: list[Any]

    def handle(self, msg: Any) -> None:
        self.__dict__.setdefault("heard", []).append(msg)
        super().handle(msg)


class Forgetful(Vehicle):
    """A vehicle on a link that loses the first message of each of these kinds."""

    losing: set[str]

    def handle(self, msg: Any) -> None:
        if not self._is_lost(msg, "to"):
            super().handle(msg)

    def send(self, msg: Any) -> None:
        if not self._is_lost(msg, "from"):
            super().send(msg)

    def _is_lost(self, msg: Any, way: str) -> bool:
        kind = f"{way} {msg.get_type()}"
        losing = self.__dict__.setdefault("losing", set())  # it speaks while it is made
        is_lost = kind in losing
        losing.discard(kind)
        return is_lost


def start(name: str, *arguments: object, folder: Path | None = None) -> subprocess.Popen[str]:
    """Start an example; modules in `folder` can be imported by it."""
    environment = dict(os.environ) if folder is None else {**os.environ, "PYTHONPATH": str(folder)}
    return subprocess.Popen(
        [sys.executable, str(EXAMPLES / name), *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
    )  # fmt: skip


def finish(process: subprocess.Popen[str]) -> list[str]:
    """The lines that it printed, once it ended well."""
    try:
        out, err = process.communicate(timeout=TIMEOUT)
    finally:
        process.kill()
    assert process.returncode == 0, err[-1000:]
    return out.splitlines()


def run(name: str, vehicle: Vehicle, *arguments: object, speed: float = 5) -> list[str]:
    """Run an example that listens for `vehicle`; what it printed."""
    port = free_port(socket.SOCK_DGRAM)
    with serve(f"udpout:127.0.0.1:{port}", vehicle, speed=speed):
        return finish(start(name, f"udpin:127.0.0.1:{port}", *arguments))


def test_listen() -> None:
    lines = run("listen.py", Vehicle())
    assert lines[:2] == [
        "Heartbeat from system 1, component 1",
        "It is in mode STABILIZE, motors off",
    ]
    assert len(lines) == 12


def test_send_time() -> None:
    vehicle = Recorder()
    lines = run("send_time.py", vehicle)
    assert len(lines) == 3
    assert [(msg.get_srcComponent(), msg.get_type()) for msg in vehicle.heard] == [
        (191, "SYSTEM_TIME"), *[(191, "HEARTBEAT")] * 3,
    ]  # fmt: skip
    assert vehicle.heard[0].time_unix_usec > 1_700_000_000_000_000


def test_receive() -> None:
    heading, satellites, position, altitude, battery = run("receive.py", Vehicle(heading=90))
    assert heading == "heading 90"
    assert re.fullmatch(r"\d+ satellites", satellites)
    lat, lon = map(float, re.findall(r"-?\d+\.\d+", position))
    assert (lat, lon) == pytest.approx((-35.363262, 149.165237), abs=1e-4)
    assert altitude.startswith("altitude 584.0 m")
    assert battery == "system status: 100% battery"


def test_bad_data() -> None:
    *shown, counts, lost = run("bad_data.py", Vehicle(impairment=Impairment(0.05, 0.1)))
    good, _, junk, pieces = map(int, re.findall(r"\d+", counts))
    assert good == 300
    assert junk > pieces > 10 == len(shown)
    assert any("invalid MAVLink CRC" in line for line in shown)
    assert int(lost.split()[0]) > 0


def test_message_interval() -> None:
    vehicle = Vehicle()
    assert run("message_interval.py", vehicle) == [
        "set: MAV_RESULT_ACCEPTED",
        "measured: 20 a second",
        "interval: 50000 us",
        f"capabilities: {vehicle.personality.capabilities:#x}",
    ]


@pytest.mark.parametrize(
    ("key", "bad"),
    [(KEY, ""), (KEY[::-1], r"[1-9]\d*"), (None, "0")],
    ids=["right key", "wrong key", "no key"],
)
def test_signing(key: bytes | None, bad: str, tmp_path: Path) -> None:
    key_file = tmp_path / "key.txt"
    key_file.write_text(KEY.hex() + "\n")
    port = free_port(socket.SOCK_DGRAM)
    with serve(f"udpout:127.0.0.1:{port}", Vehicle(signing_key=key)):
        example = start("signing.py", f"udpin:127.0.0.1:{port}", key_file)
        if key == KEY:
            assert finish(example) == [
                "system 1: signed True, link id 0", "answered, signed True",
            ]  # fmt: skip
        else:
            out, err = example.communicate(timeout=TIMEOUT)
            assert (example.returncode, out) == (1, "")
            reason = f"no heartbeat signed with this key; {bad} bad signatures"
            assert re.match(rf"{reason}, [1-9]\d* messages refused", err)


def test_parameters() -> None:
    vehicle = Vehicle(impairment=Impairment(loss=0.05))
    assert run("parameters.py", vehicle) == [
        f"{len(vehicle.params)} parameters", "WPNAV_SPEED is 1000", "WPNAV_SPEED is now 750",
    ]  # fmt: skip
    assert vehicle.params["WPNAV_SPEED"] == 750


def test_mission() -> None:
    vehicle = Vehicle()
    lines = run("mission.py", vehicle)
    assert (lines[0], lines[-1]) == ("upload: MAV_MISSION_ACCEPTED", "the same")
    assert len(lines) == 2 + 7 == 2 + len(vehicle.mission)


def test_a_mission_whose_numbers_get_lost() -> None:
    vehicle = Forgetful()
    vehicle.losing = {"to MISSION_COUNT", "to MISSION_REQUEST_LIST", "from MISSION_COUNT"}
    lines = run("mission.py", vehicle)
    assert (lines[0], lines[-1]) == ("upload: MAV_MISSION_ACCEPTED", "the same")
    assert not vehicle.losing


def test_a_mission_over_the_satellite_of_the_documentation() -> None:
    """Once telemetry fills the link, answers still come while who asked waits for them."""
    port, far = free_port(socket.SOCK_DGRAM), free_port(socket.SOCK_DGRAM)
    blocks = re.findall(
        r"^```toml\n(.*?)^```", (ROOT / "docs" / "bridge.md").read_text(), re.DOTALL | re.MULTILINE
    )
    links = [link for block in blocks for link in tomllib.loads(block).get("link", ())]
    (options,) = (link for link in links if link.get("name") == "satellite")
    options["endpoint"] = f"udpout:127.0.0.1:{far}"
    with Bridge([f"udpin:127.0.0.1:{port}"]) as bridge:
        bridge.add(**options)
        with serve(f"udpout:127.0.0.1:{port}", Vehicle()):
            wait_until("a full link", lambda: _limited(bridge, "satellite") > 500)
            lines = finish(start("mission.py", f"udpin:127.0.0.1:{far}"))
    assert (lines[0], lines[-1]) == ("upload: MAV_MISSION_ACCEPTED", "the same")


def _limited(bridge: Bridge, name: str) -> int:
    return sum(one["limited"] for one in bridge.stats()["links"] if one["name"] == name)


class Silent(Vehicle):
    """A vehicle that has no answer for who uploads a mission."""

    def handle(self, msg: Any) -> None:
        if msg.get_type() != "MISSION_COUNT":
            super().handle(msg)


class Refusing(Vehicle):
    """A vehicle that takes no mission."""

    def handle(self, msg: Any) -> None:
        if msg.get_type() == "MISSION_COUNT":
            self.send(mavlink.MAVLink_mission_ack_message(255, 0, mavlink.MAV_MISSION_DENIED))
        else:
            super().handle(msg)


@pytest.mark.parametrize(
    ("vehicle", "result"), [(Silent, "no answer"), (Refusing, "MAV_MISSION_DENIED")]
)
def test_a_mission_that_the_vehicle_does_not_take(vehicle: type[Vehicle], result: str) -> None:
    port = free_port(socket.SOCK_DGRAM)
    with serve(f"udpout:127.0.0.1:{port}", vehicle(), speed=5):
        example = start("mission.py", f"udpin:127.0.0.1:{port}")
        out, err = example.communicate(timeout=TIMEOUT)
    assert (example.returncode, out) == (1, f"upload: {result}\n")
    assert err == "the vehicle did not take the mission\n"


def test_a_parameter_that_the_vehicle_does_not_have() -> None:
    port = free_port(socket.SOCK_DGRAM)
    with serve(f"udpout:127.0.0.1:{port}", Vehicle("px4"), speed=5):
        example = start("parameters.py", f"udpin:127.0.0.1:{port}")
        _, err = example.communicate(timeout=TIMEOUT)
    assert example.returncode == 1
    assert err.startswith("WPNAV_SPEED is not among them: name another one")


# -- the program with a device of its own


@pytest.fixture(params=["built-in", "generated"])
def definitions(request: pytest.FixtureRequest, tmp_path: Path) -> Path | None:
    """Where the example finds a `mavlink.py` made by `mavwire gen`, if it is to find one."""
    if request.param == "built-in":
        return None
    xml = ROOT / "message_definitions" / "v1.0" / "common.xml"
    subprocess.run(
        [sys.executable, "-m", "mavwire", "gen", "--wire-protocol=2.0", "-o", "mavlink.py", xml],
        cwd=tmp_path, check=True, capture_output=True,
    )  # fmt: skip
    return tmp_path


def test_mavapi_as_companion(definitions: Path | None) -> None:
    port = free_port(socket.SOCK_DGRAM)
    vehicle = Recorder("px4", params=PATIENT["px4"])
    with serve(f"udpout:127.0.0.1:{port}", vehicle, speed=4):
        example = start(
            "mavapi.py", "companion", "--listen", f"127.0.0.1:{port}", folder=definitions
        )
        module = "mavwire.dialects.v20.common" if definitions is None else "mavlink"
        assert finish(example) == [
            f"the vehicle is there, with the messages of {module}",
            "armed", "in the air, heading 0", "landed, disarmed",
        ]  # fmt: skip
    modes = [(m.base_mode, m.custom_mode) for m in vehicle.heard if m.get_type() == "SET_MODE"]
    assert modes == [(129, 0x2040000), (129, 0x6040000)]
    assert "HEARTBEAT" in {msg.get_type() for msg in vehicle.heard}
    assert vehicle.landed and not vehicle.armed


@pytest.mark.parametrize("package", ["pymavlink", "mavwire"])
def test_mavapi_as_drone(package: str, definitions: Path | None, oracle: str) -> None:
    port = free_port(socket.SOCK_DGRAM)
    example = start(
        "mavapi.py", "drone", "--peer", f"127.0.0.1:{port}", "--seconds", TIMEOUT,
        folder=definitions,
    )  # fmt: skip
    try:
        station = subprocess.run(
            [sys.executable, str(STATION), package, f"udpin:127.0.0.1:{port}"],
            capture_output=True, text=True, timeout=TIMEOUT, check=False,
        )  # fmt: skip
    finally:
        example.send_signal(signal.SIGINT)
        lines = finish(example)
    assert station.returncode == 0, station.stderr.splitlines()[-1:]
    assert json.loads(station.stdout) == {
        "vehicle": [2, 12], "ack": [400, 0], "rolls": True, "mode": "LAND", "bad": 0, "loss": 0,
    }  # fmt: skip
    assert lines == ["seen by 1 ground station(s)"]


# -- the flight


def test_demo(tmp_path: Path) -> None:
    record = tmp_path / "flight.tlog"
    text = "\n".join(finish(start("demo.py", "--record", record, "--messages", 5000)))
    for part in (
        "Vehicle 1 is there, in mode STABILIZE", "vehicle says: Arming motors",
        "At 10 m: flying a square", "Landed. Highest 10", f"$ mavwire info {record}",
        "mavwire reads", "times as fast",
    ):  # fmt: skip
        assert part in text
    assert re.search(r" s GUIDED    armed \[#+-*\]", text)
    assert "\r" not in text
    heights = [msg.relative_alt for msg in messages(record, "GLOBAL_POSITION_INT")]
    assert max(heights) == pytest.approx(10_000, abs=500)
    assert abs(heights[-1]) < 300


def messages(path: Path, kind: str) -> Iterator[Any]:
    """The messages of a type in a log."""
    with mavutil.mavlink_connection(str(path)) as log:
        while (msg := log.recv_match(type=kind)) is not None:
            yield msg


def test_demo_reads_a_given_log(tmp_path: Path) -> None:
    from mavwire import traffic

    path = tmp_path / "mine.tlog"
    traffic.generate(path, 1000, seed=3)
    lines = finish(start("demo.py", path))
    assert lines[1] == f"$ mavwire info {path}"
    assert "1,000 messages" in lines[3]
    assert not any("simulated" in line for line in lines)


def test_demo_says_what_is_no_log(tmp_path: Path) -> None:
    example = start("demo.py", tmp_path / "missing.tlog")
    _, err = example.communicate(timeout=TIMEOUT)
    assert example.returncode == 1
    assert err.splitlines() == [f"mavwire info: {tmp_path / 'missing.tlog'}: no such log file"]


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no terminals here")
def test_the_live_view_on_a_terminal() -> None:
    port = free_port(socket.SOCK_DGRAM)
    ours, theirs = os.openpty()
    with serve(f"udpout:127.0.0.1:{port}", Vehicle(params=PATIENT["ardupilot"]), speed=8):
        command = [sys.executable, str(EXAMPLES / "fly.py"), f"udpin:127.0.0.1:{port}"]
        environment = {**os.environ, "COLUMNS": "60"}
        with subprocess.Popen(command, stdout=theirs, env=environment) as example:
            os.close(theirs)
            text = read_terminal(ours)
    assert example.returncode == 0
    drawn = [line for line in text.split("\r") if "] " in line and " m/s" in line]
    assert len(drawn) > 20
    assert all(len(line) < 60 and "\n" not in line for line in drawn)
    assert "Landed. Highest" in text


class Unheard(Forgetful):
    """A vehicle that loses what begins a flight, and says of no take-off that it obeys."""

    def _is_lost(self, msg: Any, way: str) -> bool:
        is_taking_off = (
            msg.get_type() == "COMMAND_ACK"
            and (msg.command, msg.result)
            == (mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_RESULT_ACCEPTED)
        )  # fmt: skip
        return is_taking_off or super()._is_lost(msg, way)


def test_a_flight_on_a_link_that_loses() -> None:
    vehicle = Unheard(params=PATIENT["ardupilot"])
    vehicle.losing = {"to COMMAND_LONG", "to SET_POSITION_TARGET_LOCAL_NED"}
    text = "\n".join(run("fly.py", vehicle, speed=8))
    assert "At 10 m: flying a square" in text
    assert "Landed. Highest" in text
    assert not vehicle.losing


def test_demo_with_a_reader_that_goes_away(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 2000)
    command = [sys.executable, str(EXAMPLES / "demo.py"), str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        process.stdout.close()  # before anything is written
        _, error = process.communicate(timeout=120)
    assert (process.returncode, error) == (0, b"")
