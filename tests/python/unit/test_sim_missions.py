"""The mission protocol of a simulated vehicle: both directions, all types, losses, refusals."""

from __future__ import annotations

from typing import Any

import pytest
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Vehicle
from mavwire.sim.geo import Local, e7
from unit.sim_tools import GCS, Station, download, flying, mission_item, ready, upload

WAYPOINT = mavlink.MAV_CMD_NAV_WAYPOINT
MISSION, FENCE, RALLY = 0, 1, 2
COMMAND = {
    MISSION: WAYPOINT,
    FENCE: mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
    RALLY: mavlink.MAV_CMD_NAV_RALLY_POINT,
}


@pytest.fixture(params=["ardupilot", "px4"])
def station(request: pytest.FixtureRequest) -> Station:
    return ready(request.param)[1]


def vehicle_of(station: Station) -> Vehicle:
    assert isinstance(station.vehicle, Vehicle)
    return station.vehicle


def items(count: int, mission_type: int = MISSION, **fields: Any) -> list[Any]:
    """`count` items with different values in every field."""
    return [
        mission_item(
            seq, COMMAND[mission_type], x=473977000 + seq, y=85455000 - seq, z=10.5 + seq,
            param1=seq, param4=0.25, mission_type=mission_type, **fields,
        )
        for seq in range(count)
    ]  # fmt: skip


def content(item: Any) -> tuple[Any, ...]:
    names = "seq frame command param1 param2 param3 param4 x y z autocontinue mission_type"
    return tuple(getattr(item, name) for name in names.split())


@pytest.mark.parametrize("mission_type", [MISSION, FENCE, RALLY])
@pytest.mark.parametrize("count", [1, 2, 30])
def test_what_was_uploaded_is_downloaded(station: Station, mission_type: int, count: int) -> None:
    sent = items(count, mission_type)
    assert upload(station, sent, mission_type) == mavlink.MAV_MISSION_ACCEPTED
    back = download(station, mission_type)
    # Home stands in the first place of an ArduPilot's mission, whatever was sent for it.
    skip = mission_type == MISSION and vehicle_of(station).personality.first_mission_item
    assert [content(item) for item in back[skip:]] == [content(item) for item in sent[skip:]]
    assert len(back) == count
    others = {MISSION, FENCE, RALLY} - {mission_type}
    assert all(download(station, other) == [] for other in others)


def test_home_is_the_first_item_of_an_ardupilot() -> None:
    vehicle, station = ready("ardupilot")
    request = mavlink.MAVLink_mission_request_int_message(1, 1, 0, 0)
    (home,) = station.send(request)
    assert (home.x, home.y) == (e7(vehicle.place.lat), e7(vehicle.place.lon))
    upload(station, items(3))
    assert content(station.send(request)[0]) == content(home)


def test_the_older_messages_carry_degrees(station: Station) -> None:
    vehicle_of(station).mission.store([])
    answers = station.send(mavlink.MAVLink_mission_count_message(1, 1, 2, MISSION))
    for seq in range(2):
        assert answers[0].get_type().startswith("MISSION_REQUEST")
        item = mavlink.MAVLink_mission_item_message(
            1, 1, seq, 3, WAYPOINT, 0, 1, 0, 0, 0, 0, 47.25, 8.5, 12, MISSION
        )
        answers = station.send(item)
    assert answers[0].type == mavlink.MAV_MISSION_ACCEPTED
    stored = vehicle_of(station).mission.items[1]
    assert (stored.x, stored.y, stored.z) == (472500000, 85000000, 12)
    (back,) = station.send(mavlink.MAVLink_mission_request_message(1, 1, 1, MISSION))
    assert (back.get_type(), back.x, back.y) == ("MISSION_ITEM", 47.25, 8.5)


def test_the_request_is_that_of_the_autopilot(station: Station) -> None:
    (request,) = station.send(mavlink.MAVLink_mission_count_message(1, 1, 2, MISSION))
    kinds = {"ardupilot": "MISSION_REQUEST", "px4": "MISSION_REQUEST_INT"}
    assert request.get_type() == kinds[vehicle_of(station).personality.name]
    assert (request.target_system, request.target_component, request.seq) == (*GCS, 0)


def requests(messages: list[Any]) -> list[int]:
    return [msg.seq for msg in messages if msg.get_type().startswith("MISSION_REQUEST")]


def test_lost_items_are_asked_for_again(station: Station) -> None:
    sent = items(4)
    station.send(mavlink.MAVLink_mission_count_message(1, 1, 4, MISSION))
    station.send(sent[0])
    assert requests(station.step(1.2)) == [1, 1]
    assert requests(station.send(sent[1])) == [2]
    assert requests(station.send(sent[1])) == [2], "an item that comes twice"
    assert requests(station.send(sent[3])) == [2], "an item that overtook another"
    station.send(sent[2])
    assert station.send(sent[3])[0].type == mavlink.MAV_MISSION_ACCEPTED


def test_a_lost_acknowledgement_is_repeated(station: Station) -> None:
    sent = items(2)
    assert upload(station, sent) == mavlink.MAV_MISSION_ACCEPTED
    (again,) = station.send(sent[1])
    assert (again.get_type(), again.type) == ("MISSION_ACK", mavlink.MAV_MISSION_ACCEPTED)


