"""Simulated vehicles on real links: sockets, threads, several vehicles, keys, the command line."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mavwire import cli, mavutil
from mavwire.cli.vehicle import sim as command
from mavwire.cli.vehicle._sim_status import StatusLine, describe
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Runner, Vehicle, serve
from unit.link_tools import KEY, free_port, heartbeat
from unit.sim_tools import PATIENT
from watchdog import watched

WAIT = 60.0


pytestmark = pytest.mark.usefixtures("mavlink20")


@pytest.fixture
def station() -> Iterator[Any]:
    link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    yield link
    link.close()


def address(link: Any) -> str:
    """Where a vehicle finds the station."""
    return f"udpout:127.0.0.1:{link.port.getsockname()[1]}"


def receive(link: Any, name: str | list[str], condition: str | None = None) -> Any:
    msg = link.recv_match(condition, name, blocking=True, timeout=WAIT)
    assert msg is not None, f"no {name}"
    return msg


def test_a_flight_over_udp(station: Any) -> None:
    vehicle = Vehicle(params=PATIENT["ardupilot"])
    with serve(address(station), vehicle, speed=20) as sim, watched(5 * WAIT):
        assert station.wait_heartbeat(timeout=WAIT).autopilot == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
        receive(station, "EKF_STATUS_REPORT", "EKF_STATUS_REPORT.flags==831")
        station.set_mode("GUIDED")
        assert receive(station, "COMMAND_ACK").result == 0
        station.arducopter_arm()
        station.motors_armed_wait()
        station.mav.command_long_send(1, 1, mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 0, 10)
        receive(station, "GLOBAL_POSITION_INT", "GLOBAL_POSITION_INT.relative_alt>9500")
        station.set_mode("LAND")
        station.motors_disarmed_wait()
        assert sim.vehicles[0].landed
        assert sim.received > 3
        assert sim.errors == 0


def test_several_vehicles_share_a_link(station: Any) -> None:
    vehicles = [Vehicle(sysid=1), Vehicle("px4", sysid=2), Vehicle(sysid=3)]
    with serve(address(station), *vehicles):
        seen = set()
        while seen != {1, 2, 3}:
            seen.add(receive(station, "HEARTBEAT").get_srcSystem())
        station.mav.param_request_read_send(2, 1, b"MPC_XY_CRUISE", -1)
        assert receive(station, "PARAM_VALUE").get_srcSystem() == 2


def test_a_vehicle_that_waits_for_stations() -> None:
    port = free_port(socket.SOCK_STREAM)
    with serve(f"tcpin:127.0.0.1:{port}", Vehicle("px4")):
        for _ in range(2):
            link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{port}")
            assert link.wait_heartbeat(timeout=WAIT).autopilot == mavlink.MAV_AUTOPILOT_PX4
            link.close()


def test_two_links_hear_the_same(station: Any) -> None:
    other = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    with serve([address(station), address(other)], Vehicle()) as sim:
        first, second = receive(station, "ATTITUDE"), receive(other, "ATTITUDE")
        assert first.get_seq() == second.get_seq()
        assert len(sim.links) == 2
    other.close()


def test_with_a_key_links_take_signed_messages_only(station: Any) -> None:
    stranger = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    vehicle = Vehicle(signing_key=KEY)
    with serve([address(station), address(stranger)], vehicle):
        station.setup_signing(KEY)
        assert receive(station, "HEARTBEAT").get_signed()
        receive(stranger, "HEARTBEAT")
        stranger.mav.param_request_read_send(1, 1, b"RTL_ALT", -1)
        station.mav.param_request_read_send(1, 1, b"WPNAV_SPEED", -1)
        answers = [receive(station, "PARAM_VALUE").param_id]
        assert answers == ["WPNAV_SPEED"]
    stranger.close()


def test_vehicles_on_one_link_may_have_different_keys(station: Any) -> None:
    stranger = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    vehicles = [Vehicle(sysid=1), Vehicle(sysid=2, signing_key=KEY)]
    with serve([address(station), address(stranger)], *vehicles):
        receive(stranger, "HEARTBEAT")
        station.setup_signing(KEY, allow_unsigned_callback=lambda *_: True)
        while not receive(station, "HEARTBEAT").get_signed():
            pass
        stranger.mav.param_request_read_send(2, 1, b"RTL_ALT", -1)  # needs a signature
        stranger.mav.param_request_read_send(1, 1, b"WPNAV_SPEED", -1)  # needs none
        assert receive(stranger, "PARAM_VALUE").param_id == "WPNAV_SPEED"
        station.mav.param_request_read_send(2, 1, b"WPNAV_RADIUS", -1)
        answers = [receive(stranger, "PARAM_VALUE")]
        assert [(m.get_srcSystem(), m.param_id) for m in answers] == [(2, "WPNAV_RADIUS")]
    stranger.close()


def test_stopping_is_quick_and_closes_the_links(station: Any) -> None:
    with serve(address(station), Vehicle()) as sim:
        receive(station, "HEARTBEAT")
        sock = sim.links[0].port
    assert sock.fileno() == -1
    sim.stop()


def test_a_long_pause_is_not_flown_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    vehicle = Vehicle()
    runner = Runner([vehicle], [])
    now = [1000.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    runner.turn()
    now[0] += 500
    wait = runner.turn()
    assert vehicle.time == pytest.approx(1.0)
    assert 0 < wait <= 0.5
    runner.close()


def test_nothing_is_due_until_it_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """The loop turns as often as there is something to send, and no more."""
    runner = Runner([Vehicle(params=dict.fromkeys(SILENT, 0.0))], [])
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    turns = 0
    while now[0] < 20:
        now[0] += runner.turn() + 1e-4
        turns += 1
    assert 20 <= turns <= 45
    runner.close()


SILENT = (
    "SR0_EXTRA1 SR0_EXTRA2 SR0_EXTRA3 SR0_EXT_STAT SR0_POSITION SR0_RAW_SENS SR0_RC_CHAN"
).split()


def run_until_sent(runner: Runner) -> None:
    """Let time pass until the vehicles have sent something."""
    with watched():
        while runner.sent == 0:
            runner.run(duration=0.1)


def test_a_link_that_fails_does_not_stop_the_vehicle() -> None:
    class Broken:
        fd = None

        def recv_msg(self) -> None:
            return None

        def write(self, frame: bytes) -> None:
            raise OSError("gone")

        def close(self) -> None:
            pass

    runner = Runner([Vehicle()], [Broken()])
    run_until_sent(runner)
    assert runner.errors == runner.sent > 0
    runner.close()


def test_a_link_that_cannot_be_read_does_not_stop_the_vehicle() -> None:
    link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    runner = Runner([Vehicle()], [link])
    link.close()
    run_until_sent(runner)
    assert runner.errors > 0
    runner.close()


def test_messages_beyond_a_turn_are_taken_in_the_next_one_without_a_pause(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What a link read ahead makes no descriptor readable."""
    monkeypatch.setattr("mavwire.sim.runner.MESSAGES_PER_TURN", 10)
    link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    runner = Runner([Vehicle()], [link])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        for _ in range(25):
            station.sendto(heartbeat(), link.port.getsockname())
    waits = [runner.turn() for _ in range(3)]
    assert runner.received == 25
    assert (waits[:2], waits[2] > 0) == ([0.0, 0.0], True)
    runner.close()


