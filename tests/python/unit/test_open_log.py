"""`mavwire.open_log`: messages of logs without a link, chosen by type, system and time."""

from __future__ import annotations

import os
import signal
import threading
from datetime import UTC, datetime
from pathlib import Path
from random import Random

import mavwire
import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.dialects.v20 import minimal
from mavwire.logs import TelemetryLog
from unit.link_tools import T0, Capture, heartbeat, pack, record

SECONDS = T0 / 1e6


def attitude(seq: int, sysid: int = 1) -> bytes:
    return pack(mavlink.MAVLink_attitude_message(seq, 0.5, 0, 0, 0, 0, 0), seq % 256, sysid)


def unknown(msgid: int) -> bytes:
    """A frame of a message that no dialect here has, with its checksum."""
    body = heartbeat()[1:7] + msgid.to_bytes(3, "little") + bytes(8) + b"\x07"
    return b"\xfd" + body + mavlink.x25crc(body + b"\x55").crc.to_bytes(2, "little")


def entries(count: int) -> list[bytes]:
    """A record every 10 ms: HEARTBEAT of system 1 or 2, else ATTITUDE of system 1."""
    frames = [
        heartbeat(n % 256, sysid=1 + n // 5 % 2, v1=n % 2 == 1) if n % 5 == 0 else attitude(n)
        for n in range(count)
    ]
    return [record(frame, T0 + 10_000 * n + n % 4) for n, frame in enumerate(frames)]


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    path.write_bytes(b"".join(entries(1000)))
    return path


def test_every_message_as_mavutil_gives_it(path):
    with mavutil.mavlink_connection(str(path), append=True, dialect="all") as link:
        expected = list(iter(link.recv_msg, None))
    for resync in ("rescan", "skip"):
        log = mavwire.open_log(path, resync=resync)
        found = list(log)
        assert (len(log), len(found), log.path) == (1000, 1000, str(path))
        assert [str(m) for m in found] == [str(m) for m in expected]
        assert [m._timestamp for m in found] == [m._timestamp for m in expected]
        assert [m._link for m in found] == [m._link for m in expected]
        assert [m.get_msgbuf() for m in found] == [m.get_msgbuf() for m in expected]


def test_types(path):
    log = mavwire.open_log(path)
    assert {m.get_type() for m in log.messages("ATTITUDE")} == {"ATTITUDE"}
    assert sum(1 for _ in log.messages(types=["ATTITUDE", "VFR_HUD"])) == 800
    assert sum(1 for _ in log.messages(types=mavlink.MAVLink_heartbeat_message)) == 200
    assert sum(1 for _ in log.messages(types={"ATTITUDE", "HEARTBEAT"})) == 1000
    assert list(log.messages(types=[])) == []


def test_systems_and_times(path):
    log = mavwire.open_log(path)
    assert sum(1 for _ in log.messages(systems=2)) == 100
    assert sum(1 for _ in log.messages("HEARTBEAT", systems=[1])) == 100
    assert sum(1 for _ in log.messages(systems=[1, 2])) == 1000
    part = [m._timestamp for m in log.messages(start=SECONDS + 1, end=SECONDS + 2)]
    assert (len(part), min(part) >= SECONDS + 1, max(part) < SECONDS + 2) == (100, True, True)
    start = datetime.fromtimestamp(SECONDS + 9.5, UTC)
    assert sum(1 for _ in log.messages(start=start)) == 50
    assert sum(1 for _ in log.messages("HEARTBEAT", 2, SECONDS + 1, start)) == 85


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"types": "ATITUDE"}, "no message 'ATITUDE'; did you mean 'ATTITUDE'"),
        ({"types": [int]}, "int is not a message class"),
        ({"types": "BAD_DATA"}, "BAD_DATA"),
        ({"systems": 256}, "0 to 255, not 256"),
        ({"systems": [1, -1]}, "0 to 255, not -1"),
    ],
)
def test_wrong_choices(path, arguments, text):
    with pytest.raises(ValueError, match=text):
        mavwire.open_log(path).messages(**arguments)


