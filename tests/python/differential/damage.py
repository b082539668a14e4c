"""Damaged logs: what disks, radios and crashes do to a telemetry log, from one seed."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

MARKERS = b"\xfd\xfe"


def _flip(log: bytearray, rand: Random) -> None:
    log[rand.randrange(len(log))] ^= 1 << rand.randrange(8)


def _set(log: bytearray, rand: Random) -> None:
    log[rand.randrange(len(log))] = rand.choice((0, 255, 0xFD, 0xFE, rand.randrange(256)))


def _delete(log: bytearray, rand: Random) -> None:
    start = rand.randrange(len(log))
    del log[start : start + rand.choice((1, 1, 2, 8, 30, 300))]


def _insert(log: bytearray, rand: Random) -> None:
    junk = rand.choice((rand.randbytes(rand.randrange(1, 60)), b"\xfd\xff\x01", b"\xfe", b"\xfd"))
    start = rand.randrange(len(log))
    log[start:start] = junk


def _zero(log: bytearray, rand: Random) -> None:
    start = rand.randrange(len(log))
    end = min(start + rand.choice((4, 64, 512)), len(log))
    log[start:end] = bytes(end - start)


def _repeat(log: bytearray, rand: Random) -> None:
    start = rand.randrange(len(log))
    log[start:start] = log[start : start + rand.randrange(1, 200)]


def _cut(log: bytearray, rand: Random) -> None:
    del log[rand.randrange(len(log)) :]


def _lengthen(log: bytearray, rand: Random) -> None:
    """Change the length that a frame claims."""
    markers = [at for at in range(len(log) - 1) if log[at] in MARKERS]
    if markers:
        log[rand.choice(markers) + 1] = rand.randrange(256)


def _jump(log: bytearray, rand: Random) -> None:
    """Change the upper bytes of what may be a timestamp."""
    markers = [at for at in range(8, len(log)) if log[at] in MARKERS]
    if markers:
        log[rand.choice(markers) - 8 + rand.randrange(4)] ^= 1 << rand.randrange(8)


DAMAGE: tuple[Callable[[bytearray, Random], None], ...] = (
    _flip, _set, _delete, _insert, _zero, _repeat, _cut, _lengthen, _jump,
)  # fmt: skip


def damaged(log: bytes, rand: Random) -> bytes:
    """A copy of `log` with one to six damages."""
    copy = bytearray(log)
    for _ in range(rand.choice((1, 1, 1, 2, 3, 6))):
        if copy:
            rand.choice(DAMAGE)(copy, rand)
    return bytes(copy)
