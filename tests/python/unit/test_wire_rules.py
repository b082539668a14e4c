"""The edges of the protocol, with frames that nobody but the tests made."""

from __future__ import annotations

import io
import struct
import threading
from pathlib import Path
from typing import Any

import mavwire
import pytest
from encoder import attitude, frame, heartbeat, record, signed
from mavwire.dialects.v20 import common as mavlink
from unit.link_tools import KEY, T0, Capture, drain

HEARTBEAT = struct.pack("<I5B", 0, 2, 3, 81, 4, 0)


def parsed(*frames: bytes) -> list[Any]:
    """The messages of a strict parser."""
    mav = mavlink.MAVLink(None)
    return mav.parse_buffer(b"".join(frames)) or []


def test_both_versions_as_the_guide_lays_them_out() -> None:
    """R1, R2, R3."""
    old, new = parsed(heartbeat(7, v1=True), heartbeat(8))
    for msg, seq in ((old, 7), (new, 8)):
        assert (msg.type, msg.autopilot, msg.custom_mode) == (2, 3, 4)
        assert (msg.get_seq(), msg.get_srcSystem(), msg.get_srcComponent()) == (seq, 1, 1)
    mav = mavlink.MAVLink(None, 1, 1)
    msg = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    assert (msg.pack(mav), msg.pack(mav, force_mavlink1=True)) == (heartbeat(), heartbeat(v1=True))


def test_zeros_at_the_end_are_sent_or_not() -> None:
    """R9, R10, R11, R14."""
    whole, cut = parsed(frame(0, HEARTBEAT), frame(0, HEARTBEAT.rstrip(b"\0")))
    assert str(whole) == str(cut)
    mav = mavlink.MAVLink(None, 1, 1)
    assert whole.pack(mav) == frame(0, HEARTBEAT.rstrip(b"\0"))
    assert whole.pack(mav, force_mavlink1=True) == frame(0, HEARTBEAT, v1=True)
    (nothing,) = parsed(frame(30, b""))
    assert (nothing.time_boot_ms, nothing.roll) == (0, 0)
    assert nothing.pack(mav) == frame(30, b"\0"), "the first byte is always sent"


def test_payloads_of_other_lengths() -> None:
    """R12, R13."""
    for v1 in (False, True):
        (longer,) = parsed(frame(0, HEARTBEAT + b"more", v1=v1))
        (shorter,) = parsed(frame(0, HEARTBEAT[:6], v1=v1))
        assert (longer.type, longer.base_mode) == (2, 81)
        assert (shorter.type, shorter.base_mode) == (2, 0)


def test_version_1_has_no_extension_fields() -> None:
    """R9b."""
    mav = mavlink.MAVLink(None, 1, 1)
    msg = mavlink.MAVLink_statustext_message(6, b"hello", id=7, chunk_seq=1)
    base = bytes([6]) + b"hello".ljust(50, b"\0")
    assert msg.pack(mav, force_mavlink1=True) == frame(253, base, v1=True)
    assert msg.pack(mav) == frame(253, base + b"\x07\0\x01")


def test_a_sender_without_an_address(tmp_path: Path) -> None:
    """R18."""
    for sysid, compid in ((0, 0), (0, 1), (1, 0)):
        data = heartbeat(5, sysid=sysid, compid=compid)
        link = Capture()
        link.rx += data + heartbeat(6, sysid=sysid, compid=compid)
        assert [msg.get_srcSystem() for msg in drain(link)] == [sysid] * 2
        assert (link.mav_count, link.mav_loss) == (2, 0)
        path = tmp_path / f"{sysid}_{compid}.tlog"
        path.write_bytes(record(data, T0))
        with mavwire.open_log(path) as log:
            assert [msg.get_srcComponent() for msg in log.messages()] == [compid]
            assert len(log["HEARTBEAT"]) == 1


@pytest.mark.parametrize("length", [0, 1, 49, 50])
def test_texts_of_any_bytes(length: int) -> None:
    """R23: a text may fill its field, and bytes that are no text raise nothing."""
    for text in (b"t" * length, (b"\xff\xfe" * 25)[:length]):
        (msg,) = parsed(frame(253, bytes([6]) + text.ljust(50, b"\0")))
        assert msg.text == text.decode("ascii", "replace")
        assert str(msg)
        assert msg.to_json()
        assert bytes(msg._text_raw).rstrip(b"\0") == text
    (msg,) = parsed(frame(253, b"\x06first\0second"))
    assert msg.text == "first"


@pytest.mark.parametrize("bits", [0x7F800000, 0xFF800000, 0x7FC00000, 0x7F800001, 0xFFC12345])
def test_numbers_that_are_none_keep_their_bits(bits: int, tmp_path: Path) -> None:
    """R24: received and sent again, as bytes and as columns."""
    payload = struct.pack("<7I", 1, 2, bits, bits, 3, bits, bits)
    received = frame(30, payload)
    (msg,) = parsed(received)
    assert msg.pack(mavlink.MAVLink(None, 1, 1)) == received
    path = tmp_path / "nan.tlog"
    path.write_bytes(record(received, T0))
    with mavwire.open_log(path) as log:
        column = log["ATTITUDE"].to_numpy()["pitch"]
    assert column.dtype == "float32"
    assert int(column.view("uint32")[0]) == bits


@pytest.mark.parametrize(
    "values",
    [(256, 3, 81, 4, 4), (-1, 3, 81, 4, 4), (2, 3, 81, 1 << 32, 4), (2, 3, "x", 4, 4),
     (2, 3, None, 4, 4), (2, 3, 1.5, 4, 4)],
)  # fmt: skip
def test_a_value_that_does_not_fit_changes_nothing(values: tuple[Any, ...]) -> None:
    """R25."""
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    mav.heartbeat_send(2, 3, 81, 4, 4)
    before = (mav.seq, mav.total_packets_sent, mav.total_bytes_sent, file.getvalue())
    with pytest.raises((struct.error, TypeError, OverflowError)):
        mav.heartbeat_send(*values)
    assert (mav.seq, mav.total_packets_sent, mav.total_bytes_sent, file.getvalue()) == before
    mav.heartbeat_send(2, 3, 81, 4, 4)
    assert [msg.get_seq() for msg in parsed(file.getvalue())] == [0, 1]


def test_many_threads_share_the_table_of_streams() -> None:
    """R42b: of copies that reach several links at once one is taken."""
    count = 300
    frames = [signed(30, attitude(n, 0, 0, 0, 0, 0, 0), KEY, 1000 + n) for n in range(count)]
    links = [Capture() for _ in range(4)]
    for link in links:
        link.setup_signing(KEY, initial_timestamp=0)
        link.rx += b"".join(frames)
    taken: list[list[int]] = [[] for _ in links]
    start = threading.Barrier(len(links))

    def receive(number: int) -> None:
        start.wait()
        for msg in drain(links[number]):
            if msg.get_type() == "ATTITUDE":
                taken[number].append(msg.time_boot_ms)

    threads = [threading.Thread(target=receive, args=(number,)) for number in range(len(links))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    every = [n for own in taken for n in own]
    assert len(every) == len(set(every)), "taken twice"
    assert count - 1 in every
    assert all(own == sorted(own) for own in taken)
    assert {tuple(link.mav.signing.stream_timestamps.items()) for link in links} == {
        (((3, 1, 1), 1000 + count - 1),)
    }
