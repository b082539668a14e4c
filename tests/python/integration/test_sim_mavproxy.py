"""MAVProxy as the ground station of an ArduPilot-like vehicle, headless and driven by its prompt:
parameters, a mission up and down, mode, arming, take-off, landing.
"""

from __future__ import annotations

import shutil
import socket
import sysconfig
from pathlib import Path

import pytest
from integration.station_tools import Console, command, needs, wait_until
from mavwire.sim import Vehicle, serve
from unit.link_tools import free_port
from unit.sim_tools import PATIENT

SCRIPT = shutil.which("mavproxy.py", path=sysconfig.get_path("scripts")) or "mavproxy.py"
MODULES = "log,mode,arm,param,misc,cmdlong,link,wp"
MISSION = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t-35.363262\t149.165237\t584\t1
1\t0\t3\t22\t0\t0\t0\t0\t-35.363262\t149.165237\t10\t1
2\t0\t3\t16\t0\t0\t0\t0\t-35.362262\t149.165237\t12\t1
3\t0\t3\t21\t0\t0\t0\t0\t-35.362262\t149.165237\t0\t1
"""

pytestmark = needs("MAVProxy")


@pytest.mark.parametrize("under", ["pymavlink", "mavwire"])
def test_mavproxy_flies_the_ardupilot_like_vehicle(under: str, tmp_path: Path) -> None:
    port = free_port(socket.SOCK_DGRAM)
    start = command(
        under, SCRIPT,
        f"--master=udpin:127.0.0.1:{port}", f"--default-modules={MODULES}", "--state-basedir=.",
    )  # fmt: skip
    (tmp_path / "route.txt").write_text(MISSION)
    vehicle = Vehicle(params=PATIENT["ardupilot"])
    with (
        serve(f"udpout:127.0.0.1:{port}", vehicle, speed=5),
        Console(start, tmp_path) as station,
    ):
        station.expect(f"Received {len(vehicle.params)} parameters")
        station.say("param set WPNAV_SPEED 777")
        wait_until(lambda: vehicle.params["WPNAV_SPEED"] == 777, "the parameter is set")
        load_mission(station, vehicle)
        station.say("wp save back.txt")
        station.expect("Saved 4 waypoints")
        flight(station, vehicle)
    assert [line.split()[3] for line in (tmp_path / "back.txt").read_text().splitlines()[1:]] == [
        "16", "22", "16", "21",
    ]  # fmt: skip


def load_mission(station: Console, vehicle: Vehicle) -> None:
    """Anew if the vehicle gave up waiting for an item: its clock is fast, the machine may be slow."""
    tries = 0

    def is_over() -> bool:
        return len(vehicle.mission) == 4 or station.text.count("CANCELLED") == tries

    while len(vehicle.mission) != 4:
        tries += 1
        station.say("wp load route.txt")
        wait_until(is_over, "the mission is uploaded")


def flight(station: Console, vehicle: Vehicle) -> None:
    """Up and down again."""
    wait_until(lambda: vehicle.autopilot.position_ok, "the vehicle knows where it is")
    station.say("mode guided")
    wait_until(lambda: vehicle.mode == "GUIDED", "guided mode")
    station.say("arm throttle")
    wait_until(lambda: vehicle.armed, "armed")
    station.say("takeoff 10")
    wait_until(lambda: vehicle.height > 9, "in the air")
    station.say("mode land")
    wait_until(lambda: vehicle.landed and not vehicle.armed, "landed")
    station.expect("DISARMED")
