"""Commands, requests for messages, and telemetry rates of a simulated vehicle."""

from __future__ import annotations

from collections import Counter

import pytest
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Vehicle
from mavwire.sim.personality import PERSONALITIES
from mavwire.sim.telemetry import TELEMETRY
from unit.sim_tools import Station, flying, ready

ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
UNSUPPORTED, FAILED = mavlink.MAV_RESULT_UNSUPPORTED, mavlink.MAV_RESULT_FAILED
REQUEST = mavlink.MAV_CMD_REQUEST_MESSAGE
SET_INTERVAL = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL


@pytest.fixture(params=["ardupilot", "px4"])
def station(request: pytest.FixtureRequest) -> Station:
    return ready(request.param)[1]


def vehicle_of(station: Station) -> Vehicle:
    assert isinstance(station.vehicle, Vehicle)
    return station.vehicle


def test_every_command_is_answered_once(station: Station) -> None:
    known = vehicle_of(station).personality.commands
    for number in (n for n in mavlink.enums["MAV_CMD"] if n < 65536):
        result = station.command(number, 1, 1, 1, 1, 0, 0, 20)
        assert (result == UNSUPPORTED) == (number not in known) or number in (
            mavlink.MAV_CMD_REQUEST_MESSAGE,
            mavlink.MAV_CMD_DO_SET_STANDARD_MODE,
        )


def test_the_command_sets_differ() -> None:
    _, ardupilot = ready("ardupilot")
    _, px4 = ready("px4")
    servo = mavlink.MAV_CMD_DO_SET_SERVO
    assert (ardupilot.command(servo, 6, 1700), px4.command(servo, 6, 1700)) == (
        ACCEPTED,
        UNSUPPORTED,
    )
    ardupilot.step(2)
    assert ardupilot.last("SERVO_OUTPUT_RAW").servo6_raw == 1700
    assert ardupilot.command(servo, 99, 1700) == DENIED


def test_set_mode_is_acknowledged_as_the_autopilot_does() -> None:
    vehicle, station = ready("ardupilot")
    station.send(mavlink.MAVLink_set_mode_message(1, 1, 4))
    assert station.last("COMMAND_ACK").command == mavlink.MAVLINK_MSG_ID_SET_MODE
    assert vehicle.mode == "GUIDED"
    vehicle, station = ready("px4")
    station.send(mavlink.MAVLink_set_mode_message(1, 1, 0x30000))
    assert station.last("COMMAND_ACK").command == mavlink.MAV_CMD_DO_SET_MODE
    assert vehicle.mode == "POSCTL"
    station.send(mavlink.MAVLink_set_mode_message(1, 1, 0xFF0000))
    assert station.last("COMMAND_ACK").result == DENIED
    assert vehicle.mode == "POSCTL"


def test_modes_are_set_by_number_per_autopilot() -> None:
    _, station = ready("ardupilot")
    assert station.command(mavlink.MAV_CMD_DO_SET_MODE, 1, 5) == ACCEPTED
    assert station.last("HEARTBEAT").custom_mode == 5
    assert station.command(mavlink.MAV_CMD_DO_SET_MODE, 1, 77) == DENIED
    assert station.command(mavlink.MAV_CMD_DO_SET_MODE, 64, 5) == DENIED
    _, station = ready("px4")
    assert station.command(mavlink.MAV_CMD_DO_SET_MODE, 29, 4, 5) == ACCEPTED
    assert station.last("HEARTBEAT").custom_mode == 0x05040000


def test_standard_modes_and_their_list() -> None:
    vehicle, station = ready("px4")
    station.command(REQUEST, mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES, 0)
    modes = station.of("AVAILABLE_MODES")
    assert [m.mode_index for m in modes] == list(range(1, len(vehicle.personality.modes) + 1))
    assert {m.number_modes for m in modes} == {len(modes)}
    station.command(REQUEST, mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES, 3)
    assert station.last("AVAILABLE_MODES").mode_name == modes[2].mode_name
    standard = mavlink.MAV_CMD_DO_SET_STANDARD_MODE
    assert station.command(standard, mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY) == ACCEPTED
    assert vehicle.mode == "RTL"
    assert station.command(standard, mavlink.MAV_STANDARD_MODE_CRUISE) == UNSUPPORTED


@pytest.mark.parametrize("name", sorted(TELEMETRY))
def test_every_message_can_be_requested(name: str) -> None:
    for autopilot in PERSONALITIES:
        _, station = flying(autopilot)
        number = getattr(mavlink, f"MAVLINK_MSG_ID_{name}")
        assert station.command(REQUEST, number) == ACCEPTED
        assert station.last(name).get_msgId() == number


def test_messages_that_it_does_not_have(station: Station) -> None:
    assert station.command(REQUEST, mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW) == UNSUPPORTED
    assert station.command(REQUEST, 9999999) == UNSUPPORTED


def test_versions(station: Station) -> None:
    personality = vehicle_of(station).personality
    assert station.command(mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, 1) == ACCEPTED
    version = station.last("AUTOPILOT_VERSION")
    assert version.capabilities == personality.capabilities
    assert tuple(version.flight_sw_version.to_bytes(4, "big"))[:3] == personality.version
    bytewise = version.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    assert bool(bytewise) == (personality.name == "px4")


