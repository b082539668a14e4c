"""Realistic telemetry without hardware: an ArduCopter's message mix, written as a tlog.

`make demo`, the benchmarks and the tests need logs that look like real ones and are the same on
every machine: about 35 message types at the rates a ground station asks for, smooth values, MAVLink
2 with its zeros cut off, a ground station that answers. Everything follows from the seed. Losses,
damage, signing and MAVLink 1 are options.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

from .flight import Flight
from .telemetry import GROUND_STATION, START_US, TICK, VEHICLE, Values


@dataclass(frozen=True)
class Options:
    """The properties of the traffic; fractions are between 0 and 1."""

    messages: int = 100_000
    seed: int = 0
    systems: int = 1
    loss: float = 0.0
    corruption: float = 0.0
    version: int = 2
    signing_key: bytes | None = None

    def __post_init__(self) -> None:
        if self.messages < 0:
            raise ValueError(f"messages must not be negative: {self.messages}")
        if not 1 <= self.systems <= 250:
            raise ValueError(f"systems must be between 1 and 250: {self.systems}")
        for name in ("loss", "corruption"):
            if not 0 <= getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 0 and below 1: {getattr(self, name)}")
        if self.version not in (1, 2):
            raise ValueError(f"version must be 1 or 2: {self.version}")
        if self.signing_key is not None and (self.version == 1 or len(self.signing_key) != 32):
            raise ValueError("signing needs a key of 32 bytes and MAVLink 2")


@dataclass
class Written:
    """The content of a file by `generate`."""

    messages: int = 0
    bytes: int = 0
    corrupted: int = 0
    seconds: float = 0.0


class Sender:
    """One system: a MAVLink of its own, a flight and the messages it sends."""

    def __init__(
        self,
        dialect: ModuleType,
        options: Options,
        address: tuple[int, int],
        table: tuple[tuple[str, int, Values], ...],
        flight: Flight,
    ) -> None:
        self.mav: Any = dialect.MAVLink(None, srcSystem=address[0], srcComponent=address[1])
        if options.signing_key is not None:
            self.mav.signing.secret_key = options.signing_key
            self.mav.signing.sign_outgoing = True
            self.mav.signing.link_id = 1
            self.mav.signing.timestamp = (START_US - 1_420_070_400_000_000) // 10
        self.flight = flight
        self.version_1 = options.version == 1
        self.table = []
        for index, (name, period, values) in enumerate(table):
            message = getattr(dialect, f"MAVLink_{name.lower()}_message")
            if message.id < 256 or not self.version_1:
                self.table.append((message, period, index * 7 % period, values))

    def tick(self, number: int) -> Iterator[bytes]:
        """Frames of one tick of 0.1 s; the phases spread slow messages over time."""
        mav, flight, version_1 = self.mav, self.flight, self.version_1
        for message, period, phase, values in self.table:
            if number % period == phase:
                frame = message(*values(flight)).pack(mav, version_1)
                mav.seq = (mav.seq + 1) & 255
                yield frame


def frames(options: Options, dialect: ModuleType | None = None) -> Iterator[tuple[int, bytes]]:
    """Endless `(microseconds, frame)` pairs in order of time, before loss and damage.

    `dialect` is the dialect module that makes the messages, `mavwire.dialects.v20.ardupilotmega` by
    default.
    """
    if dialect is None:
        dialect = import_module("mavwire.dialects.v20.ardupilotmega")
    senders = []
    for number in range(options.systems):
        flight = Flight(options.seed * 1000 + number)
        senders.append(Sender(dialect, options, (number + 1, 1), VEHICLE, flight))
    senders.append(Sender(dialect, options, (255, 190), GROUND_STATION, senders[0].flight))
    tick = 0
    while True:
        for sender in senders[:-1]:
            sender.flight.advance(tick * TICK)
        batch = [frame for sender in senders for frame in sender.tick(tick)]
        step = int(TICK * 1e6) // (len(batch) + 1)
        now = START_US + int(tick * TICK * 1e6)
        for index, frame in enumerate(batch):
            yield (now + index * step) & ~3, frame
        tick += 1


def records(
    options: Options, dialect: ModuleType | None = None
) -> Iterator[tuple[int, bytes, bool]]:
    """`options.messages` triples of microseconds, frame, and whether the frame was damaged."""
    random = Random(options.seed)
    left = options.messages
    for microseconds, frame in frames(options, dialect):
        if left == 0:
            return
        if options.loss and random.random() < options.loss:
            continue
        left -= 1
        if options.corruption and random.random() < options.corruption:
            yield microseconds, _damaged(random, frame), True
        else:
            yield microseconds, frame, False


def _damaged(random: Random, frame: bytes) -> bytes:
    """One flipped bit behind the header: the checksum tells, and the frame keeps its length."""
    place = random.randrange(6 if frame[0] == 0xFE else 10, len(frame))
    return frame[:place] + bytes([frame[place] ^ 1 << random.randrange(8)]) + frame[place + 1 :]


def generate(
    path: str | os.PathLike[str],
    messages: int = 100_000,
    seed: int = 0,
    systems: int = 1,
    *,
    dialect: ModuleType | None = None,
    **more: Any,
) -> Written:
    """Write a tlog: records of 8 bytes of big-endian microseconds and one frame.

    `more` takes `loss` and `corruption` (fractions), `version` (1 or 2) and `signing_key` (32
    bytes). Raises `ValueError` for options out of range and `OSError` where the file cannot be
    written.
    """
    options = Options(messages=messages, seed=seed, systems=systems, **more)
    written = Written()
    first = last = START_US
    with Path(path).open("wb", buffering=1 << 20) as file:
        write = file.write
        for last, frame, damaged in records(options, dialect):
            written.bytes += write(last.to_bytes(8, "big")) + write(frame)
            written.corrupted += damaged
        written.messages = options.messages
        written.seconds = (last - first) / 1e6
    return written
