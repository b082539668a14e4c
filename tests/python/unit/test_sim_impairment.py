"""Bad links: what they lose, damage, double and delay, and protocols that work all the same."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import pytest
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Impairment, Vehicle
from mavwire.sim.impairment import MAX_WAITING, Channel, flip_bit
from unit.sim_tools import Station


def lost(messages: list[object]) -> int:
    """Gaps in the sequence numbers."""
    seqs = [msg.get_seq() for msg in messages if msg.get_type() != "BAD_DATA"]  # type: ignore[attr-defined]
    return sum((b - a - 1) & 255 for a, b in pairwise(seqs))


def test_frames_are_lost() -> None:
    vehicle = Vehicle(impairment=Impairment(loss=0.1))
    station = Station(vehicle)
    station.step(60)
    assert lost(station.messages) / vehicle.frames_sent == pytest.approx(0.1, abs=0.02)
    outgoing, incoming = vehicle.losses
    assert outgoing.lost + outgoing.passed == vehicle.frames_sent
    assert outgoing.passed == len(station.messages)
    assert incoming.passed == 0


def test_damaged_frames_are_rejected_by_their_checksum() -> None:
    vehicle = Vehicle(impairment=Impairment(corruption=0.1))
    station = Station(vehicle)
    station.mav.resync = "rescan"
    station.step(30)
    bad = station.of("BAD_DATA")
    good = len(station.messages) - len(bad)
    assert good / vehicle.frames_sent == pytest.approx(0.9, abs=0.03)
    assert bad


def test_frames_come_twice() -> None:
    vehicle = Vehicle(impairment=Impairment(duplication=0.2))
    station = Station(vehicle)
    station.step(30)
    assert len(station.messages) / vehicle.frames_sent == pytest.approx(1.2, abs=0.03)


def test_delay_holds_both_directions() -> None:
    vehicle = Vehicle(impairment=Impairment(delay=0.3))
    station = Station(vehicle)
    station.step(5)
    began = vehicle.time
    station.messages.clear()
    station.send(mavlink.MAVLink_param_request_read_message(1, 1, b"RTL_ALT", -1))
    station.until(lambda: station.of("PARAM_VALUE"), dt=0.01)
    assert vehicle.time - began == pytest.approx(0.6, abs=0.03)


def test_jitter_changes_the_order() -> None:
    vehicle = Vehicle(impairment=Impairment(jitter=0.5))
    station = Station(vehicle)
    station.step(20)
    seqs = [msg.get_seq() for msg in station.messages]
    assert any((b - a) & 255 > 128 for a, b in pairwise(seqs))


def test_a_bad_link_is_as_deterministic_as_a_good_one() -> None:
    impairment = Impairment(0.1, 0.1, 0.1, 0.1, 0.1)
    a, b = (Vehicle(seed=5, impairment=impairment) for _ in range(2))
    assert a.step(20) == b.step(20) != Vehicle(seed=6, impairment=impairment).step(20)


def test_parameters_arrive_in_the_end_over_a_bad_link() -> None:
    """A ground station that asks again for what is missing gets them all."""
    vehicle = Vehicle(impairment=Impairment(loss=0.3, corruption=0.05))
    station = Station(vehicle)
    station.send(mavlink.MAVLink_param_request_list_message(1, 1), dt=5)
    for _ in range(200):
        have = {msg.param_index for msg in station.of("PARAM_VALUE")}
        missing = sorted(set(range(len(vehicle.params))) - have)
        if not missing:
            return
        for index in missing:
            station.send(mavlink.MAVLink_param_request_read_message(1, 1, b"", index), dt=0.01)
    raise AssertionError(f"still missing {missing}")


def test_a_mission_arrives_over_a_bad_link() -> None:
    from unit.sim_tools import mission_item

    vehicle = Vehicle("px4", impairment=Impairment(loss=0.3, delay=0.05))
    station = Station(vehicle)
    items = [mission_item(n, mavlink.MAV_CMD_NAV_WAYPOINT, z=n) for n in range(12)]
    seen = 0
    while not len(vehicle.mission):
        if not station.of("MISSION_REQUEST_INT"):
            station.send(mavlink.MAVLink_mission_count_message(1, 1, 12, 0))
        station.step(0.5)
        for request in station.of("MISSION_REQUEST_INT")[seen:]:
            seen += 1
            station.send(items[request.seq], dt=0.1)
        assert vehicle.time < 300
    assert [item.z for item in vehicle.mission.items] == list(range(12))


@pytest.mark.parametrize(
    ("options", "named"),
    [({"loss": 1.5}, "loss"), ({"corruption": -0.1}, "corruption"), ({"delay": -1}, "delay")],
)
def test_wrong_values_are_named(options: dict[str, float], named: str) -> None:
    with pytest.raises(ValueError, match=named):
        Impairment(**options)


def test_what_nobody_takes_is_bounded() -> None:
    channel: Channel[bytes] = Channel(Impairment(delay=10), Random(0), flip_bit)
    for _ in range(MAX_WAITING + 50):
        channel.put(b"x", 0.0)
    assert len(channel.take(20)) == MAX_WAITING
    assert channel.counters.passed == MAX_WAITING


@pytest.mark.parametrize("name", ["delay", "jitter"])
@pytest.mark.parametrize("value", [-1.0, 3600.0, float("nan")])
def test_times_that_are_refused_are_named(name: str, value: float) -> None:
    reason = f"{name} must be at least 0 and less than an hour: {value} s"
    with pytest.raises(ValueError, match=reason):
        Impairment(**{name: value})