def test_the_clock_is_the_present_unless_it_was_given() -> None:
    now, then = Vehicle(), Vehicle(sysid=2, start=1000.0)
    Runner([now, then], []).close()
    assert now.unix_us / 1e6 == pytest.approx(time.time(), abs=60)
    assert then.unix_us == 1_000_000_000


@pytest.mark.parametrize("speed", [0, -1, 1000])
def test_speed_has_limits(speed: float) -> None:
    with pytest.raises(ValueError, match="speed"):
        Runner([Vehicle()], [], speed)


def test_a_wrong_device_leaves_nothing_open() -> None:
    with pytest.raises(ValueError, match="UDP"), serve("udpout:nonsense"):
        pass


# -- the command


def test_the_command_flies(station: Any) -> None:
    options = "--autopilot px4 --count 2 --fly --speed 10 --param mis_takeoff_alt=4"
    arguments = ["sim", "--out", address(station), *options.split()]
    heights, texts = {1: 0.0, 2: 0.0}, set()
    with subprocess.Popen(
        [sys.executable, "-m", "mavwire", *arguments], stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            with watched(5 * WAIT):
                while min(heights.values()) < 15 or "Takeoff detected" not in texts:
                    msg = receive(station, ["GLOBAL_POSITION_INT", "STATUSTEXT"])
                    system = msg.get_srcSystem()
                    if msg.get_type() == "STATUSTEXT":
                        texts.add(msg.text)
                    else:
                        heights[system] = max(heights[system], msg.relative_alt / 1e3)
            process.send_signal(signal.SIGINT)
            _, error = process.communicate(timeout=WAIT)
        finally:
            process.kill()
    assert process.returncode == 0
    assert "vehicles 1 to 2" in error


def test_the_command_ends_when_its_time_is_over(station: Any) -> None:
    assert cli.main(["sim", "--out", address(station), "--duration", "20ms", "--quiet"]) == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--count", "0"], "--count"),
        (["--sysid", "254", "--count", "2"], "--sysid"),
        (["--param", "NO_SUCH=1"], "NO_SUCH"),
        (["--speed", "0"], "speed"),
        (["--out", "udpout:nonsense"], "udpout:nonsense"),
        (["--out", "tcp:127.0.0.1:1"], "refused"),
        (["--out", "csv:pyproject.toml"], "csv:pyproject.toml is a log, not a link"),
        (["--home", "1,2,1e30"], "altitude within 10000 m"),
        (["--heading", "nan"], "heading"),
        (["--heading", "1e308"], "heading"),
        (["--param", "WPNAV_SPEED=1e39"], "WPNAV_SPEED must be a finite number"),
        (["--param", "WPNAV_SPEED=nan"], "WPNAV_SPEED must be a finite number"),
    ],
)
def test_mistakes_are_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["sim", "--duration", "1ms", *arguments]) == 1
    captured = capsys.readouterr()
    error = captured.err
    assert said in error
    assert captured.out == ""
    assert "Traceback" not in error


