"""Messages lost on the way, by gaps in the sequence numbers of each sender (mavloss.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from typing import Any, NamedTuple

from mavwire._native import SequenceGaps
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._telemetry import is_damaged, require_telemetry

# A radio reports about the link itself and does not number what it sends.
RADIO = (51, 68)
BAD_CHECKSUM = "invalid MAVLink CRC"


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs")
    parser.add_argument("--condition", help="accepted; gaps are only seen if all are counted")
    add_shared(parser, "no_timestamps", "planner", "robust", "dialect")
    parser.add_argument("--stats", action="store_true", help="tell the types behind the gaps too")
    parser.add_argument("--sysid", type=int, help="only what this system sent")
    parser.add_argument("--compid", type=int, help="only what this component sent")


def main(args: Namespace) -> int:

    def tell(log: Reading) -> None:
        require_telemetry(log)
        losses = Losses(args.sysid, args.compid, args.stats)
        for chunk in log.chunks(args.condition):
            losses.read(chunk)
        print("\n".join(losses.table()))
        if args.stats:
            print("\n".join(losses.types_table()))

    read_each("loss", args, tell)
    return 0


class Sender(NamedTuple):
    """One component of a system: how many messages it sent, and how many of them did not come."""

    sysid: int
    compid: int
    packets: int = 0
    lost: int = 0


class Losses:
    """Gaps between the messages of a log. `sysid` and `compid` choose senders."""

    def __init__(
        self, sysid: int | None = None, compid: int | None = None, by_type: bool = False
    ) -> None:
        self.reasons: dict[str, None] = {}
        self._sysid = sysid
        self._compid = compid
        self._by_type = by_type
        self._gaps = SequenceGaps(by_type)

    def read(self, messages: Iterable[Any]) -> None:
        """Count messages in the order in which they came."""
        for msg in self._gaps.read(messages):
            if is_damaged(msg):
                self._add_reason(msg.reason)

    def _add_reason(self, reason: str) -> None:
        """Keep a reason once. Of wrong checksums only the first is kept."""
        if reason.startswith(BAD_CHECKSUM) and any(
            one.startswith(BAD_CHECKSUM) for one in self.reasons
        ):
            return
        self.reasons[reason] = None

    def _is_wanted(self, sysid: int, compid: int) -> bool:
        return (
            (sysid, compid) != RADIO
            and self._sysid in (None, sysid)
            and self._compid in (None, compid)
        )

    @property
    def senders(self) -> list[Sender]:
        """Those that count, the busiest first."""
        found: dict[tuple[int, int], Sender] = {}
        for sysid, compid, _, seen, _, lost, _ in self._gaps.rows():
            if self._is_wanted(sysid, compid):
                _, _, packets, before = found.get((sysid, compid), Sender(sysid, compid))
                found[sysid, compid] = Sender(sysid, compid, packets + seen, before + lost)
        return sorted(found.values(), key=lambda one: -one.packets)

    def table(self) -> list[str]:
        """Lines about the senders, all of them together, and what was damaged."""
        senders = self.senders
        lines = ["  sysid    compid      packets       lost   loss%"]
        lines += [
            f"  {one.sysid:<8} {one.compid:<8} {one.packets:>10} {one.lost:>10} {_rate(one):>7}"
            for one in senders
        ]
        packets, lost = (sum(one[column] for one in senders) for column in (2, 3))
        total = Sender(0, 0, packets, lost)
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
        """Lines about the types that a gap was noticed by, those with the most missing first.
        ValueError unless they were counted `by_type`.
        """
        if not self._by_type:
            raise ValueError("gaps were not counted by type")
        rows = [row for row in self._gaps.rows() if row[4] and self._is_wanted(*row[:2])]
        if not rows:
            return ["", "No message-type triggered any sequence gaps."]
        rows.sort(key=lambda row: (-row[5], row[6]))
        return [
            "",
            "Message types triggering loss-count increments:",
            "  sysid  compid msg_type                             seen   triggers       lost",
            *(
                f"  {sysid:<6} {compid:<6} {kind:<32} {seen:>8} {gaps:>10} {lost:>10}"
                for sysid, compid, kind, seen, gaps, lost, _ in rows
            ),
        ]


def _rate(one: Sender) -> str:
    sent = one.packets + one.lost
    return f"{one.lost * 100.0 / sent if sent else 0.0:.1f}%"
