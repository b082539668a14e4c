"""Many threads on one MAVLink object: no sequence break, no signing timestamp twice, no lost frame."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from itertools import pairwise

import pytest
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import KEY, THREADS, at_once, heartbeat

EACH = 400


@pytest.fixture(autouse=True)
def frequent_switches() -> Iterator[None]:
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    yield
    sys.setswitchinterval(before)


class Wire:
    """Takes what is written, now and then after letting others run."""

    def __init__(self, dawdles: bool) -> None:
        self.frames: list[bytes] = []
        self._dawdles = dawdles

    def write(self, frame: bytes) -> None:
        if self._dawdles and len(self.frames) % 50 == 0:
            time.sleep(0)
        self.frames.append(bytes(frame))

    def messages(self) -> list[mavlink.MAVLink_message]:
        return mavlink.MAVLink(None).parse_buffer(b"".join(self.frames)) or []


def signing_timestamp(frame: bytes) -> int:
    return int.from_bytes(frame[-12:-6], "little")


def assert_in_sequence(frames: list[bytes]) -> None:
    assert [frame[4] for frame in frames] == [n % 256 for n in range(len(frames))]


@pytest.mark.parametrize("dawdles", [False, True])
@pytest.mark.parametrize("signed", [False, True])
def test_many_senders(signed, dawdles):
    """R34."""
    wire = Wire(dawdles)
    mav = mavlink.MAVLink(wire, srcSystem=1, srcComponent=1)
    if signed:
        mav.signing.secret_key = KEY
        mav.signing.sign_outgoing = True
        mav.signing.timestamp = 1000

    def send(number: int) -> None:
        for n in range(EACH):
            if n % 3 == 0:
                mav.heartbeat_send(number, 3, 81, n, 4)
            elif n % 3 == 1:
                mav.attitude_send(n, number, 0, 0, 0, 0, 0)
            else:
                mav.send(mav.param_value_encode(b"P%d" % number, n, 9, 1, 0))

    at_once(send)
    assert len(wire.frames) == THREADS * EACH == mav.total_packets_sent
    assert mav.total_bytes_sent == sum(map(len, wire.frames))
    assert_in_sequence(wire.frames)
    if signed:
        stamps = [signing_timestamp(frame) for frame in wire.frames]
        assert all(earlier < later for earlier, later in pairwise(stamps))
    # Each thread's own messages stay in order.
    beats = [m for m in wire.messages() if m.get_type() == "HEARTBEAT"]
    for number in range(THREADS):
        own = [m.custom_mode for m in beats if m.type == number]
        assert own == list(range(0, EACH, 3))


def test_messages_that_cannot_be_packed_leave_no_gap():
    wire = Wire(dawdles=True)
    mav = mavlink.MAVLink(wire, srcSystem=1, srcComponent=1)

    def send(number: int) -> None:
        for n in range(EACH):
            if n % 4 == number % 4:
                with pytest.raises(Exception, match="format|range|argument|integer"):
                    mav.heartbeat_send(1000, 3, 81, n, 4)
            else:
                mav.heartbeat_send(number, 3, 81, n, 4)

    at_once(send)
    assert len(wire.frames) == THREADS * EACH * 3 // 4
    assert_in_sequence(wire.frames)


def test_a_callback_that_sends_while_others_do():
    wire = Wire(dawdles=True)
    mav = mavlink.MAVLink(wire, srcSystem=1, srcComponent=1)

    def echo(msg: mavlink.MAVLink_message, *_: object) -> None:
        if msg.get_type() == "HEARTBEAT":
            mav.system_time_send(msg.custom_mode, 0)

    mav.set_send_callback(echo)
    at_once(lambda number: [mav.heartbeat_send(number, 3, 81, n, 4) for n in range(EACH)] and None)
    assert len(wire.frames) == 2 * THREADS * EACH
    assert sorted(frame[4] for frame in wire.frames[:256]) == list(range(256))


def test_one_parser_fed_by_many_threads():
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    seen: list[list[tuple[int, int]]] = [[] for _ in range(THREADS)]

    def parse(number: int) -> None:
        for n in range(EACH):
            frame = heartbeat(n % 256, sysid=number + 1)
            for msg in mav.parse_buffer(frame) or []:
                seen[number].append((msg.get_srcSystem(), msg.get_seq()))

    at_once(parse)
    everything = sorted(one for own in seen for one in own)
    assert everything == sorted((s + 1, n % 256) for s in range(THREADS) for n in range(EACH))
    assert (mav.total_packets_received, mav.total_receive_errors) == (THREADS * EACH, 0)
    assert mav.total_bytes_received == THREADS * EACH * len(heartbeat())


def test_one_parser_fed_with_single_bytes_by_turns():
    """The bytes of a frame come from several threads, in order; one of them gets the message."""
    mav = mavlink.MAVLink(None)
    stream = b"".join(heartbeat(n % 256) for n in range(40))
    turn = threading.Condition()
    position = [0]
    seen: list[int] = []

    def parse(number: int) -> None:
        while True:
            with turn:
                turn.wait_for(lambda: position[0] % 3 == number or position[0] >= len(stream))
                if position[0] >= len(stream):
                    return
                msg = mav.parse_char(stream[position[0] : position[0] + 1])
                if msg is not None:
                    seen.append(msg.get_seq())
                position[0] += 1
                turn.notify_all()

    at_once(parse, 3)
    assert seen == list(range(40))


def test_a_parser_for_each_thread():
    stream = b"".join(heartbeat(n % 256) for n in range(2000))
    found: list[int] = [0] * THREADS

    def parse(number: int) -> None:
        mav = mavlink.MAVLink(None)
        chunk = 30 + number
        for start in range(0, len(stream), chunk):
            found[number] += len(mav.parse_buffer(stream[start : start + chunk]) or [])

    at_once(parse)
    assert found == [2000] * THREADS


def test_signed_frames_verified_while_others_send():
    """Sending and receiving share one signing state; neither may disturb the other's timestamps."""
    wire = Wire(dawdles=False)
    mav = mavlink.MAVLink(wire, srcSystem=1, srcComponent=1)
    peer = mavlink.MAVLink(None, srcSystem=9, srcComponent=1)
    for one in (mav, peer):
        one.signing.secret_key = KEY
        one.signing.sign_outgoing = True
        one.signing.timestamp = 1000
    frames = []
    for n in range(EACH):
        frames.append(bytes(mavlink.MAVLink_heartbeat_message(2, 3, 81, n, 4, 3).pack(peer)))
    got: list[bool] = []

    def work(number: int) -> None:
        for n in range(EACH):
            if number == 0:
                got.extend(m.get_signed() for m in mav.parse_buffer(frames[n]) or [])
            else:
                mav.heartbeat_send(number, 3, 81, n, 4)

    at_once(work)
    assert got == [True] * EACH
    stamps = [signing_timestamp(frame) for frame in wire.frames]
    assert all(earlier < later for earlier, later in pairwise(stamps))
    assert_in_sequence(wire.frames)


def test_the_import_fails_without_the_interpreters_lock():
    """As a free-threaded build with PYTHON_GIL=0 has it."""
    program = "import sys; sys._is_gil_enabled = lambda: False; import mavwire._native"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert "ImportError: mavwire needs the global interpreter lock" in done.stderr
