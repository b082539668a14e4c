"""What does not fit a signature block is refused before anything is sent or counted."""

from __future__ import annotations

import io
import logging
import time

import pytest
from encoder import attitude, signed
from mavwire.dialects.v20 import common as mavlink
from mavwire.links.signing import EPOCH, UNITS_PER_SECOND, signing_timestamp
from unit.link_tools import KEY, Capture, drain, types

MINUTE = 60 * UNITS_PER_SECOND
DAY = 24 * 60 * MINUTE
STREAMS = 1024
"""Places in the table of a link."""


def attitude_at(timestamp: int, link_id: int = 3, sysid: int = 1, compid: int = 1) -> bytes:
    payload = attitude(1, 0, 0, 0, 0, 0, 1)
    return signed(30, payload, KEY, timestamp, link_id, sysid=sysid, compid=compid)


def taken(link: Capture, data: bytes) -> list[str]:
    link.rx += data
    return [name for name in types(drain(link)) if name != "BAD_DATA"]


def now() -> int:
    return signing_timestamp(time.time())


def test_new_streams_are_measured_by_the_clock() -> None:
    """R40."""
    link = Capture()
    link.setup_signing(KEY)
    early = now() - MINUTE - 1
    assert taken(link, attitude_at(early)) == []
    first = now() - MINUTE // 2
    assert taken(link, attitude_at(first)) == ["ATTITUDE"]
    # A stream that is known may be as late as it likes.
    assert taken(link, attitude_at(first + 1)) == ["ATTITUDE"]


def test_a_link_that_never_sends_takes_no_old_stream_either(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """R40: what was recorded while it listened to nobody is a replay."""
    link = Capture()
    with monkeypatch.context() as patch:
        patch.setattr(time, "time", lambda: EPOCH + 1)  # it was set up years ago
        link.setup_signing(KEY)
    start = link.mav.signing.timestamp
    assert taken(link, attitude_at(start + MINUTE)) == []
    assert link.mav.signing.timestamp == start
    assert link.mav.signing.stream_timestamps == {}
    assert taken(link, attitude_at(now())) == ["ATTITUDE"]


def test_without_a_clock_new_streams_are_measured_by_the_initial_timestamp() -> None:
    """R40, as pymavlink."""
    link = Capture()
    link.setup_signing(KEY, initial_timestamp=MINUTE + 1000)
    assert taken(link, attitude_at(999)) == []
    assert taken(link, attitude_at(1000)) == ["ATTITUDE"]


def test_a_signature_far_ahead_of_the_clock_can_be_refused(
    caplog: pytest.LogCaptureFixture,
) -> None:
    """R52."""
    link = Capture()
    link.setup_signing(KEY, max_ahead=0.5 * MINUTE / UNITS_PER_SECOND)
    before = link.mav.signing.timestamp
    with caplog.at_level(logging.INFO):
        assert taken(link, attitude_at(now() + 10 * MINUTE)) == []
    assert "timestamp too far ahead" in caplog.text
    assert link.mav.signing.badsig_count == 1
    assert (link.mav.signing.timestamp, link.mav.signing.stream_timestamps) == (before, {})
    assert taken(link, attitude_at(now() + MINUTE // 4)) == ["ATTITUDE"]
    link.setup_signing(KEY)  # no limit
    assert taken(link, attitude_at(now() + 10 * MINUTE)) == ["ATTITUDE"]
    link.setup_signing(KEY, max_ahead=0)
    assert taken(link, attitude_at(now() + 20 * MINUTE)) == []


def test_a_clock_days_ahead_shuts_out_nobody() -> None:
    """R40: one good signature of a wrong clock is not the measure of all that come after it."""
    link, other = Capture(), Capture()
    for one in (link, other):
        one.setup_signing(KEY)
    assert taken(link, attitude_at(now() + 5 * DAY, link_id=9)) == ["ATTITUDE"]
    for one, sysid in ((link, 2), (other, 3)):
        assert taken(one, attitude_at(now(), sysid=sysid)) == ["ATTITUDE"]
    assert taken(link, attitude_at(now() - 2 * MINUTE, sysid=4)) == []


def test_more_streams_than_there_is_room_for() -> None:
    """R55: the longest silent stream is replaced, and none of its frames is accepted again. Forged ones add none."""
    link = Capture()
    link.setup_signing(KEY, initial_timestamp=0)
    systems = [(1 + n // 250, 1 + n % 250) for n in range(STREAMS)]
    for n, (sysid, compid) in enumerate(systems):
        assert taken(link, attitude_at(1000 + n, sysid=sysid, compid=compid)) == ["ATTITUDE"]
    full = link.mav.signing.stream_timestamps
    assert len(full) == STREAMS
    payload = attitude(1, 0, 0, 0, 0, 0, 1)
    assert taken(link, signed(30, payload, b"x" * 32, 5000, 3, sysid=99)) == []
    assert link.mav.signing.stream_timestamps == full
    assert taken(link, attitude_at(5000, sysid=1, compid=1)) == ["ATTITUDE"]
    assert taken(link, attitude_at(5001, sysid=200)) == ["ATTITUDE"]
    known = link.mav.signing.stream_timestamps
    assert set(full) - set(known) == {(3, 1, 2)}
    assert set(known) - set(full) == {(3, 200, 1)}
    assert taken(link, attitude_at(1001, sysid=1, compid=2)) == []
    assert taken(link, attitude_at(5002, sysid=1, compid=2)) == ["ATTITUDE"]
    # An assignment forgets no floor.
    link.mav.signing.stream_timestamps = {}
    assert taken(link, attitude_at(1001, sysid=1, compid=2)) == []
    with pytest.raises(ValueError, match="^stream_timestamps holds 1024 streams, not 1025$"):
        link.mav.signing.stream_timestamps = {(n % 256, n // 256, 1): 1 for n in range(1025)}


@pytest.mark.parametrize(
    ("name", "value"), [("timestamp", 1 << 48), ("timestamp", -1), ("link_id", 256)]
)
def test_values_that_do_not_fit_are_refused(name: str, value: int) -> None:
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    mav.signing.secret_key = b"k" * 32
    mav.signing.sign_outgoing = True
    mav.signing.timestamp = 1000
    mav.heartbeat_send(1, 2, 3, 4, 5)
    sent = file.getvalue()
    with pytest.raises(OverflowError):
        setattr(mav.signing, name, value)
        mav.heartbeat_send(1, 2, 3, 4, 5)
    assert file.getvalue() == sent
    assert (mav.seq, mav.total_packets_sent) == (1, 1)


def test_the_largest_timestamp_is_sent() -> None:
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    mav.signing.secret_key = b"k" * 32
    mav.signing.sign_outgoing = True
    mav.signing.timestamp = (1 << 48) - 1
    mav.heartbeat_send(1, 2, 3, 4, 5)
    assert file.getvalue()[-12:-6] == b"\xff" * 6