@pytest.mark.parametrize(
    ("device", "module", "extra"),
    [
        ("/dev/ttyUSB0", "serial", "serial"),
        ("ws:127.0.0.1:5", "wsproto", "ws"),
        ("wss:127.0.0.1:5", "wsproto", "ws"),
        ("wsserver:127.0.0.1:0", "wsproto", "ws"),
    ],
)
def test_packages_that_a_link_needs_are_named(
    device: str, module: str, extra: str,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.setitem(sys.modules, module, None)
    assert cli.main(["sim", "--duration", "1ms", "--out", device]) == 1
    package = {"serial": "pyserial"}.get(module, module)
    reason = f"mavwire sim: error: {device} needs {package}: pip install 'mavwire[{extra}]'\n"
    assert capsys.readouterr().err == reason


def test_mavlink_1_is_not_signed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    key = tmp_path / "key"
    key.write_bytes(KEY)
    assert cli.main(["sim", "--duration", "1ms", "--mavlink1", "--signing-key", str(key)]) == 1
    assert "MAVLink 1 has no signatures" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["--loss", "7x"], ["--loss", "101%"], ["--delay", "soon"], ["--home", "here"],
        ["--home", "90,0"], ["--home", "1,2,nan"], ["--home", "1,2,inf"], ["--wind", "0,99"],
        ["--wind", "nan,5"], ["--param", "X"], ["--signing-key", "/no/such/key"],
    ],
)  # fmt: skip
def test_values_that_make_no_sense_are_usage_errors(arguments: list[str]) -> None:
    with pytest.raises(SystemExit) as error:
        cli.main(["sim", *arguments])
    assert error.value.code == 2


def test_values_of_options() -> None:
    assert [command.fraction(text) for text in ("5%", "0.05", "0", "100%")] == [0.05, 0.05, 0, 1]
    assert [command.duration(text) for text in ("200ms", "1.5s", "2m", "3")] == [0.2, 1.5, 120, 3]
    assert command.place("47.4,8.5") == (47.4, 8.5, 0)
    assert command.wind("270,5") == pytest.approx((0, 5))
    assert command.setting("rtl_alt = 20") == ("RTL_ALT", 20)


def test_keys_come_from_files(tmp_path: Path) -> None:
    path = tmp_path / "key"
    for content in (KEY, KEY.hex().encode() + b"\n"):
        path.write_bytes(content)
        assert command.key_file(str(path)) == KEY
    path.write_bytes(b"too short")
    # A file that never ends is no key either.
    for other in (path, "/dev/zero"):
        with pytest.raises(Exception, match=r"32 bytes|No such file|longer than"):
            command.key_file(str(other))


def test_the_status_line_says_what_they_do() -> None:
    vehicle = Vehicle()
    runner = Runner([vehicle, Vehicle("px4", sysid=2)], [])
    assert describe(vehicle) == "[1] STABILIZE starting 100%"
    runner.swarm.advance(5)
    assert describe(vehicle) == "[1] STABILIZE ready 100%"
    vehicle.autopilot.arm(force=True)
    assert describe(vehicle) == "[1] STABILIZE armed 100%"
    line = StatusLine(runner)
    assert not line.enabled
    assert "[2] LOITER ready 100%" in line.text()
    runner.close()
