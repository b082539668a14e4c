"""No checksum covers the signature of a frame. Where bytes of one are lost, the records behind it are
all there, whatever reads the log, and the signed frame is not: it is not whole.
"""

from __future__ import annotations

import mavwire
import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import T0, drain, heartbeat, record, signed

COUNT = 40
SIGNATURE = 13

pytestmark = pytest.mark.usefixtures("mavlink20")


def beat(seq: int) -> bytes:
    """A HEARTBEAT, signed but for one here and there."""
    message = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    return heartbeat(seq) if seq % 7 == 3 else signed(message, timestamp=1 + seq, seq=seq)


def damaged(lost: int, stamped: bool) -> tuple[bytes, list[int]]:
    """A log in which every fifth signature lost so many bytes, and what numbers are left."""
    log, left = b"", []
    for seq, frame in enumerate(map(beat, range(COUNT))):
        is_damaged = seq % 5 == 0 and seq % 7 != 3
        cut = len(frame) - SIGNATURE + seq % (SIGNATURE - lost + 1)
        kept = frame[:cut] + frame[cut + lost :] if is_damaged else frame
        left += [] if is_damaged else [seq]
        log += record(kept, T0 + seq) if stamped else kept
    return log, left


def numbers(messages) -> list[int]:
    return [msg.get_seq() for msg in messages if msg.get_type() == "HEARTBEAT"]


@pytest.mark.parametrize("stamped", [True, False], ids=["log", "raw"])
@pytest.mark.parametrize("lost", range(1, SIGNATURE + 1))
def test_what_follows_a_damaged_signature_is_there(tmp_path, lost, stamped):
    log, left = damaged(lost, stamped)
    path = tmp_path / ("flight.tlog" if stamped else "flight.raw")
    path.write_bytes(log)
    table = mavwire.read(path)["HEARTBEAT"]
    assert table.to_numpy()["seq"].tolist() == left
    with mavwire.open_log(path) as opened:
        assert numbers(opened) == left
        info = opened.info()
        assert info.messages == len(left)
        good = sum(len(beat(seq)) + (8 if stamped else 0) for seq in left)
        assert info.bad_bytes == len(log) - good
    if stamped:
        times = table.to_numpy()["timestamp"].astype("int64").tolist()
        assert times == [T0 + seq for seq in left]
        for options in ({}, {"append": True}):
            with mavutil.mavlink_connection(str(path), resync="rescan", **options) as link:
                assert numbers(drain(link)) == left


def test_the_last_record_of_a_growing_log_does_not_wait_for_the_next(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"")
    with mavutil.mavlink_connection(str(path), append=True, resync="rescan") as link:
        for seq in range(3):
            with path.open("ab") as file:
                file.write(record(beat(seq), T0 + seq))
            assert numbers(drain(link)) == [seq]
