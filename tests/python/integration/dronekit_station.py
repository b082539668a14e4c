"""A ground station made of DroneKit: flies an ArduPilot-like vehicle and prints what it saw as JSON.

python dronekit_station.py DEVICE
"""

from __future__ import annotations

import collections
import collections.abc
import json
import sys
import time
from collections.abc import Callable

# DroneKit's last release is older than Python 3.10, which took this name away.
collections.MutableMapping = collections.abc.MutableMapping  # type: ignore[attr-defined]

import dronekit  # noqa: E402

WAIT = 60.0
NAV_WAYPOINT, RELATIVE = 16, 3


def until(condition: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + WAIT
    while not condition():
        if time.monotonic() > deadline:
            raise SystemExit(f"not within {WAIT} s: {what}")
        time.sleep(0.02)


def mission(vehicle: dronekit.Vehicle) -> list[float]:
    commands = vehicle.commands
    commands.download()
    commands.wait_ready()
    commands.clear()
    for number in range(3):
        place = (-35.363 + number * 1e-4, 149.165, 12 + number)
        commands.add(
            dronekit.Command(0, 0, 0, RELATIVE, NAV_WAYPOINT, 0, 0, 0, 0, 0, 0, *place)
        )  # fmt: skip
    commands.upload()
    commands.download()
    commands.wait_ready()
    return [item.z for item in commands]


def fly(vehicle: dronekit.Vehicle) -> float:
    until(lambda: vehicle.is_armable, "armable")
    vehicle.mode = dronekit.VehicleMode("GUIDED")
    until(lambda: vehicle.mode.name == "GUIDED", "guided mode")
    vehicle.armed = True
    until(lambda: vehicle.armed, "armed")
    vehicle.simple_takeoff(10)
    until(lambda: vehicle.location.global_relative_frame.alt > 9.5, "in the air")
    height = vehicle.location.global_relative_frame.alt
    vehicle.mode = dronekit.VehicleMode("LAND")
    until(lambda: not vehicle.armed, "landed")
    return height


def main() -> None:
    wanted = ["parameters", "armed", "mode", "attitude"]
    vehicle = dronekit.connect(sys.argv[1], wait_ready=wanted, timeout=WAIT)
    found = {"version": str(vehicle.version), "parameters": len(vehicle.parameters)}
    vehicle.parameters["WPNAV_SPEED"] = 777
    found["mission"] = mission(vehicle)
    found["height"] = fly(vehicle)
    vehicle.close()
    print(json.dumps(found))


if __name__ == "__main__":
    main()
