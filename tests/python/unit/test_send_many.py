"""`send_many`: many messages with few calls of `write`."""

from __future__ import annotations

import socket
from typing import Any

import pytest
from mavwire import mavutil
from mavwire._native import StreamWriter
from mavwire.dialects.v20 import common

WAIT = 60.0


class Sink:
    """Keeps what each call of `write` got."""

    def __init__(self, batch_bytes: int | None = None) -> None:
        self.pieces: list[bytes] = []
        self.fails = False
        if batch_bytes is not None:
            self.batch_bytes = batch_bytes

    def write(self, data: bytes) -> None:
        if self.fails:
            raise OSError("no")
        self.pieces.append(bytes(data))


def messages(count: int) -> list[Any]:
    return [common.MAVLink_system_time_message(1, number) for number in range(1, count + 1)]


def parsed(data: bytes) -> list[Any]:
    return list(common.MAVLink(None).parse_buffer(data) or [])


def one_by_one(count: int) -> list[bytes]:
    """The frames that `send` writes."""
    sink = Sink()
    mav = common.MAVLink(sink, 1, 1)
    for message in messages(count):
        mav.send(message)
    return sink.pieces


@pytest.mark.parametrize("room, writes", [(None, 300), (0, 300), (280, 300), (1400, 6), (10**6, 1)])
def test_frames_are_those_of_send_in_fewer_writes(room: int | None, writes: int) -> None:
    sink = Sink(room)
    mav = common.MAVLink(sink, 1, 1)
    seen: list[Any] = []
    mav.set_send_callback(seen.append)
    sent = messages(300)
    mav.send_many(message for message in sent)
    frames = one_by_one(300)
    assert b"".join(sink.pieces) == b"".join(frames)
    assert len(sink.pieces) <= max(writes, 1) and all(
        len(p) <= max(room or 0, 280) for p in sink.pieces
    )
    assert (mav.seq, mav.total_packets_sent) == (300 % 256, 300)
    assert mav.total_bytes_sent == sum(map(len, frames))
    assert seen == sent and all(one is other for one, other in zip(seen, sent, strict=True))


def test_nothing_to_send_writes_nothing() -> None:
    sink = Sink(1400)
    common.MAVLink(sink).send_many([])
    assert sink.pieces == []


def test_a_message_that_cannot_be_packed_is_an_error_behind_those_before_it() -> None:
    sink = Sink(1400)
    mav = common.MAVLink(sink, 1, 1)
    wrong: Any = "no number"
    bad = common.MAVLink_system_time_message(wrong, 1)
    with pytest.raises(Exception, match="argument"):
        mav.send_many([*messages(3), bad, *messages(1)])
    assert b"".join(sink.pieces) == b"".join(one_by_one(3))
    mav.send(messages(4)[3])
    assert sink.pieces[-1] == one_by_one(4)[3], "the bad one took no sequence number"


def test_what_is_no_message_is_an_error() -> None:
    mav = common.MAVLink(Sink(1400))
    odd: list[Any] = [None, 7, "text", [7]]
    for wrong in odd:
        with pytest.raises((TypeError, AttributeError)):
            mav.send_many(wrong)


def test_a_failing_write_raises_and_counts_nothing() -> None:
    sink = Sink(1400)
    mav = common.MAVLink(sink)
    sink.fails = True
    with pytest.raises(OSError, match="no"):
        mav.send_many(messages(2))
    assert mav.total_packets_sent == 0


def test_signed_frames_have_timestamps_that_grow() -> None:
    sink = Sink(10**6)
    mav = common.MAVLink(sink, 1, 1)
    mav.signing.secret_key, mav.signing.sign_outgoing = bytes(32), True
    mav.send_many(messages(5))
    receiver = common.MAVLink(None)
    receiver.signing.secret_key = bytes(32)
    received = receiver.parse_buffer(sink.pieces[0]) or []
    assert len(received) == receiver.signing.goodsig_count == 5


def test_version_1() -> None:
    sink = Sink(1400)
    mav = common.MAVLink(sink)
    mav.send_many(messages(2), force_mavlink1=True)
    assert [m.get_msgbuf()[0] for m in parsed(sink.pieces[0])] == [
        254,
        254,
    ]


def test_methods_of_the_program_see_each_message() -> None:
    class Own(common.MAVLink):
        def send(self, mavmsg: Any, force_mavlink1: bool = False) -> None:
            seen.append(mavmsg)
            super().send(mavmsg, force_mavlink1)

    seen: list[Any] = []
    sent = messages(3)
    Own(Sink(1400)).send_many(sent)
    assert seen == sent

    packed: list[Any] = []
    original = sent[1].pack

    def pack(mav: Any, force_mavlink1: bool) -> bytes:
        packed.append(mav.seq)
        frame: bytes = original(mav, force_mavlink1)
        return frame

    sent[1].pack = pack
    sink = Sink(1400)
    mav = common.MAVLink(sink, 1, 1)
    mav.send_many(sent)
    mav.send(sent[1])
    assert packed == [1, 3]
    assert b"".join(sink.pieces[:1]) == b"".join(one_by_one(3))


def test_a_stream_gets_all_frames_at_once() -> None:
    server = mavutil.mavlink_connection("tcpin:127.0.0.1:0", dialect="common")
    client = socket.create_connection(server.listen.getsockname())
    client.settimeout(WAIT)
    with server, client:
        server.send_many(messages(20))
        received = b""
        while len(parsed(received)) < 20:
            received += client.recv(1 << 16)
        assert server.frames_dropped == 0


def test_datagrams_hold_whole_frames() -> None:
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    receiver.bind(("127.0.0.1", 0))
    receiver.settimeout(WAIT)
    link = mavutil.mavlink_connection(
        f"udpout:127.0.0.1:{receiver.getsockname()[1]}", dialect="common"
    )
    with receiver, link:
        for batch_bytes, datagrams in ((1400, 2), (0, 100)):
            link.batch_bytes = batch_bytes
            link.send_many(messages(100))
            pieces = [receiver.recv(2000) for _ in range(datagrams)]
            counts = [len(parsed(piece)) for piece in pieces]
            assert sum(counts) == 100 and max(map(len, pieces)) <= 1400


def test_frames_side_by_side_are_dropped_and_counted_one_by_one() -> None:
    class Stuck:
        def send(self, data: bytes) -> int:
            raise BlockingIOError

    frames = one_by_one(4)
    writer = StreamWriter(2 * len(frames[0]))
    writer.write(Stuck(), b"".join(frames))
    assert (writer.unsent, writer.dropped_frames) == (b"".join(frames[:2]), 2)
