"""A bad link: frames that are lost, damaged, doubled, late or out of order, all from one seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from heapq import heappop, heappush
from random import Random
from typing import Generic, TypeVar

T = TypeVar("T")
# A link that delays must not grow without bound when nobody takes what it holds.
MAX_WAITING = 10_000


@dataclass(frozen=True)
class Impairment:
    """How bad a link is. Fractions between 0 and 1, times in seconds; the same in both directions."""

    loss: float = 0.0
    corruption: float = 0.0
    duplication: float = 0.0
    delay: float = 0.0
    jitter: float = 0.0

    def __post_init__(self) -> None:
        for name in ("loss", "corruption", "duplication"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} must be between 0 and 1: {getattr(self, name)}")
        for name in ("delay", "jitter"):
            if not 0 <= getattr(self, name) < 3600:
                reason = "must be at least 0 and less than an hour"
                raise ValueError(f"{name} {reason}: {getattr(self, name)} s")

    @property
    def perfect(self) -> bool:
        """Whether everything arrives at once and unharmed."""
        return self == PERFECT


PERFECT = Impairment()


@dataclass
class Counters:
    """Counters for the frames of one direction."""

    passed: int = 0
    lost: int = 0
    corrupted: int = 0
    duplicated: int = 0


class Channel(Generic[T]):
    """One direction of a bad link. `damage` makes a damaged copy, or None if nothing arrives then."""

    def __init__(
        self, impairment: Impairment, random: Random, damage: Callable[[Random, T], T | None]
    ) -> None:
        self._is = impairment
        self._random = random
        self._damage = damage
        self._waiting: list[tuple[float, int, T]] = []
        self._number = 0
        self.counters = Counters()

    def put(self, item: T, now: float) -> None:
        """Something sets out at `now` seconds."""
        link, chance, counters = self._is, self._random.random, self.counters
        if link.loss and chance() < link.loss:
            counters.lost += 1
            return
        sent: T | None = item
        if link.corruption and chance() < link.corruption:
            counters.corrupted += 1
            sent = self._damage(self._random, item)
        copies = 1
        if link.duplication and chance() < link.duplication:
            counters.duplicated += 1
            copies = 2
        if sent is None or len(self._waiting) >= MAX_WAITING:
            return
        for _ in range(copies):
            self._number += 1
            late = link.delay + (link.jitter * chance() if link.jitter else 0.0)
            heappush(self._waiting, (now + late, self._number, sent))
            counters.passed += 1

    def take(self, now: float) -> list[T]:
        """The items that have arrived by now."""
        arrived = []
        while self._waiting and self._waiting[0][0] <= now:
            arrived.append(heappop(self._waiting)[2])
        return arrived


def flip_bit(random: Random, frame: bytes) -> bytes:
    """A frame with one bit flipped anywhere."""
    place = random.randrange(len(frame))
    return frame[:place] + bytes((frame[place] ^ 1 << random.randrange(8),)) + frame[place + 1 :]
