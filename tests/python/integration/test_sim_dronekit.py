"""DroneKit as the ground station of an ArduPilot-like vehicle: connect, parameters, a mission up and
down, arm, take-off, land.
"""

from __future__ import annotations

import socket
from pathlib import Path

import pytest
from integration.station_tools import command, needs, report
from mavwire.sim import Vehicle, serve
from unit.link_tools import free_port
from unit.sim_tools import PATIENT

CLIENT = Path(__file__).with_name("dronekit_station.py")

# `past` is the package that DroneKit needs and does not ask for.
pytestmark = needs("dronekit", "past", "monotonic")


@pytest.mark.parametrize("under", ["pymavlink", "mavwire"])
def test_dronekit_flies_the_ardupilot_like_vehicle(under: str) -> None:
    port = free_port(socket.SOCK_DGRAM)
    start = command(under, str(CLIENT), f"udpin:127.0.0.1:{port}")
    vehicle = Vehicle(params=PATIENT["ardupilot"])
    with serve(f"udpout:127.0.0.1:{port}", vehicle, speed=5):
        found = report(start)
    assert found["version"] == "APM:Copter-4.5.7"
    assert found["parameters"] == len(vehicle.params)
    assert vehicle.params["WPNAV_SPEED"] == 777
    assert found["mission"] == [12, 13, 14]
    assert found["height"] == pytest.approx(10, abs=0.6)
    assert vehicle.landed and not vehicle.armed
