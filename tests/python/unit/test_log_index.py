"""The index of a log."""

from __future__ import annotations

from pathlib import Path

import pytest
from mavwire import mavutil, traffic
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import T0, heartbeat, pack, record

pytestmark = pytest.mark.usefixtures("mavlink20")


def attitude(number: int) -> bytes:
    return record(pack(mavlink.MAVLink_attitude_message(number, 0, 0, 0, 0, 0, 0)), T0 + number)


@pytest.fixture(scope="module")
def flight(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("index") / "flight.tlog"
    traffic.generate(path, 600)
    return path.read_bytes()


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