def test_the_protocol_version_is_told_by_hand(station: Station) -> None:
    for number, params in ((mavlink.MAV_CMD_REQUEST_PROTOCOL_VERSION, (1,)), (REQUEST, (300,))):
        assert station.command(number, *params) == ACCEPTED
        raw = [m for m in station.messages if m.get_msgId() == -2]
        frame = bytes(raw[-1].get_msgbuf())
        assert int.from_bytes(frame[7:10], "little") == 300
        payload = frame[10:-2].ljust(22, b"\0")
        versions = [int.from_bytes(payload[at : at + 2], "little") for at in (0, 2, 4)]
        assert versions == [200, 100, 200]


def test_home_is_told_once_there_is_one() -> None:
    station = Station(Vehicle())
    assert station.command(mavlink.MAV_CMD_GET_HOME_POSITION) == FAILED
    station.step(5)
    assert station.command(mavlink.MAV_CMD_GET_HOME_POSITION) == ACCEPTED
    home = station.last("HOME_POSITION")
    assert (home.latitude, home.longitude, home.altitude) == (-353632620, 1491652370, 584000)


def test_home_can_be_set(station: Station) -> None:
    vehicle = vehicle_of(station)
    place = vehicle.place
    command = mavlink.MAV_CMD_DO_SET_HOME
    assert station.command(command, 0, 0, 0, 0, place.lat + 0.001, place.lon, 500) == ACCEPTED
    home = station.last("HOME_POSITION")
    # COMMAND_LONG carries degrees as float32.
    assert home.latitude == pytest.approx((place.lat + 0.001) * 1e7, abs=40)
    assert home.altitude == 500_000
    assert station.command(command, 1) == ACCEPTED
    assert vehicle.autopilot.home == vehicle.place


# -- rates


def counts(station: Station, seconds: float) -> Counter[str]:
    station.messages.clear()
    station.step(seconds)
    return Counter(msg.get_type() for msg in station.messages)


def test_the_usual_rates(station: Station) -> None:
    seen = counts(station, 20)
    expected = {"HEARTBEAT": 20, "ATTITUDE": 200, "VFR_HUD": 80}
    assert {name: seen[name] for name in expected} == expected
    personality = vehicle_of(station).personality.name
    own = "EKF_STATUS_REPORT" if personality == "ardupilot" else "ATTITUDE_QUATERNION"
    other = "ATTITUDE_QUATERNION" if personality == "ardupilot" else "EKF_STATUS_REPORT"
    assert seen[own] > 0
    assert seen[other] == 0


def test_an_interval_is_set_read_stopped_and_reset(station: Station) -> None:
    attitude = mavlink.MAVLINK_MSG_ID_ATTITUDE
    assert station.command(SET_INTERVAL, attitude, 20_000) == ACCEPTED
    assert counts(station, 4)["ATTITUDE"] == 200
    assert station.command(mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, attitude) == ACCEPTED
    told = station.last("MESSAGE_INTERVAL")
    assert (told.message_id, told.interval_us) == (attitude, 20_000)
    assert station.command(SET_INTERVAL, attitude, -1) == ACCEPTED
    assert counts(station, 4)["ATTITUDE"] == 0
    station.command(mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, attitude)
    assert station.last("MESSAGE_INTERVAL").interval_us == -1
    assert station.command(SET_INTERVAL, attitude, 0) == ACCEPTED
    assert counts(station, 4)["ATTITUDE"] == 40


def test_no_stream_is_faster_than_a_tick(station: Station) -> None:
    attitude = mavlink.MAVLINK_MSG_ID_ATTITUDE
    assert station.command(SET_INTERVAL, attitude, 1) == ACCEPTED
    assert counts(station, 2)["ATTITUDE"] == 200
    station.command(REQUEST, mavlink.MAVLINK_MSG_ID_MESSAGE_INTERVAL, attitude)
    assert station.last("MESSAGE_INTERVAL").interval_us == 10_000


def test_a_message_that_is_not_streamed_can_be(station: Station) -> None:
    assert station.command(SET_INTERVAL, mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, 100_000) == ACCEPTED
    assert counts(station, 5)["HIGHRES_IMU"] == 50


def test_unknown_messages_and_heartbeats_have_no_interval_to_set(station: Station) -> None:
    expected = DENIED if vehicle_of(station).personality.name == "ardupilot" else FAILED
    assert station.command(SET_INTERVAL, 9999, 1000) == expected
    assert station.command(SET_INTERVAL, 0, -1) == expected
    assert counts(station, 3)["HEARTBEAT"] == 3
    station.command(mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, 9999)
    assert station.last("MESSAGE_INTERVAL").interval_us == 0


def test_ardupilot_takes_rates_by_group() -> None:
    _, station = ready("ardupilot")
    position = mavlink.MAV_DATA_STREAM_POSITION
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, position, 20, 1))
    seen = counts(station, 5)
    assert (seen["GLOBAL_POSITION_INT"], seen["ATTITUDE"]) == (100, 50)
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, position, 0, 0))
    assert counts(station, 5)["GLOBAL_POSITION_INT"] == 0
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, 0, 5, 1))
    seen = counts(station, 4)
    assert {seen[name] for name in ("ATTITUDE", "VFR_HUD", "RAW_IMU", "SYS_STATUS")} == {20}
    assert seen["HEARTBEAT"] == 4


def test_px4_does_not() -> None:
    _, station = ready("px4")
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, 0, 20, 1))
    assert counts(station, 5)["ATTITUDE"] == 50


def test_logs_there_are_none(station: Station) -> None:
    (entry,) = station.send(mavlink.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF))
    assert (entry.num_logs, entry.size) == (0, 0)
