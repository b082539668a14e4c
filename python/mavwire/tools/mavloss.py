"""Messages lost on the way, by gaps in the sequence numbers of each sender (mavloss.py)."""

from __future__ import annotations

from mavwire.cli._reading import definitions, reading
from mavwire.tools._arguments import (
    add_condition,
    add_dialect,
    add_logs,
    add_no_timestamps,
    add_planner,
    add_robust,
)
from mavwire.tools._telemetry import require_telemetry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterable
    from typing import Any

# A radio reports about the link itself and does not number what it sends.
RADIO = (51, 68)
BAD_CHECKSUM = "invalid MAVLink CRC"


def add_arguments(parser: ArgumentParser) -> None:
    """mavloss.py's options."""
    add_logs(parser)
    add_condition(parser)
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
            losses = Losses(args.sysid, args.compid)
            losses.read(log.messages(condition=args.condition))
        print("\n".join(losses.table()))
        if args.stats:
            print("\n".join(losses.types_table()))
    return 0


class Sender:
    """One component of a system: how many messages it sent, and how many of them did not come."""

    def __init__(self, sysid: int, compid: int, seq: int) -> None:
        self.sysid = sysid
        self.compid = compid
        self.seq = seq
        self.packets = 0
        self.lost = 0
        self.types: dict[str, list[int]] = {}
        """Type -> messages seen, gaps before one of them, messages missing in these gaps."""


class Losses:
    """What is missing between the messages of a log."""

    def __init__(self, sysid: int | None = None, compid: int | None = None) -> None:
        self.senders: dict[tuple[int, int], Sender] = {}
        self.reasons: dict[str, None] = {}
        self._sysid = sysid
        self._compid = compid

    def read(self, messages: Iterable[Any]) -> None:
        """Count messages in the order in which they came."""
        senders = self.senders
        for msg in messages:
            msgid = msg.get_msgId()
            if msgid < 0:
                if msgid == -1:
                    self._add_reason(msg.reason)
                continue
            key = (msg.get_srcSystem(), msg.get_srcComponent())
            if not self._counts(key):
                continue
            seq = msg.get_seq()
            sender = senders.get(key)
            if sender is None:
                sender = senders[key] = Sender(*key, seq - 1)
            lost = (seq - sender.seq - 1) & 255
            sender.seq = seq
            sender.packets += 1
            sender.lost += lost
            of_type = sender.types.setdefault(msg.get_type(), [0, 0, 0])
            of_type[0] += 1
            if lost:
                of_type[1] += 1
                of_type[2] += lost

    def _counts(self, key: tuple[int, int]) -> bool:
        return key != RADIO and self._sysid in (None, key[0]) and self._compid in (None, key[1])

    def _add_reason(self, reason: str) -> None:
        """Of checksums that are wrong the first one stands for all."""
        if reason.startswith(BAD_CHECKSUM) and any(
            one.startswith(BAD_CHECKSUM) for one in self.reasons
        ):
            return
        self.reasons[reason] = None

    def table(self) -> list[str]:
        """Lines about the senders, all of them together, and what was damaged."""
        lines = ["  sysid    compid      packets       lost   loss%"]
        lines += [
            f"  {one.sysid:<8} {one.compid:<8} {one.packets:>10} {one.lost:>10} {_rate(one):>7}"
            for one in sorted(self.senders.values(), key=lambda one: -one.packets)
        ]
        total = Sender(0, 0, 0)
        total.packets = sum(one.packets for one in self.senders.values())
        total.lost = sum(one.lost for one in self.senders.values())
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
        rows = [
            (one, kind, counts)
            for one in self.senders.values()
            for kind, counts in one.types.items()
            if counts[1]
        ]
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
