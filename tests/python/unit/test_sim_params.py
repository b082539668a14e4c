"""Parameters of a simulated vehicle: list, read, set, and both encodings of integers."""

from __future__ import annotations

import math
import struct
from typing import Any

import pytest
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Vehicle
from unit.sim_tools import Station

INT32, REAL32 = mavlink.MAV_PARAM_TYPE_INT32, mavlink.MAV_PARAM_TYPE_REAL32


@pytest.fixture(params=["ardupilot", "px4"])
def station(request: pytest.FixtureRequest) -> Station:
    return Station(Vehicle(request.param))


def vehicle_of(station: Station) -> Vehicle:
    assert isinstance(station.vehicle, Vehicle)
    return station.vehicle


def as_integer(value: float) -> int:
    """The integer whose bytes a float carries."""
    return int(struct.unpack("<i", struct.pack("<f", value))[0])


def as_bytes(value: int) -> float:
    """The float that carries the bytes of an integer."""
    return float(struct.unpack("<f", struct.pack("<i", value))[0])


def read(station: Station, name: str = "", index: int = -1) -> list[Any]:
    return station.send(mavlink.MAVLink_param_request_read_message(1, 1, name.encode(), index))


def write(station: Station, name: str, value: float, kind: int) -> list[Any]:
    return station.send(mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, kind))


def test_the_list_has_every_parameter_once(station: Station) -> None:
    station.send(mavlink.MAVLink_param_request_list_message(1, 1), dt=5)
    params = vehicle_of(station).params
    values = [msg for msg in station.of("PARAM_VALUE") if msg.param_index != 65535]
    assert [msg.param_index for msg in values] == list(range(len(params)))
    assert [msg.param_id for msg in values] == list(params)
    assert {msg.param_count for msg in values} == {len(params)}
    assert all(len(name) <= 16 for name in params)


def test_a_list_leaves_room_for_telemetry(station: Station) -> None:
    found = station.send(mavlink.MAVLink_param_request_list_message(1, 1), dt=0.5)
    assert sum(msg.get_type() == "PARAM_VALUE" for msg in found) <= 30
    assert any(msg.get_type() == "ATTITUDE" for msg in found)


def test_reading_by_name_and_by_index(station: Station) -> None:
    names = list(vehicle_of(station).params)
    (by_index,) = read(station, index=5)
    (by_name,) = read(station, names[5])
    assert by_index.to_dict() == by_name.to_dict()
    assert (by_index.param_id, by_index.param_index) == (names[5], 5)


@pytest.mark.parametrize(("name", "index"), [("NO_SUCH", -1), ("", 9999), ("", -1)])
def test_unknown_parameters_are_named_in_a_text(station: Station, name: str, index: int) -> None:
    (text,) = read(station, name, index)
    assert text.get_type() == "STATUSTEXT"
    assert (name or f"#{index}") in text.text


def test_ardupilot_casts_integers() -> None:
    station = Station(Vehicle("ardupilot"))
    (value,) = write(station, "BATT_CAPACITY", 3300.0, REAL32)
    assert (value.param_value, value.param_type) == (3300.0, INT32)
    assert vehicle_of(station).params["BATT_CAPACITY"] == 3300


def test_px4_copies_the_bytes_of_integers() -> None:
    station = Station(Vehicle("px4"))
    (value,) = read(station, "SYS_AUTOSTART")
    assert (value.param_type, as_integer(value.param_value)) == (INT32, 10016)
    (value,) = read(station, "COM_FLTMODE1")
    assert math.isnan(value.param_value)
    assert as_integer(value.param_value) == -1
    (value,) = write(station, "COM_FLTMODE1", as_bytes(-7), INT32)
    assert as_integer(value.param_value) == -7
    assert vehicle_of(station).params["COM_FLTMODE1"] == -7


