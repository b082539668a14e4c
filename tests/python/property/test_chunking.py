"""However a stream is cut into pieces, the same messages come out of it."""

from __future__ import annotations

from typing import Literal

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings
from mavwire.dialects.v20 import all as mavlink

PIECES = st.one_of(
    st.integers(0, 255).map(lambda seq: frame(mavlink.MAVLink_heartbeat_message, seq)),
    st.integers(0, 255).map(lambda seq: frame(mavlink.MAVLink_attitude_message, seq)),
    st.integers(0, 255).map(lambda seq: frame(mavlink.MAVLink_heartbeat_message, seq, v1=True)),
    st.integers(0, 255).map(lambda seq: frame(mavlink.MAVLink_heartbeat_message, seq)[:-3]),
    st.sampled_from([b"\xfd", b"\xfe", b"\xfd\xff\x01", b"\xfe\xfe\xfe", b"\x00" * 9]),
    st.binary(max_size=40),
)
Resync = Literal["skip", "rescan"]
STREAMS = st.lists(PIECES, max_size=12).map(b"".join)


def frame(kind: type, seq: int, v1: bool = False) -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    mav.seq = seq
    fields = len(kind.fieldnames)  # type: ignore[attr-defined]
    return bytes(kind(*([3] * fields)).pack(mav, force_mavlink1=v1))


def outcome(
    chunks: list[bytes], resync: Resync, parse_char: bool
) -> tuple[list[bytes], bytes, bytes]:
    """Frames of the messages, all bytes that came out in order, and what is still waiting."""
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    mav.resync = resync
    messages = []
    for chunk in chunks:
        if not parse_char:
            messages += mav.parse_buffer(chunk) or []
            continue
        message = mav.parse_char(chunk)
        while message is not None:
            messages.append(message)
            message = mav.parse_char(b"")
    everything = b"".join(bytes(m.get_msgbuf()) for m in messages)
    good = [bytes(m.get_msgbuf()) for m in messages if m.get_msgId() != -1]
    return good, everything, bytes(mav.buf[mav.buf_index :])


def strict_frames(chunks: list[bytes], resync: Resync) -> list[bytes]:
    """Frames of the messages of a parser that raises instead of giving BAD_DATA."""
    mav = mavlink.MAVLink(None)
    mav.resync = resync
    good = []
    for chunk in chunks:
        data, before = chunk, -1
        while mav.buf_len() + len(data) != before:
            before = mav.buf_len() + len(data)
            try:
                message = mav.parse_char(data)
            except mavlink.MAVError:
                message = None
            data = b""
            if message is not None:
                good.append(bytes(message.get_msgbuf()))
    return good


@pytest.mark.parametrize("resync", ["skip", "rescan"])
@given(stream=STREAMS, cuts=st.lists(st.integers(0, 600), max_size=20), parse_char=st.booleans())
@settings(max_examples=300, deadline=None)
def test_any_chunking_gives_the_same_messages(
    resync: Resync, stream: bytes, cuts: list[int], parse_char: bool
) -> None:
    ends = sorted({min(cut, len(stream)) for cut in cuts} | {len(stream)})
    chunks = [stream[a:b] for a, b in zip([0, *ends], ends, strict=False)]
    whole = outcome([stream], resync, False)
    bytewise = outcome([stream[n : n + 1] for n in range(len(stream))], resync, parse_char)
    pieces = outcome(chunks, resync, parse_char)
    for found in (whole, bytewise, pieces):
        good, everything, waiting = found
        assert good == whole[0]
        # Nothing is lost and nothing comes twice.
        assert everything + waiting == stream
    # And a strict parser loses none of them.
    for strict in ([stream], [stream[n : n + 1] for n in range(len(stream))], chunks):
        assert strict_frames(strict, resync) == whole[0]
