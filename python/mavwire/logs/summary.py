"""`log.info()`: what is in a telemetry log, counted natively in one pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from mavwire._native import log_summary

GAP_SECONDS = 5.0


@dataclass(frozen=True)
class Count:
    """Messages, and the times of the first and the last in seconds since 1970."""

    messages: int
    first: float
    last: float
    seconds: float
    """Duration of the messages. Steps back of the clock, and steps forward of three days or more, do not
    count.
    """

    @property
    def rate(self) -> float:
        """Messages per second between the first and the last; 0 where that is no time."""
        return (self.messages - 1) / self.seconds if self.seconds > 0 else 0.0


@dataclass(frozen=True)
class Sender:
    """One component of one system."""

    count: Count
    lost: int
    """Messages lost by its sequence numbers."""
    repeated: int
    """Messages that were there before, as where two links hear the same."""
    reboots: int
    """The number of times that its clock (`time_boot_ms`) went back by more than 5 s. The wrap of the
    clock after 49.7 days is no reboot. 0 if several vehicles share the id.
    """
    shared: bool
    """Whether several vehicles send under this id. Their sequence numbers are mixed, so `lost` counts
    messages that were not lost.
    """

    @property
    def loss(self) -> float:
        """Share of its messages that are lost, 0 to 1."""
        sent = self.count.messages - self.repeated + self.lost
        return self.lost / sent if sent else 0.0


@dataclass(frozen=True)
class LogInfo:
    """The contents of a log. Lists of places have 1000 entries at most; the counts count all."""

    path: str
    bytes: int
    """Of the log, decompressed."""
    stamped: bool
    """False for a raw stream. Its times are seconds since the sender's start, 0 if unknown."""
    count: Count
    types: dict[str, Count]
    """By message name, the most frequent first; ids that the dialect lacks as UNKNOWN_<id>."""
    senders: dict[tuple[int, int], Sender]
    """By system and component id."""
    gaps: list[tuple[float, float]]
    """Spans of more than 5 s without a message: the times before and after."""
    gap_count: int
    times_back: int
    """Records with a time a millisecond or more before that of the record in front."""
    set_back: float
    """Seconds that the clock was set back in total."""
    times_forward: int
    """Records with a time three days or more behind that of the record in front."""
    set_forward: float
    """Seconds that the clock was set forward in total."""
    distrusted: int
    """Records behind damage whose time was days off and is replaced by that of the last good one."""
    bad: list[tuple[int, int]]
    """Bytes that belong to no record: offset and length."""
    bad_count: int
    bad_bytes: int
    version1: int
    """Messages of MAVLink 1."""
    version2: int
    signed: int
    """Messages that are signed."""
    damage: str | None = field(default=None)
    """The damage of the compressed file. Everything in front of it is counted."""
    unknown: dict[tuple[int, int] | None, int] = field(default_factory=dict)
    """Messages that the dialect does not define: `{(id, CRC_EXTRA): count}`, under None those of further
    kinds. `types` has them as UNKNOWN_<id>.
    """

    @property
    def messages(self) -> int:
        """All good messages."""
        return self.count.messages

    @property
    def lost(self) -> int:
        """Messages lost by the sequence numbers of all senders."""
        return sum(sender.lost for sender in self.senders.values())

    @property
    def repeated(self) -> int:
        """Messages that were there before, of all senders."""
        return sum(sender.repeated for sender in self.senders.values())

    @property
    def signed_share(self) -> float:
        """Signed messages among all, 0 to 1."""
        return self.signed / self.messages if self.messages else 0.0


def summarise(
    path: str, native_dialect: Any, pulse: Callable[[int], object] | None = None
) -> LogInfo:
    """Read a log to its end. `pulse` is told now and then how many bytes are read."""
    return info_of(path, log_summary(path, native_dialect, int(GAP_SECONDS * 1e6), pulse))


def info_of(path: str, found: dict[str, Any]) -> LogInfo:
    """The LogInfo of native counts."""
    types = {name: _count(row) for name, row in found.pop("types").items()}
    senders = {
        ids: Sender(_count(row), *counts) for ids, (row, *counts) in found.pop("senders").items()
    }
    count = _count(found.pop("count"))
    if unlisted := found.pop("unlisted"):
        types["UNKNOWN"] = Count(unlisted, 0, 0, 0)
    return LogInfo(
        path=path,
        count=count,
        types=dict(sorted(types.items(), key=lambda item: (-item[1].messages, item[0]))),
        senders=senders,
        gaps=[(before * 1e-6, after * 1e-6) for before, after in found.pop("gaps")],
        version2=count.messages - found["version1"] if senders else 0,
        **found,
    )


def _count(row: tuple[int, int, int, int]) -> Count:
    messages, *micros = row
    return Count(messages, *(one * 1e-6 for one in micros))
