"""`mavwire info LOG...`: what is in a log, at one glance.

It counts types, rates, senders, times, lost messages and bytes of no message, and tells the speed of
reading.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import Any

from mavwire._native import date_text
from mavwire._text import in_words, printable
from mavwire.cli._errors import tell
from mavwire.cli._foreign import warn_without_records
from mavwire.cli._progress import Progress
from mavwire.cli._reading import STANDARD_INPUT, definitions, standard_input
from mavwire.cli._shared_arguments import add_shared
from mavwire.dialects import UPSTREAM
from mavwire.logs.dialect import Dialects
from mavwire.logs.selection import DAY, YEAR
from mavwire.logs.summary import LogInfo
from mavwire.logs.unknown import kinds_of, unknown_text

LISTED = 5
"""Places that the table names; `--json` has more."""


@dataclass
class Summary:
    """The result of one pass over a log."""

    info: LogInfo
    size: int
    """Bytes of the file, which may be compressed."""
    seconds: float
    """Duration of reading."""
    telemetry: bool
    """Whether it is a telemetry log, which alone has senders."""
    dialect: Any = None
    """The module that a telemetry log was read with."""

    @property
    def times(self) -> tuple[float, float] | None:
        """The times of the first and the last message; None for a log without times."""
        count = self.info.count
        return (count.first, count.last) if self.info.stamped or count.last else None

    @property
    def since_start(self) -> bool:
        """Whether times are seconds since the autopilot's start, not since 1970."""
        from mavwire._native import gps_time

        # No clock that was set by GPS is earlier; without a fix there is the time since the start.
        stamped = self.telemetry and self.info.stamped
        return not stamped and self.info.count.last < gps_time(0, 0)

    def rate(self, count: int) -> float:
        """A number of messages per second of the log."""
        span = self.info.count.seconds
        return count / span if span > 0 else 0.0

    def as_dict(self) -> dict[str, Any]:
        """For `--json`: plain values, systems keyed `sysid/compid`."""
        info = self.info
        first, last = (info.messages and self.times) or (None, None)
        return {
            "path": info.path,
            "bytes": self.size,
            "messages": info.messages,
            "types": {name: one.messages for name, one in info.types.items()},
            "systems": {
                f"{sysid}/{compid}": {
                    "messages": one.count.messages, "lost": one.lost, "repeated": one.repeated
                }
                for (sysid, compid), one in sorted(info.senders.items())
            },
            "first": first,
            "last": last,
            "span": info.count.seconds,
            "lost": info.lost,
            "repeated": info.repeated,
            "bad_messages": info.bad_count,
            "bad_bytes": info.bad_bytes,
            "damage": info.damage,
            "read_seconds": self.seconds,
            "gaps": info.gaps,
            "times_back": info.times_back,
            "times_forward": info.times_forward,
            "bad": info.bad,
            "unknown": kinds_of(info.unknown),
            **(_details(info) if self.telemetry else {}),
        }  # fmt: skip


def _details(info: LogInfo) -> dict[str, Any]:
    """For `--json`: what only telemetry logs have."""
    return {
        "mavlink1": info.version1,
        "mavlink2": info.version2,
        "signed": info.signed,
        "stamped": info.stamped,
        "reboots": {f"{ids[0]}/{ids[1]}": one.reboots for ids, one in info.senders.items()},
        "shared": [f"{ids[0]}/{ids[1]}" for ids, one in info.senders.items() if one.shared],
    }


def _telemetry_lines(info: LogInfo) -> list[str]:
    again = f", {info.repeated:,} came again" if info.repeated else ""
    return [
        f"  lost     {info.lost:,} messages by sequence number{again}",
        f"  mavlink  {info.version1:,} of version 1, {info.version2:,} of version 2,"
        f" {info.signed_share:.0%} signed",
    ]


def _place_lines(info: LogInfo, dialect: Any) -> list[str]:
    lines = []
    if info.unknown:
        lines.append(f"  unknown  {unknown_text(info.unknown, dialect)}")
    if info.bad:
        places = ", ".join(f"{length:,} at {offset:,}" for offset, length in info.bad[:LISTED])
        more = ", ..." if info.bad_count > LISTED else ""
        lines.append(f"  damage   bytes {places}{more}")
    if info.gaps:
        gaps = ", ".join(f"{after - before:,.1f} s" for before, after in info.gaps[:LISTED])
        more = ", ..." if info.gap_count > LISTED else ""
        lines.append(f"  gaps     {info.gap_count:,} without a message: {gaps}{more}")
    reboots = [f"{s}/{c}: {one.reboots}" for (s, c), one in info.senders.items() if one.reboots]
    if reboots:
        lines.append(f"  reboots  {', '.join(reboots)}")
    if shared := ", ".join(f"{s}/{c}" for (s, c), one in info.senders.items() if one.shared):
        lines.append(
            f"  shared   {shared}: several vehicles use this id; its lost count is not reliable"
        )
    steps = [
        f"went {way} {times:,} times" + (f", by {_duration(far)}" if far else "")
        for way, times, far in (
            ("back", info.times_back, info.set_back),
            ("forward", info.times_forward, info.set_forward),
        )
        if times
    ]
    if steps:
        lines.append(f"  clock    {'; '.join(steps)}")
    return lines


