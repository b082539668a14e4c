"""pymavlink as the ground station of simulated vehicles, over real sockets.

pymavlink runs in a process of its own, so that nothing of mavwire can help it.
"""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from mavwire.sim import Impairment, Vehicle, serve
from unit.link_tools import KEY, free_port
from unit.sim_tools import PATIENT

CLIENT = Path(__file__).with_name("pymavlink_station.py")
TIMEOUT = 180


def run(oracle: str, device: str, task: str, *arguments: str) -> Any:
    """Run a task of the client; what it found out."""
    command = [sys.executable, str(CLIENT), oracle, device, task, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT, check=False)
    assert done.returncode == 0, done.stderr.splitlines()[-1:]
    return json.loads(done.stdout.splitlines()[-1])


def udp() -> tuple[str, str]:
    """Where the vehicle sends to, and where the client listens."""
    port = free_port(socket.SOCK_DGRAM)
    return f"udpout:127.0.0.1:{port}", f"udpin:127.0.0.1:{port}"


@pytest.mark.parametrize(
    ("ours", "theirs", "kind"),
    [
        ("udpout", "udpin", socket.SOCK_DGRAM),
        ("udpin", "udpout", socket.SOCK_DGRAM),
        ("tcpin", "tcp", socket.SOCK_STREAM),
    ],
)
def test_a_whole_flight(oracle: str, ours: str, theirs: str, kind: int) -> None:
    port = free_port(kind)
    with serve(f"{ours}:127.0.0.1:{port}", Vehicle(params=PATIENT["ardupilot"]), speed=10) as sim:
        found = run(oracle, f"{theirs}:127.0.0.1:{port}", "fly")
        vehicle = sim.vehicles[0]
        assert found["mode"] == "GUIDED"
        assert found["highest"] == pytest.approx(10, abs=0.5)
        assert found["landed"] and not vehicle.armed
        assert found["bad"] == 0


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_parameters(oracle: str, autopilot: str) -> None:
    ours, theirs = udp()
    with serve(ours, Vehicle(autopilot), speed=2) as sim:
        found = run(oracle, theirs, "params")
        assert found["names"] == sorted(sim.vehicles[0].params)


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_missions(oracle: str, autopilot: str) -> None:
    ours, theirs = udp()
    with serve(ours, Vehicle(autopilot), speed=2) as sim:
        found = run(oracle, theirs, "mission")
        assert found["result"] == 0
        assert [item["z"] for item in found["items"][1:]] == [20, 30, 40]
        assert len(sim.vehicles[0].mission) == 4


def test_a_bad_link(oracle: str) -> None:
    ours, theirs = udp()
    vehicle = Vehicle(impairment=Impairment(loss=0.2, corruption=0.05, delay=0.02))
    with serve(ours, vehicle, speed=5):
        found = run(oracle, theirs, "listen")
        assert found["bad"] > 0
        assert found["loss"] > 5
        assert {"ATTITUDE", "HEARTBEAT"} <= set(found["types"])


def test_signed_messages(oracle: str) -> None:
    ours, theirs = udp()
    with serve(ours, Vehicle(signing_key=KEY)):
        found = run(oracle, theirs, "signed", KEY.hex())
        assert found["signed"] and found["answered"]


def test_a_directory_and_the_parameter_file(oracle: str) -> None:
    ours, theirs = udp()
    with serve(ours, Vehicle(), speed=2) as sim:
        found = run(oracle, theirs, "ftp")
        assert "APM" in found["names"]
        assert found["size"] > 6 * len(sim.vehicles[0].params)
