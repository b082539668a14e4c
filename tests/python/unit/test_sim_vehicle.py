"""The simulated vehicle as a protocol: determinism, time, identity, texts, signing."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Swarm, Vehicle
from unit.sim_tools import GCS, Station, flying, ready

KEY = bytes(range(32))
AUTOPILOTS = ["ardupilot", "px4"]


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_the_seed_decides_every_byte(autopilot: str) -> None:
    a, b, c = (Vehicle(autopilot, seed=seed) for seed in (1, 1, 2))
    first = a.step(30)
    assert first == b.step(30)
    assert first != c.step(30)


def test_how_time_is_cut_makes_no_difference() -> None:
    whole, pieces = Vehicle(seed=3), Vehicle(seed=3)
    expected = whole.step(12)
    assert b"".join(pieces.step(0.0037) for _ in range(3243)) + pieces.step(0.0009) == expected


@pytest.mark.parametrize("dt", [-1, 1e9, float("nan")])
def test_time_goes_forward_in_sensible_steps(dt: float) -> None:
    with pytest.raises(ValueError, match="dt must be"):
        Vehicle().step(dt)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"autopilot": "paparazzi"}, "ardupilot, px4"),
        ({"sysid": 0}, "sysid"),
        ({"version": 3}, "version"),
        ({"signing_key": b"short"}, "32 bytes"),
        ({"params": {"RTL_ALT": float("nan")}}, "RTL_ALT"),
        ({"home": "x"}, "home must be latitude, longitude and metres above sea level: 'x'"),
        ({"home": (1, 2)}, "home must be"),
        ({"home": "123"}, "home must be"),
        ({"home": b"123"}, "home must be"),
        ({"home": 0}, "home must be"),
        ({"home": ()}, "home must be"),
        ({"home": (1, 2, "high")}, "home must be"),
    ],
)
def test_wrong_options_are_named(options: dict[str, object], named: str) -> None:
    with pytest.raises(ValueError, match=named):
        Vehicle(**options)  # type: ignore[arg-type]


def test_an_impairment_that_is_none_is_named() -> None:
    with pytest.raises(TypeError, match="impairment must be an Impairment: 5"):
        Vehicle(impairment=5)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("autopilot", "mode", "base", "custom", "names"),
    [
        ("ardupilot", "STABILIZE", 81, 0, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA),
        ("px4", "LOITER", 29, 0x03040000, mavlink.MAV_AUTOPILOT_PX4),
    ],
)
def test_heartbeats_are_those_of_the_autopilot(
    autopilot: str, mode: str, base: int, custom: int, names: int
) -> None:
    vehicle = Vehicle(autopilot, sysid=7)
    station = Station(vehicle)
    station.step(10)
    beats = station.of("HEARTBEAT")
    assert len(beats) == 10
    beat = beats[0]
    assert (beat.get_srcSystem(), beat.get_srcComponent()) == (7, 1)
    assert (beat.autopilot, beat.base_mode, beat.custom_mode) == (names, base, custom)
    assert beat.system_status == mavlink.MAV_STATE_STANDBY
    assert mavutil.mode_string_v10(beat) == vehicle.mode == mode


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_every_mode_has_the_name_that_mavutil_knows(autopilot: str) -> None:
    vehicle = Vehicle(autopilot)
    for mode in vehicle.personality.modes.values():
        if mode.selectable:
            beat = mavlink.MAVLink_heartbeat_message(
                2, vehicle.personality.autopilot, mode.flags, mode.custom_mode, 3, 3
            )
            assert mavutil.mode_string_v10(beat) == mode.name


def test_frames_are_numbered_without_gaps() -> None:
    station = Station(Vehicle())
    station.step(20)
    seqs = [msg.get_seq() for msg in station.messages]
    assert len(seqs) > 1000
    assert all((b - a) & 255 == 1 for a, b in pairwise(seqs))


def test_until_next_says_when_the_next_frame_comes() -> None:
    vehicle = Vehicle()
    for _ in range(200):
        wait = vehicle.until_next
        if wait > 0.01:
            assert vehicle.step(wait - 0.01) == b""
            assert vehicle.step(0.01) != b""
        else:
            vehicle.step(0.01)


def test_long_texts_come_in_chunks() -> None:
    vehicle = Vehicle()
    station = Station(vehicle)
    long = "0123456789" * 12
    for text in ("short", "x" * 50, long, long[:100]):
        vehicle.text(mavlink.MAV_SEVERITY_INFO, text)
    chunks = station.step(0)
    assert [(c.id, c.chunk_seq, len(c.text)) for c in chunks] == [
        (0, 0, 5), (0, 0, 50), (1, 0, 50), (1, 1, 50), (1, 2, 20), (2, 0, 50), (2, 1, 50), (2, 2, 0),
    ]  # fmt: skip
    assert "".join(c.text for c in chunks[2:5]) == long


def test_mavlink_1_goes_without_what_it_cannot_carry() -> None:
    vehicle = Vehicle("px4", version=1)
    frames = []
    for _ in range(500):
        vehicle.advance(0.01)
        frames += vehicle.take()
    assert frames
    assert {frame[0] for frame in frames} == {0xFE}
    assert vehicle.streams.rate("CURRENT_MODE") > 0


def test_timesync_and_ping_are_echoed() -> None:
    vehicle, station = ready("px4")
    (answer,) = station.send(mavlink.MAVLink_timesync_message(0, 123456789))
    assert (answer.tc1, answer.ts1) == (vehicle.time_us * 1000, 123456789)
    (pong,) = station.send(mavlink.MAVLink_ping_message(55, 9, 0, 0))
    assert (pong.time_usec, pong.seq, pong.target_system, pong.target_component) == (55, 9, *GCS)


def test_reboot_forgets_time_and_mission_but_not_parameters() -> None:
    vehicle, station = ready("ardupilot")
    vehicle.params["WPNAV_SPEED"] = 321
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == 0
    assert not vehicle.autopilot.position_ok
    station.step(1)
    assert station.last("ATTITUDE").time_boot_ms <= 1000
    assert vehicle.params["WPNAV_SPEED"] == 321
    station.step(5)
    assert vehicle.autopilot.position_ok


def test_nobody_reboots_in_the_air() -> None:
    vehicle, station = flying("px4")
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) != 0
    assert vehicle.armed


# -- signing


def test_with_a_key_it_signs_and_wants_signatures() -> None:
    vehicle = Vehicle(signing_key=KEY)
    signed, unsigned = Station(vehicle, KEY), Station(vehicle)
    signed.step(3)
    assert len(signed.messages) > 100
    assert all(msg.get_signed() for msg in signed.messages)
    request = mavlink.MAVLink_param_request_read_message(1, 1, b"RTL_ALT", -1)
    assert unsigned.send(request) == []
    (answer,) = signed.send(request)
    assert (answer.get_type(), answer.get_signed()) == ("PARAM_VALUE", True)


def test_signatures_follow_the_clock() -> None:
    vehicle = Vehicle(signing_key=KEY)
    station = Station(vehicle, KEY)
    station.step(60)
    stamps = [int.from_bytes(msg.get_msgbuf()[-12:-6], "little") for msg in station.messages]
    assert all(b > a for a, b in pairwise(stamps))
    assert stamps[-1] - stamps[0] == pytest.approx(60 * 100_000, rel=0.05)


def test_setup_signing_hands_over_a_key_and_zeros_take_it_back() -> None:
    vehicle = Vehicle()
    station = Station(vehicle)
    setup = mavlink.MAVLink_setup_signing_message(1, 1, list(KEY), 0)
    broadcast = mavlink.MAVLink_setup_signing_message(0, 0, list(KEY), 0)
    station.send(broadcast)
    assert vehicle.signing.key is None
    station.send(setup)
    assert vehicle.signing.key == KEY
    keyed = Station(vehicle, KEY)
    keyed.step(1)
    assert all(msg.get_signed() for msg in keyed.messages)
    keyed.send(mavlink.MAVLink_setup_signing_message(1, 1, [0] * 32, 0))
    assert vehicle.signing.key is None


def test_a_start_in_the_far_future_is_not_taken() -> None:
    vehicle = Vehicle()
    Station(vehicle).send(mavlink.MAVLink_setup_signing_message(1, 1, list(KEY), 2**48 - 2))
    keyed = Station(vehicle, KEY)
    assert keyed.step(2)


# -- several vehicles


def test_a_swarm_answers_one_by_one() -> None:
    swarm = Swarm([Vehicle(sysid=1), Vehicle("px4", sysid=2), Vehicle(sysid=3)])
    station = Station(swarm)
    station.step(2)
    assert {msg.get_srcSystem() for msg in station.messages} == {1, 2, 3}
    assert station.command(mavlink.MAV_CMD_REQUEST_MESSAGE, 148, target=2) == 0
    version = station.last("AUTOPILOT_VERSION")
    assert version.get_srcSystem() == 2
    everyone = mavlink.MAVLink_command_long_message(0, 0, 512, 0, 148, 0, 0, 0, 0, 0, 0)
    answers = station.send(everyone)
    assert {m.get_srcSystem() for m in answers if m.get_type() == "COMMAND_ACK"} == {1, 2, 3}


@pytest.mark.parametrize("ids", [[], [1, 1]])
def test_a_swarm_needs_different_ids(ids: list[int]) -> None:
    with pytest.raises(ValueError, match="different system ids"):
        Swarm([Vehicle(sysid=number) for number in ids])


def answers_of(swarm: Swarm, sysid: int, key: bytes | None = None) -> list[Any]:
    """What the vehicles answer to a station that asks one of them for a parameter."""
    request = mavlink.MAVLink_param_request_read_message(sysid, 1, b"RTL_ALT", -1)
    reader = Station(swarm)
    reader.step(0.0, Station(swarm, key).frame(request))
    return reader.of("PARAM_VALUE")


@pytest.mark.parametrize("keyed", [1, 2])
def test_each_vehicle_of_a_swarm_has_a_key_of_its_own(keyed: int) -> None:
    swarm = Swarm([Vehicle(sysid=1), Vehicle(sysid=2)])
    other = 3 - keyed
    assert swarm.key is None
    Station(swarm).send(mavlink.MAVLink_setup_signing_message(keyed, 1, list(KEY), 0))
    assert (swarm.keys, swarm.key) == ({None, KEY}, None)
    assert [msg.get_srcSystem() for msg in answers_of(swarm, other)] == [other]
    assert answers_of(swarm, keyed) == []
    assert [msg.get_srcSystem() for msg in answers_of(swarm, keyed, KEY)] == [keyed]
    assert answers_of(swarm, keyed, bytes(32)) == []
    Station(swarm).send(mavlink.MAVLink_setup_signing_message(other, 1, list(KEY), 0))
    assert swarm.key == KEY
    assert answers_of(swarm, other) == []
