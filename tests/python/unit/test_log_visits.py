"""The index of a log, and the loop of the tools over it: the messages that `recv_match` gives, no others."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from differential.damage import damaged
from mavwire import mavutil, traffic
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import T0, heartbeat, pack, record

pytestmark = pytest.mark.usefixtures("mavlink20")

TYPES = (["PARAM_VALUE"], ["GPS_RAW_INT", "HEARTBEAT"], ["STATUSTEXT", "SYS_STATUS"], ["NO_SUCH"])
SEEDS = 60


def told(messages):
    return [(msg.get_type(), msg._timestamp, bytes(msg.get_msgbuf())) for msg in messages]


def attitude(number: int) -> bytes:
    return record(pack(mavlink.MAVLink_attitude_message(number, 0, 0, 0, 0, 0, 0)), T0 + number)


@pytest.fixture(scope="module")
def flight(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("visits") / "flight.tlog"
    traffic.generate(path, 600)
    return path.read_bytes()


@pytest.mark.parametrize("types", TYPES, ids="+".join)
def test_visits_are_what_recv_match_gives(types: list[str], flight: bytes, tmp_path: Path) -> None:
    """In logs of every damage, too."""
    path = tmp_path / "flight.tlog"
    for seed in range(SEEDS):
        path.write_bytes(damaged(flight, Random(seed)) if seed else flight)
        with mavutil.mavlink_connection(str(path)) as log:
            by_visits = told(log._visits(types))
        with mavutil.mavlink_connection(str(path)) as log:
            assert told(iter(lambda: log.recv_match(type=types), None)) == by_visits, seed


def test_visits_of_a_log_without_index(flight: bytes, tmp_path: Path) -> None:
    (tmp_path / "flight.tlog").write_bytes(flight)
    with mavutil.mavlogfile(str(tmp_path / "flight.tlog")) as log:
        assert log._visits(["HEARTBEAT"]) is None


def test_visits_of_a_log_whose_messages_a_program_looks_at(flight: bytes, tmp_path: Path) -> None:
    class Own(mavutil.mavmmaplog):
        def recv_msg(self):
            return super().recv_msg()

    (tmp_path / "flight.tlog").write_bytes(flight)
    with Own(str(tmp_path / "flight.tlog")) as log:
        assert log._visits(["HEARTBEAT"]) is None


@pytest.mark.parametrize("gap", [0, 1000, 0xFFFF, 0x10000, 200_000])
def test_the_index_over_gaps_of_any_length(gap: int, tmp_path: Path) -> None:
    pieces = [record(heartbeat()), attitude(1), attitude(2), bytes(gap), attitude(3), attitude(4)]
    path = tmp_path / "gap.tlog"
    path.write_bytes(b"".join(pieces))
    with mavutil.mavlink_connection(str(path)) as log:
        first = len(pieces[0])
        second = first + len(pieces[1])
        third = second + len(pieces[2]) + gap
        assert log.offsets == {0: [0], 30: [first, second, third, third + len(pieces[4])]}
        assert log.counts == {0: 1, 30: 4}
        numbers = [msg.time_boot_ms for msg in iter(lambda: log.recv_match(type="ATTITUDE"), None)]
    assert numbers == [1, 2, 3, 4]


def test_a_log_that_nobody_mapped_shows_a_closed_map(flight: bytes, tmp_path: Path) -> None:
    (tmp_path / "flight.tlog").write_bytes(flight)
    for is_asked in (True, False):
        log = mavutil.mavlink_connection(str(tmp_path / "flight.tlog"))
        if is_asked:
            assert log.data_map[:8] == flight[:8]
        log.close()
        assert log.data_map.closed