def _duration(seconds: float) -> str:
    if seconds < 3 * DAY:
        return f"{seconds:,.1f} s"
    return f"{seconds / DAY:,.1f} days" if seconds < YEAR else f"{seconds / YEAR:,.1f} years"


def _time(summary: Summary) -> str:
    info = summary.info
    if not info.messages:
        return "none, there is no message"
    if summary.times is None:
        return "none, a log without times"
    first, last = summary.times
    if summary.since_start:
        begin, end = f"{first:,.3f}", f"{last:,.3f} s since start"
    else:
        begin, end = date_text(first), f"{date_text(last)} UTC"
    if not (info.set_back or info.times_forward):
        return f"{begin} to {end}, {info.count.seconds:,.1f} s"
    steps = "s without the steps of the clock"
    return f"first {begin}, last {end}, {info.count.seconds:,.1f} {steps}"


def table(summary: Summary) -> str:
    """The text that `mavwire info` prints. Names are the log's: none steers a terminal or looks like
    a row.
    """
    info, messages = summary.info, summary.info.messages
    speed = messages / summary.seconds if summary.seconds > 0 else 0.0
    lost, mavlink = _telemetry_lines(info) if summary.telemetry else ("", "")
    lines = [
        f"{printable(info.path)}: {summary.size:,} bytes, {messages:,} messages of"
        f" {len(info.types)} types",
        f"  time     {_time(summary)}",
        lost,
        f"  bad      {info.bad_bytes:,} bytes in {info.bad_count:,} pieces",
        mavlink,
        *_place_lines(info, summary.dialect),
        f"  file     cut off or damaged: {printable(info.damage)}" if info.damage else "",
        f"  read in  {summary.seconds:.3f} s, {speed:,.0f} messages/s",
    ]
    lines = [*filter(None, lines), ""]
    if info.senders:
        lines.append(f"  {'SYSTEM':<10}{'COUNT':>12}{'LOST':>10}{'REPEATED':>10}")
        lines += [
            f"  {f'{sysid}/{compid}':<10}{one.count.messages:>12,}{one.lost:>10,}{one.repeated:>10,}"
            for (sysid, compid), one in sorted(info.senders.items())
        ]
        lines.append("")
    timed = bool(messages) and summary.times is not None
    lines.append(f"  {'TYPE':<32}{'COUNT':>12}" + (f"{'PER SECOND':>14}" if timed else ""))
    for kind, count in info.types.items():
        rate = f"{summary.rate(count.messages):>14,.2f}" if timed else ""
        lines.append(f"  {printable(kind):<32}{count.messages:>12,}{rate}")
    return "\n".join(lines)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = "Types, rates, senders, time range, losses and bad bytes of logs."
    parser.add_argument(
        "logs",
        metavar="LOG",
        nargs="+",
        help="telemetry log (.tlog), stream of frames without times (.raw), or dataflash log (.BIN, .log as text),"
        " plain, .gz or .zst; - for standard input",
    )
    add_shared(parser, "any_dialect")
    parser.add_argument("--json", action="store_true", help="print one JSON object for each log")


def main(args: argparse.Namespace) -> int:
    """Run the subcommand; 1 where a log could not be read."""
    with definitions(args.dialect):  # says once, before any log, that there is no such dialect
        pass
    failed = 0
    for number, path in enumerate(args.logs):
        with standard_input() if path == "-" else nullcontext(path) as file:
            failed += not _show(file, path, args, apart=number > 0)
    return 1 if failed else 0


def _show(path: str, name: str, args: argparse.Namespace, apart: bool) -> bool:
    """Print what is in the log `name`, or say on standard error that it is none; whether it is."""
    try:
        summary = read(path, args.dialect, name)
    except (OSError, ValueError, ImportError) as error:
        tell(f"mavwire info: {name}: {in_words(error, path)}")
        return False
    called = STANDARD_INPUT if name == "-" else name
    if not summary.info.messages and warn_without_records("info", path, args.dialect, called):
        return False
    if args.json:
        print(json.dumps(summary.as_dict()))
    else:
        print(("\n" if apart else "") + table(summary))
    return True


def read(path: str, dialect: Dialects = UPSTREAM, name: str | None = None) -> Summary:
    """Count a log, which is called `name`. OSError for a file that cannot be read, ValueError for a
    file that is not a log.
    """
    from mavwire.links.recognise import check_usable, no_such_log
    from mavwire.logs import TelemetryLog, open_log

    check_usable(path, creating=False)
    if not os.path.isfile(path):
        raise ValueError("not a log file") if os.path.exists(path) else no_such_log(path)
    log = open_log(path, dialect=dialect)
    size = os.path.getsize(path)
    began = time.perf_counter()
    with Progress(path) as progress:
        info = log.info(lambda read: progress.update_bytes(read, size))
    info = replace(info, path=name or path)
    seconds, is_telemetry = time.perf_counter() - began, isinstance(log, TelemetryLog)
    return Summary(info, size, seconds, is_telemetry, getattr(log, "dialect", None))
