"""Damaged streams, cut into chunks in every way, through both parsers.

The default policy on damage is pymavlink's (a rejected frame's whole claimed length is dropped), so
BAD_DATA, counters and exceptions must be identical whatever the damage and whatever the chunks.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from types import ModuleType
from typing import Any

from differential import observe
from differential.frames import KEY, FrameMaker, Framing, Layout

CHUNKS = (1, 2, 3, 5, 7, 8, 9, 13, 21, 34, 64, 280, 1000, 1 << 20)
_STOP = "stop"


@dataclass(frozen=True)
class Receiver:
    """How the parser under comparison is set up."""

    robust: bool = True
    keyed: bool = False
    accept_unsigned: bool | None = None

    def make(self, dialect: ModuleType) -> Any:
        mav = dialect.MAVLink(None)
        mav.robust_parsing = self.robust
        if self.keyed:
            mav.signing.secret_key = KEY
        if self.accept_unsigned is not None:
            answer = self.accept_unsigned
            mav.signing.allow_unsigned_callback = lambda _mav, _msgid: answer
        return mav


def stream(seed: int, every: list[Layout], frames: int, signed: bool) -> bytes:
    """A stream of both framings, damaged: flipped bits, lost and doubled pieces, junk, markers,
    wrong lengths.
    """
    random = Random(seed)
    makers = [FrameMaker(seed, Framing(2, KEY if signed else None)), FrameMaker(seed, Framing(1))]
    small = [one for one in every if one.msgid < 256 and one.size < 120]
    pieces = []
    for _ in range(frames):
        maker = makers[random.random() < 0.2]
        frame = maker.frame(random.choice(small))
        pieces.append(_damaged(random, frame) if random.random() < 0.4 else frame)
    return b"".join(pieces)


def _damaged(random: Random, frame: bytes) -> bytes:
    place = random.randrange(len(frame))
    junk = random.randbytes(random.randrange(1, 12))
    choices = (
        lambda: (
            frame[:place] + bytes([frame[place] ^ 1 << random.randrange(8)]) + frame[place + 1 :]
        ),
        lambda: frame[:place],
        lambda: frame[place:],
        lambda: frame[:place] + frame[place + random.randrange(1, 9) :],
        lambda: frame[:place] + junk + frame[place:],
        lambda: junk + frame,
        lambda: random.choice((b"\xfd", b"\xfe", b"\xfd\xff\x01", b"\xfe\xfe\xfe")) + frame,
        lambda: frame[:1] + junk[:1] + frame[2:],
        lambda: frame[:2] + junk[:1] + frame[3:],
        lambda: frame[:place] + frame,
        lambda: frame + frame,
    )
    return random.choice(choices)()


def chunks(data: bytes, size: int, seed: int = 0) -> Iterator[bytes]:
    """The data in chunks of one size, or of random sizes up to `-size` when it is negative."""
    random, at = Random(seed), 0
    while at < len(data):
        step = size if size > 0 else random.randrange(1, -size + 1)
        yield data[at : at + step]
        at += step


def events(mav: Any, data: bytes, size: int, buffered: bool) -> Iterator[tuple[Any, ...]]:
    """What the parser answers and calls back, call by call, with its state after every call."""
    called: list[tuple[str, bool, bytes]] = []
    mav.set_callback(
        lambda msg: called.append((msg.get_type(), msg.get_signed(), bytes(msg.get_msgbuf())))
    )
    for chunk in chunks(data, size):
        call = mav.parse_buffer if buffered else mav.parse_char
        yield _answer(mav, called, lambda call=call, chunk=chunk: call(chunk))
        while mav.buf_len() and not buffered:
            before = mav.buf_len()
            answer = _answer(mav, called, lambda: mav.parse_char(b""))
            yield answer
            if answer[0] is None and mav.buf_len() == before:
                break


def _answer(mav: Any, called: list[tuple[str, bool, bytes]], call: Any) -> tuple[Any, ...]:
    called.clear()
    result = observe.raised(call)
    if isinstance(result, list):
        seen: Any = [observe.message(msg) for msg in result]
    elif result is None or isinstance(result, str):
        seen = result
    else:
        seen = observe.message(result)
    return seen, observe.parser(mav), tuple(called)


def compare(subject: Any, oracle: Any, data: bytes, size: int, buffered: bool) -> int:
    """Compare both parsers on one stream; the number of answers compared before a deliberate
    difference or the end.
    """
    ours = events(subject, data, size, buffered)
    theirs = events(oracle, data, size, buffered)
    count = 0
    while True:
        our, their = next(ours, _STOP), next(theirs, _STOP)
        if our == their == _STOP:
            return count
        if our != their:
            if oracle.signing.secret_key is not None and _on_purpose(our, their):
                return count
            raise AssertionError(
                f"answer {count}, chunks of {size}, {observe.difference(our, their)}\n"
                f" stream  {len(data)} bytes, {data.hex()[:400]}"
            )
        count += 1


def _on_purpose(our: Any, their: Any) -> bool:
    """Under a key mavwire deliberately differs in two ways, and counters differ from there on.

    Unknown ids pass pymavlink unverified and are subject to the policy here. A wrongly signed frame
    moves pymavlink's timestamp of the stream, so that it may refuse the next genuine frame, which
    is accepted here: whether it is genuine is computed, since a forged one must not be accepted.
    """
    delivered, by_oracle = our[2], their[2]
    if any(kind.startswith("UNKNOWN_") for kind, _, _ in by_oracle):
        return bool(delivered != by_oracle or our[1] != their[1])
    ours = {frame for _, signed, frame in delivered if signed}
    theirs = {frame for _, signed, frame in by_oracle if signed}
    return theirs < ours and all(map(_genuine, ours))


def _genuine(frame: bytes) -> bool:
    return hashlib.sha256(KEY + frame[:-6]).digest()[:6] == frame[-6:]
