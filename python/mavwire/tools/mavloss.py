"""Messages lost on the way, by gaps in the sequence numbers of each sender (mavloss.py)."""

from __future__ import annotations

from collections import Counter
from itertools import islice

from mavwire._native import Message
from mavwire.cli._reading import definitions, reading
from mavwire.tools._arguments import (
    add_dialect,
    add_logs,
    add_no_timestamps,
    add_planner,
    add_robust,
)
from mavwire.tools._telemetry import is_damaged, require_telemetry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterable
    from typing import Any

# A radio reports about the link itself and does not number what it sends.
RADIO = (51, 68)
# Few enough messages to stay in the processor's cache.
BATCH = 256
BAD_CHECKSUM = "invalid MAVLink CRC"


def add_arguments(parser: ArgumentParser) -> None:
    """mavloss.py's options."""
    add_logs(parser)
    parser.add_argument("--condition", help="accepted; gaps are only seen if all are counted")
    add_no_timestamps(parser)
    add_planner(parser)
    add_robust(parser)
    add_dialect(parser)
    parser.add_argument("--stats", action="store_true", help="tell the types behind the gaps too")
    parser.add_argument("--sysid", type=int, help="only what this system sent")
    parser.add_argument("--compid", type=int, help="only what this component sent")


def main(args: Namespace) -> int:
    """Run the subcommand."""
    for path in args.logs:
        print(f"Processing log {path}")
        with (
            definitions(args.dialect),
            reading(
                "loss", path, planner_format=args.planner, notimestamps=args.no_timestamps,
                robust_parsing=args.robust,
            ) as log,
        ):  # fmt: skip
            require_telemetry(log)
            losses = Losses(args.sysid, args.compid, args.stats)
            for chunk in log.chunks():
                losses.read(chunk)
        print("\n".join(losses.table()))
        if args.stats:
            print("\n".join(losses.types_table()))
    return 0


class Sender:
    """One component of a system: how many messages it sent, and how many of them did not come."""

    __slots__ = ("compid", "lost", "packets", "sysid", "types")

    def __init__(self, sysid: int, compid: int) -> None:
        self.sysid = sysid
        self.compid = compid
        self.packets = 0
        self.lost = 0
        self.types: dict[str, list[int]] = {}
        """Type -> messages seen, gaps before one of them, messages missing in these gaps."""


class Losses:
    """What is missing between the messages of a log. `sysid` and `compid` choose whose."""

    def __init__(
        self, sysid: int | None = None, compid: int | None = None, with_types: bool = False
    ) -> None:
        self.reasons: dict[str, None] = {}
        self._sysid = sysid
        self._compid = compid
        self._with_types = with_types
        self._all: dict[tuple[int, int], Sender] = {}
        self._next_seq: dict[tuple[int, int], int] = {}
        self._gaps: dict[tuple[Sender, str], None] = {}
        """Senders and types, in the order in which the first gap was seen before one."""

    def read(self, messages: Iterable[Any]) -> None:
        """Count messages in the order in which they came.

        Some at once: a loop that asks each message costs several times as much.
        """
        rest = iter(messages)
        while batch := list(islice(rest, BATCH)):
            self._read(batch)

    def _read(self, batch: list[Any]) -> None:
        if min(map(Message.get_msgId, batch), default=0) < 0:
            for msg in batch:
                self._skip(msg)
            batch = [msg for msg in batch if msg.get_msgId() >= 0]
        keys = list(
            zip(
                map(Message.get_srcSystem, batch),
                map(Message.get_srcComponent, batch),
                strict=True,
            )
        )
        self._count(keys, batch)
        next_seq = self._next_seq
        for key, seq, msg in zip(keys, map(Message.get_seq, batch), batch, strict=True):
            if next_seq.get(key, seq) != seq:
                self._add_gap(self._all[key], (seq - next_seq[key]) & 255, msg)
            next_seq[key] = (seq + 1) & 255

    def _count(self, keys: list[tuple[int, int]], batch: list[Any]) -> None:
        """How many messages each has sent, and of which types."""
        if not self._with_types:
            for key, count in Counter(keys).items():
                self._sender(key).packets += count
            return
        kinds = map(Message.get_type, batch)
        for (key, kind), count in Counter(zip(keys, kinds, strict=True)).items():
            sender = self._sender(key)
            sender.packets += count
            sender.types.setdefault(kind, [0, 0, 0])[0] += count

    def _sender(self, key: tuple[int, int]) -> Sender:
        sender = self._all.get(key)
        if sender is None:
            sender = self._all[key] = Sender(*key)
        return sender

    def _add_gap(self, sender: Sender, lost: int, msg: Any) -> None:
        """This message came behind a gap of `lost` messages."""
        sender.lost += lost
        if self._with_types:
            kind = msg.get_type()
            counts = sender.types[kind]
            counts[1] += 1
            counts[2] += lost
            self._gaps[sender, kind] = None

    @property
    def senders(self) -> list[Sender]:
        """Those that count, the busiest first."""
        wanted = (
            one
            for key, one in self._all.items()
            if key != RADIO and self._sysid in (None, key[0]) and self._compid in (None, key[1])
        )
        return sorted(wanted, key=lambda one: -one.packets)

    def _skip(self, msg: Any) -> None:
        if is_damaged(msg):
            self._add_reason(msg.reason)

    def _add_reason(self, reason: str) -> None:
        """Of checksums that are wrong the first one stands for all."""
        if reason.startswith(BAD_CHECKSUM) and any(
            one.startswith(BAD_CHECKSUM) for one in self.reasons
        ):
            return
        self.reasons[reason] = None

    def table(self) -> list[str]:
        """Lines about the senders, all of them together, and what was damaged."""
        senders = self.senders
        lines = ["  sysid    compid      packets       lost   loss%"]
        lines += [
            f"  {one.sysid:<8} {one.compid:<8} {one.packets:>10} {one.lost:>10} {_rate(one):>7}"
            for one in senders
        ]
        total = Sender(0, 0)
        total.packets = sum(one.packets for one in senders)
        total.lost = sum(one.lost for one in senders)
        lines.append(
            f"Total{self._filter()}: {total.packets} packets, {total.lost} lost {_rate(total)}"
        )
        if self.reasons:
            lines.append("Packet loss at least partially attributed to the following:")
            lines += [f"  * {reason}" for reason in self.reasons]
        return lines

    def _filter(self) -> str:
        parts = [
            f"{name}={value}"
            for name, value in (("sysid", self._sysid), ("compid", self._compid))
            if value is not None
        ]
        return f" [{','.join(parts)}]" if parts else ""

    def types_table(self) -> list[str]:
        """Lines about the types that a gap was noticed by, those with the most missing first."""
        wanted = set(self.senders)
        rows = [(one, kind, one.types[kind]) for one, kind in self._gaps if one in wanted]
        if not rows:
            return ["", "No message-type triggered any sequence gaps."]
        rows.sort(key=lambda row: -row[2][2])
        return [
            "",
            "Message types triggering loss-count increments:",
            "  sysid  compid msg_type                             seen   triggers       lost",
            *(
                f"  {one.sysid:<6} {one.compid:<6} {kind:<32} {seen:>8} {triggers:>10} {lost:>10}"
                for one, kind, (seen, triggers, lost) in rows
            ),
        ]


def _rate(one: Sender) -> str:
    sent = one.packets + one.lost
    return f"{one.lost * 100.0 / sent if sent else 0.0:.1f}%"


if __name__ == "__main__":
    from mavwire.tools._script import run

    run(__file__)