def test_types_that_are_none_are_in_no_log(path):
    log = mavwire.open_log(path)
    assert "HEARTBEAT" in log
    for name in ("BAD_DATA", "UNKNOWN", "ATITUDE"):
        assert name not in log
        with pytest.raises(KeyError, match=f"has no message '{name}'") as found:
            log[name]
        assert f"did you mean '{name}'" not in str(found.value)


def test_wrong_arguments(path):
    with pytest.raises(ValueError, match="resync must be"):
        mavwire.open_log(path, resync="both")
    with pytest.raises(ValueError, match="no dialect 'nope'; name a built-in one"):
        mavwire.open_log(path, dialect="nope")
    with pytest.raises(TypeError):
        mavwire.open_log(5)


def test_unknown_ids(tmp_path):
    path = tmp_path / "unknown.tlog"
    frames = [heartbeat(0), unknown(9_000_001), heartbeat(1), unknown(9_000_002), heartbeat(2)]
    path.write_bytes(b"".join(map(record, frames)))
    log = mavwire.open_log(path)
    assert [m.get_type() for m in log][1::2] == ["UNKNOWN_9000001", "UNKNOWN_9000002"]
    assert [bytes(m.get_msgbuf()) for m in log.messages("UNKNOWN")] == frames[1::2]
    assert [m.get_type() for m in log.messages(["UNKNOWN_9000002", "HEARTBEAT"])] == [
        "HEARTBEAT", "HEARTBEAT", "UNKNOWN_9000002", "HEARTBEAT",
    ]  # fmt: skip
    assert all(m.get_type() == "HEARTBEAT" for m in log.messages("HEARTBEAT"))
    assert list(log.messages("UNKNOWN_16777215")) == []
    for beyond in ("UNKNOWN_16777216", "UNKNOWN_" + "9" * 5000):
        with pytest.raises(ValueError, match="ids are 0 to 16777215"):
            log.messages(beyond)
        with pytest.raises(ValueError, match="ids are 0 to 16777215"):
            log.messages(["UNKNOWN", beyond])


def test_dialects(path):
    log = mavwire.open_log(path, dialect=minimal)
    assert isinstance(next(iter(log)), minimal.MAVLink_heartbeat_message)
    assert isinstance(
        next(iter(mavwire.open_log(path, dialect="minimal"))), minimal.MAVLink_message
    )
    assert sum(1 for _ in log.messages("UNKNOWN_30")) == 800
    with pytest.raises(ValueError, match="minimal has no message 'ATTITUDE'"):
        log.messages("ATTITUDE")


@pytest.mark.parametrize("cut", range(1, 130))
def test_every_whole_record_of_a_cut_log(tmp_path, cut):
    records = entries(4)
    data = b"".join(records)[:cut]
    path = tmp_path / "cut.tlog"
    path.write_bytes(data)
    whole = sum(len(b"".join(records[: n + 1])) <= cut for n in range(4))
    for resync in ("rescan", "skip"):
        log = mavwire.open_log(path, resync=resync)
        assert (len(log), len(list(log))) == (whole, whole)


def test_a_damaged_log(tmp_path):
    path = tmp_path / "damaged.tlog"
    rand = Random(7)
    data = bytearray(b"".join(entries(2000)))
    for _ in range(60):
        data[rand.randrange(len(data))] ^= 0xFF
    path.write_bytes(data)
    with mavutil.mavlink_connection(str(path), append=True, resync="rescan", dialect="all") as link:
        expected = [m for m in iter(link.recv_msg, None) if m.get_msgId() != -1]
    log = mavwire.open_log(path)
    assert 1900 < len(log) < 2000
    assert [(str(m), m._timestamp) for m in log] == [(str(m), m._timestamp) for m in expected]


