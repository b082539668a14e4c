"""`mavwire info LOG...`: what is in a log, at one glance.

Types with counts and rates, who sent them, the time they span, what was lost on the way and what
could not be read, with the speed of reading. Telemetry logs are counted natively, by the way that
finds every good record (`TelemetryLog.info`), and so are dataflash logs; CSV files in one pass
through mavutil.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections import Counter
from contextlib import nullcontext
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from mavwire._log_link import open_link
from mavwire._native import date_text
from mavwire._text import in_words, printable
from mavwire.cli._errors import tell
from mavwire.cli._foreign import warn_without_records
from mavwire.cli._progress import Progress
from mavwire.cli._reading import STANDARD_INPUT, definitions, standard_input
from mavwire.dialects import UPSTREAM
from mavwire.logs.selection import DAY, YEAR
from mavwire.logs.unknown import named, unknown_text

if TYPE_CHECKING:
    from mavwire.logs.summary import LogInfo

PROGRESS_EVERY = 20_000
LISTED = 5
"""Places that the table names; `--json` has more."""


@dataclass
class System:
    """One sender: system and component id."""

    messages: int = 0
    lost: int = 0
    repeated: int = 0


@dataclass
class Summary:
    """What one pass over a log found."""

    path: str
    size: int = 0
    messages: int = 0
    types: Counter[str] = field(default_factory=Counter)
    systems: dict[tuple[int, int], System] = field(default_factory=dict)
    first: float | None = None
    last: float | None = None
    bad_messages: int = 0
    bad_bytes: int = 0
    seconds: float = 0.0
    since_start: bool = False
    """Whether times are seconds since the autopilot's start, not since 1970."""
    info: LogInfo | None = None
    """What only native counting finds; None for CSV files."""
    telemetry: bool = False
    """Whether it is a telemetry log, which alone has senders."""
    damage: str | None = None
    """What is wrong with a compressed file; everything before that is counted."""

    @property
    def span(self) -> float:
        """Seconds between the first and the last message. Steps of the clock take no time."""
        if self.info is not None:
            return self.info.count.seconds
        return (self.last or 0.0) - (self.first or 0.0)

    @property
    def lost(self) -> int:
        """Gaps in the sequence numbers of all senders."""
        return sum(system.lost for system in self.systems.values())

    @property
    def repeated(self) -> int:
        """Messages that were there before, of all senders."""
        return sum(system.repeated for system in self.systems.values())

    def rate(self, count: int) -> float:
        """A number of messages per second of the log."""
        return count / self.span if self.span > 0 else 0.0

    def as_dict(self) -> dict[str, Any]:
        """For `--json`: plain values, systems keyed `sysid/compid`."""
        return {
            "path": self.path,
            "bytes": self.size,
            "messages": self.messages,
            "types": dict(self.types.most_common()),
            "systems": {
                f"{sysid}/{compid}": asdict(one)
                for (sysid, compid), one in sorted(self.systems.items())
            },
            "first": self.first,
            "last": self.last,
            "span": self.span,
            "lost": self.lost,
            "repeated": self.repeated,
            "bad_messages": self.bad_messages,
            "bad_bytes": self.bad_bytes,
            "damage": self.damage,
            "read_seconds": self.seconds,
            **({} if self.info is None else _places(self.info)),
            **({} if self.info is None or not self.telemetry else _details(self.info)),
        }


def _places(info: LogInfo) -> dict[str, Any]:
    """For `--json`: where a log is damaged or interrupted."""
    return {
        "gaps": info.gaps,
        "times_back": info.times_back,
        "times_forward": info.times_forward,
        "bad": info.bad,
        "unknown": named(info.unknown),
    }


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


def summarise(log: Any, path: str, progress: Progress | None = None) -> Summary:
    """Read an open CSV or dataflash log, as `mavlink_connection` gives it, to its end."""
    summary = Summary(path, size=os.path.getsize(path))
    began = time.perf_counter()
    for number, msg in enumerate(iter(log.recv_msg, None), 1):
        summary.messages += 1
        summary.types[msg.get_type()] += 1
        summary.last = msg._timestamp
        if summary.first is None:
            summary.first = summary.last
        if progress is not None and number % PROGRESS_EVERY == 0:
            progress.update(getattr(log, "percent", 0.0))
    summary.bad_bytes += getattr(log, "junk_bytes", 0)
    # Without a GPS fix the clock of a dataflash log has no time base.
    summary.since_start = not getattr(getattr(log, "clock", None), "timebase", 0)
    summary.seconds = time.perf_counter() - began
    return summary


def summary_of(info: LogInfo, size: int, seconds: float, telemetry: bool = True) -> Summary:
    """The summary of a log that was counted natively."""
    from mavwire._dataflash.clocks import GPS_EPOCH

    summary = Summary(
        info.path, size, info.messages, seconds=seconds, info=info, telemetry=telemetry
    )
    summary.damage = info.damage
    summary.types = Counter({name: one.messages for name, one in info.types.items()})
    summary.systems = {
        ids: System(one.count.messages, one.lost, one.repeated) for ids, one in info.senders.items()
    }
    if info.messages and (info.stamped or info.count.last):
        summary.first, summary.last = info.count.first, info.count.last
        # No clock that was set by GPS is earlier; without a fix there is the time since the start.
        summary.since_start = not (telemetry and info.stamped) and info.count.last < GPS_EPOCH
    summary.bad_messages, summary.bad_bytes = info.bad_count, info.bad_bytes
    return summary


def _mavlink(info: LogInfo) -> str:
    return (
        f"  mavlink  {info.version1:,} of version 1, {info.version2:,} of version 2,"
        f" {info.signed_share:.0%} signed"
    )


