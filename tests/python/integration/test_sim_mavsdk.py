"""MAVSDK as the ground station of the PX4-like vehicle: connect, health, parameters, files, fence,
arm, take off, mission, offboard, goto, return. Once through the library, and once, shorter, through
mavsdk_server.
"""

from __future__ import annotations

import contextlib
import socket
import sys
from pathlib import Path
from typing import Any

import pytest
from integration.relays import null_modem
from integration.station_tools import needs, report
from mavwire.sim import Vehicle, serve
from unit.link_tools import free_port
from unit.sim_tools import PATIENT

FOLDER = Path(__file__).parent


def run(script: str, vehicle: Vehicle, *arguments: str) -> Any:
    """Run a station while the vehicle flies; what it found."""
    port = free_port(socket.SOCK_DGRAM)
    command = [sys.executable, str(FOLDER / script), f"udpin://127.0.0.1:{port}", *arguments]
    with serve(f"udpout:127.0.0.1:{port}", vehicle, speed=4):
        return report(command)


@needs("mavsdk")
def test_mavsdk_flies_the_px4_like_vehicle() -> None:
    vehicle = Vehicle("px4", params=PATIENT["px4"])
    found = run("mavsdk_station.py", vehicle)
    assert found["params"] == {
        "autostart": 10016, "mode": -5, "cruise": 7.5, "count": len(vehicle.params),
    }  # fmt: skip
    assert (vehicle.params["COM_FLTMODE1"], vehicle.params["MPC_XY_CRUISE"]) == (-5, 7.5)
    assert found["files"] == {
        "files": ["extras", "version.txt"], "text": "PX4 1.15.4 (mavwire)\n", "same": True,
    }  # fmt: skip
    assert found["circles"] == 1
    assert found["height"] == pytest.approx(6, abs=0.6)
    assert found["mission"]["downloaded"] == 4
    assert found["mission"]["progress"] == sorted(found["mission"]["progress"])
    assert found["offboard"] == pytest.approx([5, -5, -8], abs=0.6)
    assert found["landed"] and vehicle.landed


def ends(kind: str) -> tuple[str, str]:
    """Where the vehicle is, and what MAVSDK calls it."""
    if kind == "tcp":
        port = free_port()
        return f"tcpin:127.0.0.1:{port}", f"tcpout://127.0.0.1:{port}"
    port = free_port(socket.SOCK_DGRAM)
    return f"udpin:127.0.0.1:{port}", f"udpout://127.0.0.1:{port}"


@needs("mavsdk")
@pytest.mark.parametrize("kind", ["udp", "tcp", "serial"])
def test_mavsdk_visits_over_other_transports(kind: str) -> None:
    vehicle = Vehicle("px4")
    with contextlib.ExitStack() as stack:
        if kind == "serial":
            pytest.importorskip("serial")
            here, there = stack.enter_context(null_modem())
            device, connection = f"{here},57600", f"serial://{there}:57600"
        else:
            device, connection = ends(kind)
        stack.enter_context(serve(device, vehicle, speed=4))
        found = report([sys.executable, str(FOLDER / "mavsdk_station.py"), connection, "visit"])
    assert found["params"]["count"] == len(vehicle.params)
    assert vehicle.params["COM_FLTMODE1"] == -5


@needs("mavsdk_grpc", "grpc", "google")
def test_mavsdk_server_flies_the_px4_like_vehicle() -> None:
    vehicle = Vehicle("px4", params=PATIENT["px4"])
    found = run("mavsdk_grpc_station.py", vehicle, str(free_port()))
    assert found["params"] == {"autostart": 10016, "mode": -5, "cruise": 7.5}
    assert (vehicle.params["COM_FLTMODE1"], vehicle.params["MPC_XY_CRUISE"]) == (-5, 7.5)
    assert found["mission"] == [12, 12, 12, 12]
    assert len(vehicle.mission) == 4
    assert found["height"] == pytest.approx(6, abs=0.6)
    assert vehicle.landed and not vehicle.armed
