"""`resync="rescan"`: how many good frames come out of damaged streams and logs, beside pymavlink.

The default, `"skip"`, loses what pymavlink loses; the figures asserted for it are the same for
both packages wherever pymavlink is installed.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import T0, drain, heartbeat, pack, record

STRAY = b"\xfd"
FALSE_HEADER = b"\xfd\xff\x01"


pytestmark = pytest.mark.usefixtures("mavlink20")


def telemetry(count: int, rand: Random) -> list[bytes]:
    """Frames of everyday messages."""
    frames = []
    for seq in range(count):
        values = [rand.gauss(0, 1) for _ in range(6)]
        time = 40 * seq
        msg = (
            mavlink.MAVLink_attitude_message(time, *values),
            mavlink.MAVLink_vfr_hud_message(values[0], values[1], seq % 360, 50, *values[2:4]),
            mavlink.MAVLink_raw_imu_message(time * 1000, *(rand.randrange(9999) for _ in range(9))),
            mavlink.MAVLink_sys_status_message(1, 2, 3, 400, 12600, 900, 50, 0, 0, 0, 0, 0, 0),
        )[seq % 4]
        frames.append(pack(msg, seq % 256))
    return frames


def lose_bytes(parts: list[bytes], rand: Random) -> tuple[bytes, list[bytes]]:
    """All parts with 1% of their bytes lost, and the parts that lost none."""
    kept, intact = [], []
    for part in parts:
        left = bytes(byte for byte in part if rand.random() >= 0.01)
        kept.append(left)
        if len(left) == len(part):
            intact.append(part)
    return b"".join(kept), intact


def good(messages: list[Any] | None) -> list[bytes]:
    """Frames of the messages that are no BAD_DATA and no UNKNOWN."""
    return [bytes(m.get_msgbuf()) for m in messages or [] if m.get_msgId() >= 0]


def parse(stream: bytes, resync: str, chunk: int = 1000) -> list[Any]:
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    mav.resync = resync
    messages = []
    for start in range(0, len(stream), chunk):
        messages += mav.parse_buffer(stream[start : start + chunk]) or []
    return messages


def strict_frames(stream: bytes, resync: str, chunk: int) -> list[bytes]:
    """Frames of the good messages of a parser that raises instead of giving BAD_DATA."""
    mav = mavlink.MAVLink(None)
    mav.resync = resync
    found = []
    for start in range(0, len(stream), chunk):
        data, before = stream[start : start + chunk], -1
        while mav.buf_len() + len(data) != before:
            before = mav.buf_len() + len(data)
            try:
                message = mav.parse_char(data)
            except mavlink.MAVError:
                message = None
            data = b""
            found += good([message] if message is not None else None)
    return found


def reference(stream: bytes) -> list[Any] | None:
    """What pymavlink parses; None where it is not installed."""
    if importlib.util.find_spec("pymavlink") is None:
        return None
    from pymavlink.dialects.v20 import all as pymavlink

    mav = pymavlink.MAVLink(None)
    mav.robust_parsing = True
    messages: list[Any] = mav.parse_buffer(bytearray(stream)) or []
    return messages


def damaged_streams() -> dict[str, tuple[bytes, int]]:
    """Name -> (stream, number of intact frames in it)."""
    beats = [heartbeat(seq % 256) for seq in range(1000)]
    lossy, intact = lose_bytes(telemetry(20_000, Random(1)), Random(2))
    return {
        "stray": (STRAY + b"".join(beats[:100]), 100),
        "false headers": (b"".join(FALSE_HEADER + beat for beat in beats), 1000),
        "byte loss": (lossy, len(intact)),
    }


STREAMS = damaged_streams()
# What may be lost at most under "rescan", and what "skip" loses at least.
LOST = {"stray": (1, 10), "false headers": (15, 1000), "byte loss": (5, 1000)}


@pytest.mark.parametrize("name", STREAMS)
def test_good_frames_of_damaged_streams(name):
    stream, intact = STREAMS[name]
    rescan, skip = len(good(parse(stream, "rescan"))), len(good(parse(stream, "skip")))
    theirs = reference(stream)
    print(f"{name}: {intact} intact, {rescan} by rescan, {skip} by skip")
    assert intact - LOST[name][0] <= rescan <= intact
    assert skip <= intact - LOST[name][1]
    assert theirs is None or skip == len(good(theirs))


@pytest.mark.parametrize("name", STREAMS)
def test_rescan_in_any_chunking(name):
    stream = STREAMS[name][0][:30_000]
    expected = good(parse(stream, "rescan"))
    for chunk in (1, 7, 280, 4096, len(stream)):
        messages = parse(stream, "rescan", chunk)
        assert good(messages) == expected, chunk
        everything = b"".join(bytes(m.get_msgbuf()) for m in messages)
        assert stream.startswith(everything), chunk


def damaged_in_many_ways(rand: Random) -> bytes:
    """Frames, some of them with a flipped bit, and noise with markers in it."""
    parts = []
    for frame in telemetry(25, rand):
        if rand.random() < 0.2:
            parts.append(bytes(rand.choices(b"\xfe\xfd\x00\x01\xff", k=rand.randrange(1, 40))))
        damaged = bytearray(frame)
        if rand.random() < 0.2:
            damaged[rand.randrange(len(frame))] ^= 1 << rand.randrange(8)
        parts.append(bytes(damaged))
    return b"".join(parts)


@pytest.mark.parametrize("resync", ["skip", "rescan"])
def test_a_strict_parser_finds_the_same_frames(resync):
    for seed in range(100):
        stream = damaged_in_many_ways(Random(seed))
        for chunk in (7, 280, len(stream)):
            expected = good(parse(stream, resync, chunk))
            assert strict_frames(stream, resync, chunk) == expected, (seed, chunk)


def test_switching_between_strict_and_robust_within_noise():
    """What is left of the noise comes out whole, and the frame behind it."""
    mav = mavlink.MAVLink(None)
    mav.resync = "rescan"
    with pytest.raises(mavlink.MAVError, match="invalid MAVLink prefix '1'"):
        mav.parse_char(b"\x01\x02\x03\x04" + heartbeat(5))
    assert mav.parse_char(b"") is None
    mav.robust_parsing = True
    noise, beat = mav.parse_buffer(b"")
    assert (bytes(noise.get_msgbuf()), beat.get_seq()) == (b"\x03\x04", 5)


def stamped(frames: list[bytes]) -> list[bytes]:
    """Log records, a millisecond apart."""
    return [record(frame, T0 + 1000 * n) for n, frame in enumerate(frames)]


def damaged_logs() -> dict[str, tuple[bytes, list[bytes]]]:
    """Name -> (log, records that are intact in it)."""
    beats = stamped([heartbeat(seq % 256) for seq in range(1000)])
    lossy, intact = lose_bytes(stamped(telemetry(20_000, Random(3))), Random(4))
    return {
        "stray": (beats[0] + STRAY + b"".join(beats[1:100]), beats[:100]),
        "false headers": (b"".join(FALSE_HEADER + beat for beat in beats), beats),
        "byte loss": (lossy, intact),
    }


LOGS = damaged_logs()
OPENED: dict[str, Callable[[str], Any]] = {
    "indexed": lambda path: mavutil.mavlink_connection(path, resync="rescan"),
    "stream": lambda path: mavutil.mavlink_connection(path, append=True, resync="rescan"),
}


def as_records(messages: list[Any]) -> list[bytes]:
    """The records that good messages came from."""
    return [
        record(bytes(m.get_msgbuf()), round(m._timestamp * 1e6))
        for m in messages
        if m.get_msgId() >= 0
    ]


@pytest.mark.parametrize("opened", OPENED)
@pytest.mark.parametrize("name", LOGS)
def test_intact_records_of_damaged_logs(tmp_path: Path, name, opened):
    data, intact = LOGS[name]
    path = tmp_path / "damaged.tlog"
    path.write_bytes(data)
    with OPENED[opened](str(path)) as log:
        messages = drain(log)
        found = set(as_records(messages))
        lost = [rec for rec in intact if rec not in found]
        with mavutil.mavlink_connection(str(path), append=True) as other:
            skip = set(as_records(drain(other)))
        print(f"{name}: {len(intact)} intact, {len(lost)} lost, {len(skip)} by skip")
        assert len(lost) <= 5
        assert len(skip) < len(found)
        assert len(found) - len(intact) <= len(intact) // 10


def test_what_lies_between_is_bad_data(tmp_path: Path):
    path = tmp_path / "damaged.tlog"
    first, second, third = stamped([heartbeat(0), heartbeat(1), heartbeat(2)])
    path.write_bytes(first + b"some text" + second + FALSE_HEADER + third)
    for opened in OPENED.values():
        with opened(str(path)) as log:
            messages = drain(log)
            assert [m.get_type() for m in messages] == [
                "HEARTBEAT", "BAD_DATA", "HEARTBEAT", "BAD_DATA", "HEARTBEAT",
            ]  # fmt: skip
            assert [bytes(m.get_msgbuf()) for m in messages[1::2]] == [b"some text", FALSE_HEADER]
            times = [round(m._timestamp * 1e6) - T0 for m in messages]
            assert times[::2] == [0, 1000, 2000]
            assert log.mav.total_receive_errors >= 2


def test_the_index_leads_to_every_good_record(tmp_path: Path):
    data, intact = LOGS["byte loss"]
    path = tmp_path / "damaged.tlog"
    path.write_bytes(data)
    wanted = [rec for rec in intact if rec[8 + 7] == mavlink.MAVLINK_MSG_ID_ATTITUDE]
    with OPENED["indexed"](str(path)) as log:
        found = drain(log, type="ATTITUDE")
        assert len(set(wanted) - set(as_records(found))) <= 5
        assert log.counts[30] == len(found)
        log.rewind()
        assert len(drain(log, type={"ATTITUDE"})) == len(found)


@pytest.mark.parametrize("options", [{}, {"append": True}], ids=["indexed", "stream"])
def test_switching_the_policy_while_reading(tmp_path: Path, options):
    path = tmp_path / "damaged.tlog"
    records = stamped([heartbeat(seq) for seq in range(60)])
    path.write_bytes(b"".join(records[:20]) + STRAY + b"".join(records[20:]))
    with mavutil.mavlink_connection(str(path), **options) as log:
        for _ in range(5):
            log.recv_msg()
        log.mav.resync = "rescan"
        assert [m.get_seq() for m in drain(log) if m.get_msgId() == 0] == list(range(5, 60))


def test_an_intact_log_is_the_same_under_both_policies(tmp_path: Path):
    path = tmp_path / "good.tlog"
    path.write_bytes(b"".join(stamped(telemetry(2000, Random(5)))))
    with OPENED["indexed"](str(path)) as one, mavutil.mavlink_connection(str(path)) as other:
        assert (one.counts, one.offsets, one.messages.keys()) == (
            other.counts, other.offsets, other.messages.keys(),
        )  # fmt: skip
        ours, theirs = drain(one), drain(other)
        assert [str(m) for m in ours] == [str(m) for m in theirs]
        assert [m._timestamp for m in ours] == [m._timestamp for m in theirs]


def test_a_stray_marker_near_the_end_of_a_raw_stream(tmp_path: Path):
    beats = [heartbeat(seq) for seq in range(25)]
    path = tmp_path / "stream.raw"
    path.write_bytes(b"".join(beats[:20]) + STRAY + b"".join(beats[20:]) + b"\xfd\x09")
    with mavutil.mavlink_connection(str(path), notimestamps=True, resync="rescan") as log:
        assert [m.get_seq() for m in drain(log) if m.get_msgId() == 0] == list(range(25))


def test_a_growing_log_is_followed(tmp_path: Path):
    path = tmp_path / "live.tlog"
    path.touch()
    data = b"".join(stamped([heartbeat(seq) for seq in range(8)]))
    data = data[:40] + FALSE_HEADER + data[40:]
    with OPENED["stream"](str(path)) as log, open(path, "ab", buffering=0) as writer:
        seen = []
        for start in range(0, len(data), 5):
            writer.write(data[start : start + 5])
            seen += drain(log)
    # The damage hit the second record.
    assert [m.get_seq() for m in seen if m.get_msgId() == 0] == [0, 2, 3, 4, 5, 6, 7]
    assert b"".join(bytes(m.get_msgbuf()) for m in seen if m.get_msgId() < 0) in data
