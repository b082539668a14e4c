"""The edges of the protocol, with frames that nobody but the tests made."""

from __future__ import annotations

import hashlib
import importlib
import io
import json
import struct
import threading
from pathlib import Path
from typing import Any

import mavwire
import pytest
from encoder import attitude, frame, heartbeat, record, signed
from mavwire import Bridge, mavutil
from mavwire.dialects.v20 import common as mavlink
from unit.bridge_tools import UDP, peers, receive, report, udp_peer, wait_until
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


TEXT = bytes([6]) + b"hello".ljust(50, b"\0")
"""STATUSTEXT in version 1; version 2 has `id` and `chunk_seq` behind it."""


def test_version_1_has_no_extension_fields() -> None:
    """R9b: neither packed, nor sent, nor by links of version 1."""
    msg = mavlink.MAVLink_statustext_message(6, b"hello", id=7, chunk_seq=1)
    mav = mavlink.MAVLink(None, 1, 1)
    assert msg.pack(mav, force_mavlink1=True) == frame(253, TEXT, v1=True)
    assert msg.pack(mav) == frame(253, TEXT + b"\x07\0\x01")
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    mav.send(msg, force_mavlink1=True)
    mav.statustext_send(6, b"hello", id=7, chunk_seq=1, force_mavlink1=True)
    assert file.getvalue() == frame(253, TEXT, 0, v1=True) + frame(253, TEXT, 1, v1=True)


def test_ids_of_version_2_are_not_sent_in_version_1() -> None:
    """R5: an error, which changes nothing."""
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    large = mavlink.MAVLink_open_drone_id_arm_status_message(1, b"a")
    assert large.get_msgId() > 255
    for send in (
        lambda: mav.send(large, force_mavlink1=True),
        lambda: mav.open_drone_id_arm_status_send(1, b"a", force_mavlink1=True),
        lambda: large.pack(mav, force_mavlink1=True),
    ):
        with pytest.raises(struct.error):
            send()
    assert (mav.seq, mav.total_packets_sent, file.getvalue()) == (0, 0, b"")
    mav.send(large)
    (msg,) = parsed(file.getvalue())
    assert (msg.get_msgId(), msg.get_seq(), file.getvalue()[0]) == (large.get_msgId(), 0, 0xFD)


def test_a_bridge_converts_to_version_1_as_the_guide_says() -> None:
    """R5, R9b: no extension fields, all zeros of the others, and no id above 255."""
    zeros = frame(30, attitude(7, 0, 0, 0, 0, 0, 0).rstrip(b"\0"))
    arm_status = frame(12918, b"\x01a", crc_extra=139)
    with Bridge() as bridge, udp_peer() as old:
        bridge.add(f"udpout:127.0.0.1:{old.getsockname()[1]}", name="old", version=1)
        bridge.send(frame(253, TEXT + b"\x07\0\x01", 1) + arm_status + zeros)
        assert receive(old) == frame(253, TEXT, 1, v1=True)
        assert receive(old) == frame(30, attitude(7, 0, 0, 0, 0, 0, 0), v1=True)
        wait_until("the count", lambda: report(bridge, "old")["unconverted"] == 1)


VECTORS = Path(__file__).parents[2] / "vectors" / "crc_extra.json"


@pytest.mark.parametrize("version", ["v10", "v20"])
def test_the_checksum_seeds_are_those_of_others(version: str) -> None:
    """R7: every message of every dialect, as pymavlink 2.4.50 has them."""
    known: dict[str, dict[str, int]] = json.loads(VECTORS.read_text(encoding="utf-8"))
    assert len(known) >= 19
    for dialect, seeds in known.items():
        module = importlib.import_module(f"mavwire.dialects.{version}.{dialect}")
        ours = {str(number): one.crc_extra for number, one in module.mavlink_map.items()}
        theirs = {
            number: seed for number, seed in seeds.items() if version == "v20" or int(number) < 256
        }
        assert ours == theirs, dialect


