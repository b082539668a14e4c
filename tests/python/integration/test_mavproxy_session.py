"""A session at the prompt of MAVProxy, in an environment of its own where `mavwire alias --enable`
makes every `import pymavlink` give mavwire: several vehicles, masters and outs, signing, and a log
as the master.
"""

from __future__ import annotations

import shutil
import socket
import sysconfig
import time
from pathlib import Path

import pytest
from integration.station_tools import Console, needs, wait_until
from mavwire import mavutil
from mavwire.sim import Vehicle, serve
from unit.environment_tools import PACKAGE_FOLDER, Environment
from unit.link_tools import free_port, telemetry_log
from unit.sim_tools import PATIENT, flying

SCRIPT = shutil.which("mavproxy.py", path=sysconfig.get_path("scripts")) or "mavproxy.py"
MODULES = "log,mode,arm,param,misc,cmdlong,link,wp,signing,output"

pytestmark = needs("MAVProxy")


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Environment:
    """It has the packages of this one, an installed pymavlink among them, and the alias."""
    environment = Environment(tmp_path_factory.mktemp("alias") / "environment")
    packages = sysconfig.get_path("purelib")
    environment.mavwire_pth.write_text(f"{PACKAGE_FOLDER}\n{packages}\n")
    enabled = environment.alias("--enable")
    assert enabled.returncode == 0, enabled.stderr
    return environment


def session(environment: Environment, folder: Path, *options: str) -> Console:
    """MAVProxy at its prompt."""
    folder.mkdir(exist_ok=True)
    start = [environment.python, SCRIPT, f"--default-modules={MODULES}", "--state-basedir=."]
    return Console([*start, *options], folder)


def test_the_environment_gives_mavwire(environment: Environment) -> None:
    show = "import pymavlink.mavutil as m; print(m.__name__)"
    assert environment.run("-c", show).stdout == "mavwire.mavutil\n"


def test_two_masters_and_an_out(environment: Environment, tmp_path: Path) -> None:
    first, second, out = (free_port(socket.SOCK_DGRAM) for _ in range(3))
    one, two = (Vehicle(sysid=sysid, params=PATIENT["ardupilot"]) for sysid in (1, 2))
    peer = mavutil.mavlink_connection(f"udpin:127.0.0.1:{out}")
    with (
        serve(f"udpout:127.0.0.1:{first}", one, speed=5),
        serve(f"udpout:127.0.0.1:{second}", two, speed=5),
        session(
            environment, tmp_path,
            f"--master=udpin:127.0.0.1:{first}", f"--master=udpin:127.0.0.1:{second}",
            f"--out=udpout:127.0.0.1:{out}",
        ) as station,
    ):  # fmt: skip
        station.expect(f"Received {len(one.params)} parameters")
        station.say("param show WPNAV_SPEED")
        station.expect("WPNAV_SPEED      1000.0")
        heard: set[int] = set()
        while heard != {1, 2}:
            beat = peer.recv_match(type="HEARTBEAT", blocking=True, timeout=60)
            assert beat is not None, heard
            heard.add(beat.get_srcSystem())
        peer.mav.param_set_send(1, 1, b"WPNAV_SPEED", 777.0, 9)
        wait_until(lambda: one.params["WPNAV_SPEED"] == 777, "the parameter is set from the out")
        wait_until(lambda: two.autopilot.position_ok, "the second vehicle knows where it is")
        station.say("vehicle 2")
        station.say("mode guided")
        wait_until(lambda: two.mode == "GUIDED", "the second vehicle's mode")
        assert one.mode != "GUIDED"
        station.say("link")
        station.expect("link 2 ")
    peer.close()
    assert "exception" not in station.text.lower()


def test_an_out_that_listens(environment: Environment, tmp_path: Path) -> None:
    """MAVProxy parses by itself what comes from its outs, with the link's `mav`."""
    port, out = (free_port(socket.SOCK_DGRAM) for _ in range(2))
    vehicle = Vehicle(params=PATIENT["ardupilot"])
    with (
        serve(f"udpout:127.0.0.1:{port}", vehicle, speed=5),
        session(
            environment, tmp_path,
            f"--master=udpin:127.0.0.1:{port}", f"--out=udpin:127.0.0.1:{out}",
        ) as station,
        mavutil.mavlink_connection(f"udpout:127.0.0.1:{out}", source_system=254) as peer,
    ):  # fmt: skip
        station.expect(f"Received {len(vehicle.params)} parameters")

        def is_heard() -> bool:
            peer.mav.heartbeat_send(6, 8, 0, 0, 0)
            return peer.recv_match(type="ATTITUDE", blocking=True, timeout=0.5) is not None

        wait_until(is_heard, "the vehicle is heard through the out")
    assert "exception" not in station.text.lower()


def test_signing_is_set_up_from_the_prompt(environment: Environment, tmp_path: Path) -> None:
    port = free_port(socket.SOCK_DGRAM)
    vehicle = Vehicle(params=PATIENT["ardupilot"])
    with (
        serve(f"udpout:127.0.0.1:{port}", vehicle, speed=5),
        session(environment, tmp_path, f"--master=udpin:127.0.0.1:{port}") as station,
    ):
        station.expect(f"Received {len(vehicle.params)} parameters")
        station.say("signing setup words that nobody knows")
        wait_until(lambda: vehicle.signing.key is not None, "the vehicle has the key")
        # From here on the vehicle takes nothing that is not signed.
        station.say("param set WPNAV_SPEED 777")
        wait_until(lambda: vehicle.params["WPNAV_SPEED"] == 777, "the parameter is set, signed")
        wait_until(lambda: vehicle.autopilot.position_ok, "the vehicle knows where it is")
        station.say("mode guided")
        station.expect("Mode GUIDED")
    assert "exception" not in station.text.lower()


def test_a_log_as_the_master(environment: Environment, tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    vehicle, ground = flying("ardupilot")
    ground.step(2)
    log.write_bytes(telemetry_log(ground.messages))
    assert vehicle.mode == "GUIDED"
    with session(environment, tmp_path, f"--master={log}") as station:
        station.expect("Detected vehicle 1:1 on link 0")
        station.expect("ARMED")
        station.say("status HEARTBEAT")
        station.expect("custom_mode : 4")  # GUIDED, as at the end of the log
        station.say("status GLOBAL_POSITION_INT")
        station.expect("GLOBAL_POSITION_INT {")

        def is_read_whole() -> bool:
            station.say("status")
            time.sleep(0.2)
            return f"MasterIn:[{len(ground.messages)}]" in station.text

        wait_until(is_read_whole, "every message of the log")
    assert "exception" not in station.text.lower()