@pytest.mark.parametrize("value", [-5_000_000, 0x7F800001, 0x7FBFFFFF, -0x7FFFFF, -0x400001])
def test_px4_copies_the_bytes_of_signalling_nans(value: int) -> None:
    """Which a processor changes when it makes a double of them."""
    station = Station(Vehicle("px4"))
    data = struct.pack("<i", value)
    payload = data + struct.pack("<BB16sB", 1, 1, b"COM_FLTMODE1", INT32)
    msg = mavlink.MAVLink_param_set_message(1, 1, b"COM_FLTMODE1", 0.0, INT32)
    (answer,) = station.step(0, msg._pack(station.mav, msg.crc_extra, payload))
    assert vehicle_of(station).params["COM_FLTMODE1"] == value
    assert answer.get_msgbuf()[10:14] == data
    (answer,) = read(station, "COM_FLTMODE1")
    assert answer.get_msgbuf()[10:14] == data


def test_px4_refuses_another_type() -> None:
    station = Station(Vehicle("px4"))
    text, value = write(station, "SYS_AUTOSTART", 4001.0, REAL32)
    assert "types mismatch" in text.text
    assert as_integer(value.param_value) == 10016


def test_a_changed_float_is_announced_as_it_is_stored(station: Station) -> None:
    name = "WPNAV_RADIUS" if "WPNAV_RADIUS" in vehicle_of(station).params else "NAV_ACC_RAD"
    (value,) = write(station, name, 1.1, REAL32)
    assert (
        value.param_value
        == vehicle_of(station).params[name]
        == struct.unpack("<f", struct.pack("<f", 1.1))[0]
    )


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_no_number_changes_nothing(station: Station, value: float) -> None:
    name = "WPNAV_RADIUS" if "WPNAV_RADIUS" in vehicle_of(station).params else "NAV_ACC_RAD"
    before = vehicle_of(station).params[name]
    (answer,) = write(station, name, value, REAL32)
    assert answer.param_value == before == vehicle_of(station).params[name]


def test_integers_stay_within_their_type() -> None:
    vehicle = Vehicle("ardupilot")
    vehicle.params["FENCE_ENABLE"] = 300.7
    vehicle.params["RTL_ALT"] = -1e9
    assert (vehicle.params["FENCE_ENABLE"], vehicle.params["RTL_ALT"]) == (127, -32768)
    with pytest.raises(KeyError, match="NO_SUCH"):
        vehicle.params["NO_SUCH"] = 1


def test_parameters_take_effect() -> None:
    vehicle = Vehicle("px4", sysid=9)
    assert vehicle.params["MAV_SYS_ID"] == 9
    vehicle.params["MPC_XY_CRUISE"] = 7
    assert vehicle.tuning.cruise_speed == 7
    vehicle = Vehicle("ardupilot")
    station = Station(vehicle)
    write(station, "SR0_EXTRA1", 50, REAL32)
    assert vehicle.streams.rate("ATTITUDE") == 50
    write(station, "SR0_EXTRA1", 0, REAL32)
    assert vehicle.streams.rate("ATTITUDE") == 0


def test_all_can_be_reset() -> None:
    vehicle = Vehicle("ardupilot", sysid=4)
    station = Station(vehicle)
    vehicle.params["WPNAV_SPEED"] = 111
    message = mavlink.MAVLink_command_long_message(
        4, 1, mavlink.MAV_CMD_PREFLIGHT_STORAGE, 0, 2, 0, 0, 0, 0, 0, 0
    )
    station.send(message)
    assert (vehicle.params["WPNAV_SPEED"], vehicle.params["SYSID_THISMAV"]) == (1000, 4)


def test_the_hash_of_px4_changes_with_the_values() -> None:
    vehicle = Vehicle("px4")
    station = Station(vehicle)
    (first,) = read(station, "_HASH_CHECK")
    vehicle.params["MPC_XY_CRUISE"] = 7
    station.step(0)
    (second,) = read(station, "_HASH_CHECK")
    hashes = [as_integer(msg.param_value) for msg in (first, second)]
    assert hashes[0] != hashes[1]
    assert first.param_type == mavlink.MAV_PARAM_TYPE_UINT32


def test_a_ground_station_with_a_cache_stops_the_list() -> None:
    station = Station(Vehicle("px4"))
    station.send(mavlink.MAVLink_param_request_list_message(1, 1), dt=0.2)
    assert write(station, "_HASH_CHECK", 0.0, mavlink.MAV_PARAM_TYPE_UINT32) == []
    station.messages.clear()
    station.step(3)
    assert station.of("PARAM_VALUE") == []
