"""Logs as ports: programs that call `recv` and parse by themselves, as MAVProxy does."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.links.log_file import LogFile
from unit.link_tools import T0, pack, record

TEXTS = [f"line {number}".encode() for number in range(40)]
FRAMES = [
    pack(mavlink.MAVLink_statustext_message(6, text), number) for number, text in enumerate(TEXTS)
]
RECORDS = [record(frame, T0 + 4 * number) for number, frame in enumerate(FRAMES)]
LOG = b"".join(RECORDS)


pytestmark = pytest.mark.usefixtures("mavlink20")


def received(log: Any, size: int | None, takes_in: bool = False) -> list[Any]:
    """All messages, BAD_DATA included, by `recv` and `parse_buffer`, perhaps also `post_message`."""
    found = []
    while log.port.inWaiting() > 0:
        for msg in log.mav.parse_buffer(log.recv(size)) or []:
            found.append(msg)
            if takes_in:
                log.post_message(msg)
    return found


def texts(messages: list[Any]) -> list[bytes]:
    return [msg.text.encode() for msg in messages if msg.get_type() == "STATUSTEXT"]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "flight.tlog"


@pytest.mark.parametrize("takes_in", [False, True])
@pytest.mark.parametrize("size", [1, 11, 16, 280, 16 * 1024, 1 << 62, None])
def test_a_program_that_parses_by_itself_gets_every_message(
    path: Path, size: int | None, takes_in: bool
) -> None:
    """Also where the bytes of time stamps are marks of frames, 0xFD and 0xFE."""
    times = [(T0 & ~0xFFFFFF) + 0xFD_FE_00 + 4 * number for number in range(40)]
    path.write_bytes(b"".join(map(record, FRAMES, times)))
    with mavutil.mavlink_connection(str(path)) as log:
        assert log.fd is None and log.port.inWaiting() == len(LOG)
        for _ in range(2):
            found = received(log, size, takes_in)
            assert texts(found) == TEXTS and len(found) == len(TEXTS)
            if takes_in:
                assert [round(msg._timestamp * 1e6) for msg in found] == times
            assert log.port.inWaiting() == 0 and log.recv(16) == b""
            log.rewind()
        assert log.recv_msg().text == "line 0"
        assert texts(received(log, size)) == TEXTS[1:]
    assert log.port.inWaiting() == 0 and log.recv(size) == b""


def test_a_log_that_is_written_has_nothing_to_read(path: Path) -> None:
    with mavutil.mavlink_connection(str(path), write=True) as log:
        assert log.port.inWaiting() == 0


@pytest.mark.parametrize("takes_in", [False, True])
@pytest.mark.parametrize("cut", range(1, len(RECORDS[-1]) + 1))
def test_the_end_of_a_log_that_is_cut(path: Path, cut: int, takes_in: bool) -> None:
    path.write_bytes(LOG[:-cut])
    with mavutil.mavlink_connection(str(path)) as log:
        assert texts(received(log, 16 * 1024, takes_in)) == TEXTS[:-1]


@pytest.mark.parametrize("takes_in", [False, True])
@pytest.mark.parametrize("lost", [1, 2, 5, 8, 9, 20])
@pytest.mark.parametrize("start", range(len(RECORDS[10])))
def test_bytes_that_are_missing_cost_no_more_than_in_a_stream(
    path: Path, start: int, lost: int, takes_in: bool
) -> None:
    """The record that lacks them, and the one whose first bytes it takes for its own."""
    at = len(b"".join(RECORDS[:10])) + start
    path.write_bytes(LOG[:at] + LOG[at + lost :])
    with mavutil.mavlink_connection(str(path)) as log:
        found = texts(received(log, 16 * 1024, takes_in))
    damaged = {10, 11} if start + lost > len(RECORDS[10]) else {10}
    taken = damaged | {max(damaged) + 1}
    assert set(TEXTS) - set(found) <= {TEXTS[number] for number in taken}
    assert found == [text for text in TEXTS if text in found]


def test_noise_in_small_pieces_is_looked_through_once(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[int] = []
    look = LogFile._junk_at
    monkeypatch.setattr(
        LogFile, "_junk_at", lambda file, at: [look(file, at), looked.append(at)][0]
    )
    path.write_bytes(RECORDS[0] + bytes(9000) + RECORDS[1])
    with mavutil.mavlink_connection(str(path)) as log:
        assert texts(received(log, 1)) == TEXTS[:2]
    assert len(looked) <= 4


@pytest.mark.parametrize("takes_in", [False, True])
def test_noise_between_records(path: Path, takes_in: bool) -> None:
    """Without the marks of frames, so that no frame is taken for the rest of a false one."""
    random = Random(7)
    quiet = bytes(range(0xFD))
    noisy = b"".join(
        one + bytes(random.choices(quiet, k=random.choice((0, 0, 0, 1, 7, 8, 9, 300, 9000))))
        for one in RECORDS
    )
    path.write_bytes(noisy)
    with mavutil.mavlink_connection(str(path)) as log:
        assert texts(received(log, 16 * 1024, takes_in)) == TEXTS


def test_a_log_that_grows(path: Path) -> None:
    path.touch()
    with mavutil.mavlink_connection(str(path), append=True) as log, path.open("ab") as writer:
        found = []
        for start in range(0, len(LOG), 7):
            writer.write(LOG[start : start + 7])
            writer.flush()
            while data := log.recv(16 * 1024):
                found += log.mav.parse_buffer(data) or []
    assert texts(found) == TEXTS and len(found) == len(TEXTS)


def test_noise_at_the_end_of_a_log_that_grows_may_be_a_record(path: Path) -> None:
    """Its rest was not written when the noise in front of it was looked through."""
    noise, whole = b"noise" * 5, RECORDS[1]
    path.write_bytes(RECORDS[0] + noise + whole[:12])
    with mavutil.mavlink_connection(str(path)) as log:
        assert log.recv() == FRAMES[0]
        assert log.recv(4) == noise[:4]
        with path.open("ab") as file:
            file.write(whole[12:] + RECORDS[2])
        assert [log.recv() for _ in range(4)] == [noise[4:], FRAMES[1], FRAMES[2], b""]


def test_a_raw_stream_is_read_as_it_is(path: Path) -> None:
    path.write_bytes(LOG)
    with mavutil.mavlink_connection(str(path), notimestamps=True) as log:
        assert log.recv(16 * 1024) == LOG