def test_files_that_are_no_logs(tmp_path):
    with pytest.raises(FileNotFoundError) as error:
        mavwire.open_log(tmp_path / "none.tlog")
    assert error.value.filename == str(tmp_path / "none.tlog")
    with pytest.raises(IsADirectoryError):
        mavwire.open_log(tmp_path)
    for content, text in (
        (b"\xa3\x95\x80\x80" + bytes(100), "a dataflash log"),
        (b"FMT, 128, 89, FMT, BBnNZ\n" * 9, "a dataflash text log"),
        (b"PK\x03\x04" + bytes(99), "a ZIP archive"),
        (b"just some words " * 99, "no telemetry record found"),
        (bytes(5000), "no telemetry record found"),
    ):
        path = tmp_path / "foreign.tlog"
        path.write_bytes(content)
        with pytest.raises(mavwire.LogFormatError, match=text) as wrong:
            TelemetryLog(path)
        assert str(path) in str(wrong.value)
        if "dataflash" not in text:
            with pytest.raises(mavwire.LogFormatError, match=text):
                mavwire.open_log(path)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_that_may_not_be_read(path, tmp_path):
    secret = tmp_path / "secret.tlog"
    secret.write_bytes(path.read_bytes())
    secret.chmod(0)
    with pytest.raises(PermissionError):
        mavwire.open_log(secret)


def test_an_empty_log(tmp_path):
    path = tmp_path / "empty.tlog"
    path.touch()
    log = mavwire.open_log(path)
    assert (len(log), list(log), bool(log)) == (0, [], True)


def test_passes_are_independent(path):
    log = mavwire.open_log(path)
    first, second = iter(log), log.messages("ATTITUDE")
    for _ in range(300):
        next(first)
    assert next(second).get_seq() == 1
    assert next(first).get_seq() == 300 % 256
    assert sum(1 for _ in first) == 699
    assert next(first, None) is None


def test_growing_and_shrinking(tmp_path):
    path = tmp_path / "live.tlog"
    records = entries(30)
    path.write_bytes(b"".join(records[:10]))
    log = mavwire.open_log(path)
    assert len(log) == 10
    under_way = iter(log)
    next(under_way)
    with open(path, "ab") as writer:
        writer.write(b"".join(records[10:]))
    assert (len(log), sum(1 for _ in log)) == (30, 30)
    os.truncate(path, len(b"".join(records[:5])) + 3)
    assert (len(log), sum(1 for _ in log)) == (5, 5)
    assert sum(1 for _ in under_way) in (4, 9, 29)
    path.unlink()
    with pytest.raises(FileNotFoundError):
        iter(log)


def test_closing(path):
    with mavwire.open_log(path) as log:
        under_way = iter(log)
    assert log.closed
    assert sum(1 for _ in under_way) == 1000
    with pytest.raises(ValueError, match="closed"):
        log.messages()
    assert "closed" in repr(log)


def test_a_message_can_be_given_to_a_link(path):
    link = Capture()
    for msg in mavwire.open_log(path):
        link.post_message(msg)
    assert (link.mav_count, link.messages["ATTITUDE"].time_boot_ms) == (1000, 999)


def test_threads_share_one_pass(path):
    shared = iter(mavwire.open_log(path))
    seen: list[list[int]] = [[] for _ in range(4)]

    def read(mine: list[int]) -> None:
        for msg in shared:
            mine.append(round(msg._timestamp * 1e6) - T0)

    threads = [threading.Thread(target=read, args=(mine,)) for mine in seen]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    everything = sorted(time for mine in seen for time in mine)
    assert everything == pytest.approx([10_000 * n + n % 4 for n in range(1000)], abs=1)


class InterruptedPass(Exception):
    """What the signal handler of the next test raises."""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="signals by timer")
def test_an_interrupt_loses_no_message(tmp_path):
    def interrupt(*_: object) -> None:
        raise InterruptedPass

    path = tmp_path / "long.tlog"
    path.write_bytes(b"".join(entries(200)) * 250)
    before = signal.signal(signal.SIGALRM, interrupt)
    reached = []
    try:
        for delay in range(1, 100):
            under_way = iter(mavwire.open_log(path))
            seen: list[object] = []
            try:
                signal.setitimer(signal.ITIMER_REAL, delay * 1e-4)
                seen.extend(under_way)
            except InterruptedPass:
                reached.append(len(seen))
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
            seen.extend(under_way)
            assert len(seen) == 50_000
            if sum(0 < count < 50_000 for count in reached) >= 3:
                return
    finally:
        signal.signal(signal.SIGALRM, before)
    pytest.fail(f"never interrupted under way: {reached}")
