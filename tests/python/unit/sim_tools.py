"""A ground station for a simulated vehicle, without a link: what is sent goes straight in, what comes
back is kept.
"""

from __future__ import annotations

import math
from typing import Any

from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Swarm, Vehicle
from mavwire.sim.vehicle import EPOCH

GCS = (255, 190)
NAN = math.nan


# Parameters of a vehicle that waits armed for as long as a test needs to get on.
PATIENT = {"ardupilot": {"DISARM_DELAY": 0}, "px4": {"COM_DISARM_PRFLT": 0}}


class Station:
    """A ground station that talks to one vehicle, or to several."""

    def __init__(self, vehicle: Vehicle | Swarm, key: bytes | None = None) -> None:
        self.vehicle = vehicle
        self.mav: Any = mavlink.MAVLink(None, srcSystem=GCS[0], srcComponent=GCS[1])
        self.mav.robust_parsing = True
        if key is not None:
            self.mav.signing.secret_key = key
            self.mav.signing.sign_outgoing = True
            self.mav.signing.timestamp = (int(EPOCH) - 1_420_070_400) * 100_000
        self.messages: list[Any] = []

    def step(self, dt: float = 0.0, data: bytes = b"") -> list[Any]:
        """Let time pass; what the vehicle sent meanwhile."""
        found = self.mav.parse_buffer(self.vehicle.step(dt, data)) or []
        self.messages += found
        return found

    def frame(self, msg: Any) -> bytes:
        """A message as bytes."""
        data = bytes(msg.pack(self.mav))
        self.mav.seq = (self.mav.seq + 1) & 255
        return data

    def send(self, msg: Any, dt: float = 0.0) -> list[Any]:
        """Send a message; the answers."""
        return self.step(dt, self.frame(msg))

    def command(self, number: int, *params: float, target: int = 1) -> int:
        """COMMAND_LONG; the result of its acknowledgement."""
        padded = [*params, *[0] * (7 - len(params))]
        answers = self.send(mavlink.MAVLink_command_long_message(target, 1, number, 0, *padded))
        (ack,) = [m for m in answers if m.get_type() == "COMMAND_ACK" and m.command == number]
        assert (ack.target_system, ack.target_component) == GCS
        return int(ack.result)

    def until(self, condition: Any, limit: float = 120.0, dt: float = 0.1) -> float:
        """Let time pass until `condition()`; how long that took."""
        for count in range(int(limit / dt)):
            if condition():
                return count * dt
            self.step(dt)
        raise AssertionError(f"not within {limit} s")

    def of(self, name: str) -> list[Any]:
        """All messages of a type so far."""
        return [msg for msg in self.messages if msg.get_type() == name]

    def last(self, name: str) -> Any:
        """The newest message of a type."""
        return self.of(name)[-1]

    def texts(self) -> list[str]:
        """What the vehicle has said."""
        return [msg.text for msg in self.of("STATUSTEXT")]


def ready(autopilot: str, **options: Any) -> tuple[Vehicle, Station]:
    """A vehicle that knows where it is."""
    vehicle = Vehicle(autopilot, **options)
    station = Station(vehicle)
    station.step(5)
    return vehicle, station


def flying(autopilot: str, height: float = 10.0, **options: Any) -> tuple[Vehicle, Station]:
    """A vehicle in the air, in the mode that takes targets."""
    vehicle, station = ready(autopilot, **options)
    if autopilot == "ardupilot":
        assert station.command(mavlink.MAV_CMD_DO_SET_MODE, 1, 4) == 0
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == 0
    above = height if autopilot == "ardupilot" else height + vehicle.autopilot.home_place.alt
    takeoff = (0, 0, 0, NAN, NAN, NAN, above)
    assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, *takeoff) == 0
    station.until(lambda: vehicle.autopilot.task.done or vehicle.mode == "LOITER")
    return vehicle, station


def mission_item(seq: int, command: int, **fields: Any) -> Any:
    """A MISSION_ITEM_INT for vehicle 1."""
    values: dict[str, Any] = {
        "target_system": 1, "target_component": 1, "seq": seq, "command": command,
        "frame": mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, "current": 0, "autocontinue": 1,
        "param1": 0, "param2": 0, "param3": 0, "param4": 0, "x": 0, "y": 0, "z": 0,
        "mission_type": 0,
    }  # fmt: skip
    return mavlink.MAVLink_mission_item_int_message(**{**values, **fields})


def upload(station: Station, items: list[Any], mission_type: int = 0) -> int:
    """Upload a mission; the result."""
    count = mavlink.MAVLink_mission_count_message(1, 1, len(items), mission_type)
    answers = station.send(count)
    for _ in range(len(items) + 1):
        acks = [msg for msg in answers if msg.get_type() == "MISSION_ACK"]
        if acks:
            return int(acks[0].type)
        (request,) = [m for m in answers if m.get_type().startswith("MISSION_REQUEST")]
        answers = station.send(items[request.seq])
    raise AssertionError("no acknowledgement")


def download(station: Station, mission_type: int = 0) -> list[Any]:
    """Download a mission."""
    (count,) = station.send(mavlink.MAVLink_mission_request_list_message(1, 1, mission_type))
    items = []
    for seq in range(count.count):
        request = mavlink.MAVLink_mission_request_int_message(1, 1, seq, mission_type)
        items += station.send(request)
    return items
