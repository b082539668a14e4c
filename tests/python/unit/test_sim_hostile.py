"""A vehicle takes anything: whatever arrives, it neither raises nor stops flying nor grows."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import pytest
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Vehicle
from unit.sim_tools import GCS, Station, flying

FLOATS = (0.0, -1.0, 1.0, 0.5, 90.0, 1e9, -1e9, 3.4e38, math.nan, math.inf, -math.inf)
INTEGERS = {
    "uint8_t": (0, 1, 2, 3, 255), "int8_t": (0, -1, -128, 127), "uint16_t": (0, 1, 7, 65535),
    "int16_t": (0, -1, -32768, 32767), "uint32_t": (0, 1, 2**32 - 1), "int32_t": (0, -1, -(2**31), 2**31 - 1),
    "uint64_t": (0, 1, 2**64 - 1), "int64_t": (0, -1, -(2**63), 2**63 - 1),
}  # fmt: skip


def handled(vehicle: Vehicle) -> list[str]:
    """What it listens to; a key, once set, would shut out the rest of the nonsense."""
    return sorted(set(vehicle._handlers) - {"SETUP_SIGNING"})


def value(random: Random, kind: str, name: str, length: int) -> Any:
    if name in ("target_system", "target_component", "target"):
        return random.choice((0, 1))
    if kind == "char":
        return bytes(random.randrange(256) for _ in range(length))
    choices = FLOATS if kind in ("float", "double") else INTEGERS[kind]
    if length:
        return [random.choice(choices) for _ in range(length)]
    if name == "command" and random.random() < 0.95:
        return random.choice(sorted(COMMANDS))
    return random.choice(choices)


COMMANDS = {number for number in mavlink.enums["MAV_CMD"] if number < 65536}


def nonsense(random: Random, name: str) -> Any:
    """A message of a type with extreme values in every field."""
    cls = getattr(mavlink, f"MAVLink_{name.lower()}_message")
    values = [
        value(random, kind.removesuffix("_mavlink_version"), field, length)
        for field, kind, length, *_ in cls._info.parameters
    ]
    return cls(*values)


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("seed", range(4))
def test_messages_full_of_nonsense_do_no_harm(autopilot: str, seed: int) -> None:
    vehicle, station = flying(autopilot, seed=seed)
    random = Random(seed)
    names = handled(vehicle)
    for count in range(2000):
        station.send(nonsense(random, random.choice(names)), dt=0.02 * (count % 3))
        station.messages.clear()
    state = (*vehicle.copter.local, vehicle.copter.vn, vehicle.copter.yaw, vehicle.battery.voltage)
    assert all(map(math.isfinite, state))
    station.step(2)
    assert station.of("HEARTBEAT")


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_noise_is_no_message(autopilot: str) -> None:
    vehicle = Vehicle(autopilot)
    calm = Vehicle(autopilot)
    random = Random(1)
    for _ in range(200):
        noise = bytes(random.randrange(256) for _ in range(100))
        assert vehicle.step(0.01, noise) == calm.step(0.01)


def test_messages_for_others_are_not_answered() -> None:
    vehicle, station = flying("ardupilot")
    others = [
        mavlink.MAVLink_param_request_list_message(2, 1),
        mavlink.MAVLink_param_request_list_message(1, 100),
        mavlink.MAVLink_command_long_message(2, 1, 400, 0, 0, 21196, 0, 0, 0, 0, 0),
        mavlink.MAVLink_manual_control_message(2, 1000, 0, 500, 0, 0),
    ]
    assert [station.send(msg) for msg in others] == [[]] * 4
    assert vehicle.armed


def test_its_own_answers_and_those_of_others_are_not_requests() -> None:
    _, station = flying("ardupilot")
    answers = [
        mavlink.MAVLink_timesync_message(5, 7),
        mavlink.MAVLink_ping_message(1, 2, *GCS),
        mavlink.MAVLink_mission_ack_message(1, 1, 0, 0),
        mavlink.MAVLink_command_ack_message(400, 0),
    ]
    assert [station.send(msg) for msg in answers] == [[]] * 4


def test_a_flood_of_uploads_keeps_one() -> None:
    vehicle = Vehicle()
    station = Station(vehicle)
    station.send(mavlink.MAVLink_mission_count_message(1, 1, 5, 0))
    for system in range(2, 100):
        station.mav.srcSystem = system
        (answer,) = station.send(mavlink.MAVLink_mission_count_message(1, 1, 5, 0))
        assert (answer.get_type(), answer.type) == ("MISSION_ACK", mavlink.MAV_MISSION_DENIED)