@pytest.mark.parametrize("resync", ["skip", "rescan"])
@pytest.mark.parametrize("flags", [0x02, 0x04, 0x80, 0xFE, 0x03, 0xFF])
def test_flags_that_nobody_knows(flags: int, resync: str) -> None:
    """R15: the frame is no message, be it signed well beside the flag, with a key and without."""
    payload = heartbeat()[10:-2]
    strange = frame(0, payload, flags=flags)
    if flags & 1:
        strange += b"\3" + (1000).to_bytes(6, "little")
        strange += hashlib.sha256(KEY + strange).digest()[:6]
    for key in (None, KEY):
        good = heartbeat(9) if key is None else signed(0, payload, KEY, 2000)
        mav = mavlink.MAVLink(None)
        mav.robust_parsing, mav.resync = True, resync
        mav.signing.secret_key = key
        found = mav.parse_buffer(strange + good)
        assert [bytes(msg.get_msgbuf()) for msg in found if msg.get_msgId() == 0] == [good]
        assert b"".join(bytes(msg.get_msgbuf()) for msg in found) == strange + good
        assert mav.signing.stream_timestamps == ({} if key is None else {(3, 1, 1): 2000})


FORWARDED = {
    "zeros": frame(30, attitude(1, 0, 0, 0, 0, 0, 0), 3),
    "none at all": frame(30, b"", 4),
    "surplus": frame(0, HEARTBEAT + b"more than is known", 5),
    "version 1": frame(0, HEARTBEAT, 6, v1=True),
    "version 1, short": frame(0, HEARTBEAT[:5], 7, v1=True),
    "signed by others": signed(30, attitude(2, 1, 2, 3, 4, 5, 6), b"k" * 32, 12345),
    "signed, with zeros": signed(30, attitude(3, 0, 0, 0, 0, 0, 0), b"k" * 32, 12346),
    "unknown id": frame(70_000, b"\1\2\0\0", 8, crc_extra=77),
    "unknown id, signed": signed(70_001, b"\1\2\0", b"k" * 32, 12347, crc_extra=78),
    "bits that are no number": frame(30, struct.pack("<7I", 5, *[0x7F800001] * 6), 9),
}


@pytest.mark.parametrize("name", FORWARDED)
def test_what_is_forwarded_is_what_came(name: str, tmp_path: Path) -> None:
    """R19: through a bridge, and as a link and a log hand it out."""
    data = FORWARDED[name]
    with Bridge() as bridge, udp_peer() as station:
        bridge.add(UDP, name="radio")
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station")
        with udp_peer(bridge, "radio") as vehicle:
            vehicle.send(heartbeat(1))
            assert receive(station) == heartbeat(1)
            assert peers(bridge, "radio")
            vehicle.send(data + heartbeat(2))
            assert [receive(station), receive(station)] == [data, heartbeat(2)]
    link = Capture()
    link.rx += data
    (msg,) = drain(link)
    assert bytes(msg.get_msgbuf()) == data
    path = tmp_path / "one.tlog"
    path.write_bytes(record(data, T0))
    with mavutil.mavlink_connection(str(path)) as log:
        assert [bytes(one.get_msgbuf()) for one in iter(log.recv_msg, None)] == [data]


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
    "bits", [0x7FF0 << 48, 0xFFF0 << 48, 0x7FF8 << 48, (0x7FF0 << 48) + 1, 0xFFF8_1234_5678_9ABC]
)
def test_doubles_and_arrays_that_are_no_numbers_keep_their_bits(bits: int, tmp_path: Path) -> None:
    """R24: of both sizes, alone and in arrays."""
    from mavwire.dialects.v20 import test as dialect

    single = bits >> 32 | bits & 1
    # In wire order; all but the floating point numbers are ones.
    payload = struct.pack("<QqQ3Q3q3QIiI3I3i3IHh3H3hc10sBb3B3b",
                          1, 1, bits, *[1] * 6, *[bits] * 3, 1, 1, single, *[1] * 6, *[single] * 3,
                          *[1] * 8, b"c", b"s", *[1] * 8)  # fmt: skip
    received = frame(17000, payload, crc_extra=103)
    (msg,) = dialect.MAVLink(None).parse_buffer(received)
    assert msg.pack(dialect.MAVLink(None, 1, 1)) == received
    path = tmp_path / "nan.tlog"
    path.write_bytes(record(received, T0))
    with mavwire.open_log(path, dialect="test") as log:
        columns = log["TEST_TYPES"].to_numpy()
    for name, kind, expected in (("d", "uint64", bits), ("f", "uint32", single)):
        assert columns[name].view(kind).tolist() == [expected]
        array = columns[f"{name}_array"]
        assert array.reshape(-1).view(kind).tolist() == [expected] * 3


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