def _place_lines(info: LogInfo) -> list[str]:
    lines = []
    if info.unknown:
        lines.append(f"  unknown  {unknown_text(named(info.unknown))}")
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


def _lost(summary: Summary) -> str:
    again = f", {summary.repeated:,} came again" if summary.repeated else ""
    return f"  lost     {summary.lost:,} messages by sequence number{again}"


def _time(summary: Summary) -> str:
    if summary.first is None or summary.last is None:
        return "none, there is no message" if not summary.messages else "none, a log without times"
    if summary.since_start:
        first, last = f"{summary.first:,.3f}", f"{summary.last:,.3f} s since start"
    else:
        first, last = date_text(summary.first), f"{date_text(summary.last)} UTC"
    info = summary.info
    if info is None or not (info.set_back or info.times_forward):
        return f"{first} to {last}, {summary.span:,.1f} s"
    return f"first {first}, last {last}, {summary.span:,.1f} s without the steps of the clock"


def _bad(summary: Summary) -> str:
    """Bytes that belong to no message; the pieces are not counted in dataflash logs."""
    if summary.bad_bytes and not summary.bad_messages:
        return f"{summary.bad_bytes:,} bytes"
    return f"{summary.bad_bytes:,} bytes in {summary.bad_messages:,} pieces"


def table(summary: Summary) -> str:
    """The text that `mavwire info` prints. Names are the log's: none steers a terminal or looks like
    a row.
    """
    speed = summary.messages / summary.seconds if summary.seconds > 0 else 0.0
    lines = [
        f"{printable(summary.path)}: {summary.size:,} bytes, {summary.messages:,} messages of"
        f" {len(summary.types)} types",
        f"  time     {_time(summary)}",
        *([_lost(summary)] if summary.telemetry else []),
        f"  bad      {_bad(summary)}",
        *([_mavlink(summary.info)] if summary.info is not None and summary.telemetry else []),
        *([] if summary.info is None else _place_lines(summary.info)),
        *(
            [f"  file     cut off or damaged: {printable(summary.damage)}"]
            if summary.damage
            else []
        ),
        f"  read in  {summary.seconds:.3f} s, {speed:,.0f} messages/s",
        "",
    ]
    if summary.systems:
        lines.append(f"  {'SYSTEM':<10}{'COUNT':>12}{'LOST':>10}{'REPEATED':>10}")
        lines += [
            f"  {f'{sysid}/{compid}':<10}{one.messages:>12,}{one.lost:>10,}{one.repeated:>10,}"
            for (sysid, compid), one in sorted(summary.systems.items())
        ]
        lines.append("")
    timed = summary.first is not None
    lines.append(f"  {'TYPE':<32}{'COUNT':>12}" + (f"{'PER SECOND':>14}" if timed else ""))
    for kind, count in sorted(summary.types.items(), key=lambda item: (-item[1], item[0])):
        rate = f"{summary.rate(count):>14,.2f}" if timed else ""
        lines.append(f"  {printable(kind):<32}{count:>12,}{rate}")
    return "\n".join(lines)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the subcommand."""
    parser.description = "Types, rates, senders, time range, losses and bad bytes of logs."
    parser.add_argument(
        "logs", metavar="LOG", nargs="+", help="telemetry or dataflash log; - for standard input"
    )
    parser.add_argument("--dialect", help="dialect to read telemetry with (default: all)")
    parser.add_argument("--json", action="store_true", help="print one JSON object for each log")


def main(args: argparse.Namespace) -> int:
    """Run the subcommand; 1 where a log could not be read."""
    if args.dialect is not None:
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
        summary = read(path, args.dialect)
    except (OSError, ValueError, ImportError) as error:
        tell(f"mavwire info: {name}: {in_words(error, path)}")
        return False
    called = STANDARD_INPUT if name == "-" else name
    if not summary.messages and warn_without_records(
        "info", path, args.dialect or UPSTREAM, called
    ):
        return False
    summary.path = name
    if args.json:
        print(json.dumps(summary.as_dict()))
    else:
        print(("\n" if apart else "") + table(summary))
    return True


def read(path: str, dialect: str | None = None) -> Summary:
    """What is in a log. OSError for a file that cannot be read, ValueError for what is no log."""
    from mavwire.links.recognise import check_usable, no_such_log

    check_usable(path, creating=False)
    if not os.path.isfile(path):
        raise ValueError("not a log file") if os.path.exists(path) else no_such_log(path)
    counted = _count(path, dialect)
    if counted is not None:
        return counted
    progress = Progress(path)
    try:
        log = open_link(path, dialect=dialect)
        try:
            return summarise(log, path, progress)
        finally:
            log.close()
    finally:
        progress.finish()


def _count(path: str, dialect: str | None) -> Summary | None:
    """What is in a telemetry or dataflash log; None for another file, which mavutil may know."""
    from mavwire.links.recognise import TELEMETRY, log_kind
    from mavwire.logs import TelemetryLog, open_log
    from mavwire.logs.sources import is_dataflash

    if log_kind(path, readonly=True) not in TELEMETRY and not is_dataflash(path):
        return None
    log = open_log(path, dialect=dialect or UPSTREAM)
    size = os.path.getsize(path)
    progress = Progress(path)
    began = time.perf_counter()
    try:
        info = log.info(lambda read: progress.update(min(100.0, 100.0 * read / max(size, 1))))
    finally:
        progress.finish()
    seconds = time.perf_counter() - began
    return summary_of(info, size, seconds, isinstance(log, TelemetryLog))