def test_an_upload_that_stops_is_given_up_and_changes_nothing(station: Station) -> None:
    upload(station, items(3))
    before = download(station)
    station.send(mavlink.MAVLink_mission_count_message(1, 1, 9, MISSION))
    station.send(items(1)[0])
    station.step(10)
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_OPERATION_CANCELLED
    assert requests(station.step(5)) == []
    assert list(map(content, download(station))) == list(map(content, before))


def test_only_one_ground_station_uploads_at_a_time(station: Station) -> None:
    station.send(mavlink.MAVLink_mission_count_message(1, 1, 2, MISSION))
    station.mav.srcSystem = 254
    (ack,) = station.send(mavlink.MAVLink_mission_count_message(1, 1, 2, MISSION))
    assert (ack.type, ack.target_system) == (mavlink.MAV_MISSION_DENIED, 254)
    station.mav.srcSystem = 255
    assert requests(station.send(items(1)[0])) == [1]


@pytest.mark.parametrize(
    ("fields", "result"),
    [
        ({"command": mavlink.MAV_CMD_DO_WINCH}, mavlink.MAV_MISSION_UNSUPPORTED),
        ({"frame": mavlink.MAV_FRAME_BODY_NED}, mavlink.MAV_MISSION_UNSUPPORTED_FRAME),
        ({"x": 900000001}, mavlink.MAV_MISSION_INVALID_PARAM5_X),
        ({"y": -1800000001}, mavlink.MAV_MISSION_INVALID_PARAM6_Y),
        ({"mission_type": FENCE}, mavlink.MAV_MISSION_INVALID),
    ],
)
def test_items_that_cannot_be_flown_end_the_upload(
    station: Station, fields: dict[str, int], result: int
) -> None:
    wrong = mission_item(1, **{"command": WAYPOINT, **fields})
    assert upload(station, [*items(1), wrong, *items(1)]) == result
    assert requests(station.step(3)) == []


def test_too_many_items_and_unknown_types(station: Station) -> None:
    (ack,) = station.send(mavlink.MAVLink_mission_count_message(1, 1, 1001, MISSION))
    assert ack.type == mavlink.MAV_MISSION_NO_SPACE
    (ack,) = station.send(mavlink.MAVLink_mission_request_list_message(1, 1, 7))
    assert ack.type == mavlink.MAV_MISSION_UNSUPPORTED
    (ack,) = station.send(mavlink.MAVLink_mission_request_int_message(1, 1, 5, MISSION))
    assert ack.type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_clearing_one_type_and_all(station: Station) -> None:
    for mission_type in (MISSION, FENCE, RALLY):
        upload(station, items(2, mission_type), mission_type)
    answers = station.send(mavlink.MAVLink_mission_clear_all_message(1, 1, FENCE))
    assert answers[-1].type == mavlink.MAV_MISSION_ACCEPTED
    assert [len(download(station, kind)) for kind in (MISSION, FENCE, RALLY)] == [2, 0, 2]
    answers = station.send(mavlink.MAVLink_mission_clear_all_message(1, 1, 255))
    assert answers[-1].mission_type == 255
    assert [len(download(station, kind)) for kind in (MISSION, RALLY)] == [0, 0]


def test_a_mission_of_no_items_clears(station: Station) -> None:
    upload(station, items(3))
    assert upload(station, []) == mavlink.MAV_MISSION_ACCEPTED
    assert download(station) == []


def test_part_of_a_mission_is_replaced(station: Station) -> None:
    upload(station, items(5))
    (request,) = station.send(
        mavlink.MAVLink_mission_write_partial_list_message(1, 1, 2, 3, MISSION)
    )
    assert request.seq == 2
    for seq in (2, 3):
        answers = station.send(mission_item(seq, WAYPOINT, z=99))
    assert answers[0].type == mavlink.MAV_MISSION_ACCEPTED
    assert [item.z for item in download(station)][1:] == [11.5, 99, 99, 14.5]
    (ack,) = station.send(mavlink.MAVLink_mission_write_partial_list_message(1, 1, 3, 9, MISSION))
    assert ack.type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_a_single_item_sends_an_ardupilot_somewhere() -> None:
    vehicle, station = flying("ardupilot")
    place = vehicle.copter.origin.globe(Local(20, 5, 0))
    there = mavlink.MAVLink_mission_item_message(
        1, 1, 0, 3, WAYPOINT, 2, 0, 0, 0, 0, 0, place.lat, place.lon, 12
    )
    (ack,) = station.send(there)
    assert ack.type == mavlink.MAV_MISSION_ACCEPTED
    station.step(15)
    assert (vehicle.copter.north, vehicle.copter.east) == pytest.approx((20, 5), abs=1.5)
    assert vehicle.height == pytest.approx(12, abs=0.2)
    _, station = flying("px4")
    assert station.send(there)[0].type == mavlink.MAV_MISSION_UNSUPPORTED


def test_messages_of_a_link_that_speaks_mavlink_1_are_about_missions() -> None:
    """They have no mission type; one that asked for a list ended the thread of the simulator."""
    from mavwire.dialects.v10 import all as mavlink1

    vehicle = Vehicle("ardupilot")
    vehicle.advance(5)
    vehicle.take()
    request = mavlink1.MAVLink_mission_request_list_message(1, 1)
    mav = mavlink1.MAVLink(None, srcSystem=255, srcComponent=190)
    for msg in mav.parse_buffer(request.pack(mav)) or ():
        vehicle.handle(msg)
    assert len(vehicle.take()) == 1
