"""Which messages fill logs: the share of each type and of groups of types (mavmsgstats.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import Counter
from fnmatch import fnmatchcase
from itertools import chain
from typing import Any

from mavwire._log_link import kind_of
from mavwire.cli._errors import CommandError
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

# Group -> patterns of its types. Types of no group are counted as OTHER.
GROUPS = {
    "EKF2": "NK*",
    "EKF3": "XK*",
    "SENSORS": "IMU* GPS* BAR* ACC GYR RFND",
    "RC": "RCIN RCOU",
    "TUNING": "CTUN NTUN RATE ATT PID*",
    "SYSTEM": "BAT* CMD EV MAV MODE",
    "REPLAY": "REVH RFRF RFRH RFRN RISH RISI RISJ RMGH RMGI ROFH RBCH RBCI RBOH RASH RASI REPH"
    " RSFH RGPH RGPI RGPJ RRNH RRNI RVOH RWOH RSO2 RSO3 RSSI",
}
OTHER = "OTHER"


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs")


def main(args: Namespace) -> int:

    def tell(log: Reading) -> None:
        print("\n".join(_table(_sizes(log))))

    read_each("msgstats", args, tell, dialect="all", wire_protocol="2.0")
    return 0


def _sizes(log: Reading) -> dict[str, int]:
    """Bytes of each type: the payloads of a telemetry log, the whole messages of another."""
    kind = kind_of(log.link)
    if kind == "CSV":
        raise CommandError(f"{log.path} is a CSV log; its rows have no size")
    if kind == "dataflash":
        every = chain.from_iterable(log.chunks())
        counts = Counter((msg.fmt.name, msg.fmt.len) for msg in every)
        totals: Counter[str] = Counter()
        for (kind, length), count in counts.items():
            totals[kind] += length * count
        # Of equal ones that comes first which the log describes first.
        return {name: totals[name] for name in (*log.link.name_to_id, *totals) if totals[name]}
    sizes: dict[str, int] = {}
    for msg in log.messages():
        if msg.get_msgId() >= 0:
            kind = msg.get_type()
            sizes[kind] = sizes.get(kind, 0) + msg.get_header().mlen
    return sizes


def _table(sizes: dict[str, int]) -> list[str]:
    total = sum(sizes.values())
    lines = [f"Total size: {total}"]
    if not total:
        return lines
    lines += [
        f"{kind:<4} {size * 100.0 / total:.2f}%"
        for kind, size in sorted(sizes.items(), key=lambda item: item[1])
    ]
    groups: Any = Counter()
    for kind, size in sizes.items():
        groups[_group(kind)] += size
    shares = {group: groups[group] * 100.0 / total for group in (*GROUPS, OTHER) if groups[group]}
    return [*lines, "", *(f"@{group} {share:.2f}%" for group, share in shares.items())]


def _group(kind: str) -> str:
    for group, patterns in GROUPS.items():
        if any(fnmatchcase(kind, pattern) for pattern in patterns.split()):
            return group
    return OTHER
