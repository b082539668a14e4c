"""When and where logs were recorded, how far and how long they went (mavsummarize.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import Any, NamedTuple

from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli.logs._track import Track
from mavwire.links.inspect_message import local_time

TYPES = frozenset(("GPS_RAW_INT", "HEARTBEAT"))
# Bits of base_mode: MAV_MODE_FLAG_AUTO_ENABLED and MAV_MODE_FLAG_GUIDED_ENABLED.
AUTONOMOUS = 4 | 8
# MAV_TYPE_GCS
GROUND_STATION = 6
# 2009, in seconds since 1970. An earlier time is not a date, but a time since the vehicle's start.
EARLIEST = 1_230_768_000


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition", "no_timestamps", "dialect")


def main(args: Namespace) -> int:

    def tell(log: Reading) -> Summary | None:
        summary = summarise(log, args.condition)
        if summary is None:
            print("ERROR: No messages found.")
        else:
            summary.tell()
        return summary

    flights = [one for one in read_each("summarize", args, tell) if one is not None]
    print("===============================")
    print(f"Num Flights : {len(flights)}")
    print(f"Total distance : {sum(one.track.metres for one in flights):0.2f}m")
    print(f"Total time (mm:ss): {_clock(sum(one.seconds for one in flights))}")
    return 0


class Summary(NamedTuple):
    """A summary of a log. Times are in seconds. `dated` is the first time of a clock that was set."""

    began: float
    dated: float | None
    ended: float
    sections: int
    autonomous: float
    track: Track

    @property
    def seconds(self) -> float:
        """From the first message to the last one."""
        return self.ended - self.began

    def tell(self) -> None:
        """Print it."""
        print(self._start())
        if self.track.start is None:
            print("Warning: No GPS data found, can't give position summary.")
        else:
            print(f"Travelled from {self.track.start} to {self.track.end}")
            print(f"Total distance : {self.track.metres:0.2f}m")
        print(f"Total time (mm:ss): {_clock(self.seconds)}")
        print(f"Autonomous sections: {self.sections}")
        if self.sections > 0:
            print(f"Autonomous time (mm:ss): {_clock(self.autonomous)}")

    def _start(self) -> str:
        if self.dated is None:
            return (
                "Warning: No absolute timestamp found in datastream. "
                "No starting time can be provided for this log."
            )
        return f"Log started at about {local_time(self.dated)}"


def summarise(log: Reading, condition: str | None) -> Summary | None:
    """Read a log to its end; None if nothing of interest is in it."""
    track = Track()
    follow = track.follow
    began: float | None = None
    dated: float | None = None
    since: float | None = None
    autonomous, sections = 0.0, 0
    msg: Any = None
    for msg in log.messages(TYPES, condition):
        if dated is None:
            began = msg._timestamp if began is None else began
            dated = _date(msg)
        if msg.get_type() == "GPS_RAW_INT":
            follow(msg)
        elif msg.type == GROUND_STATION:
            continue
        elif not msg.base_mode & AUTONOMOUS:
            autonomous += msg._timestamp - since if since is not None else 0.0
            since = None
        elif since is None:
            sections += 1
            since = msg._timestamp
    if began is None:
        return None
    ended = msg._timestamp
    if since is not None:
        autonomous += ended - since
    return Summary(began, dated, ended, sections, autonomous, track)


def _date(msg: Any) -> float | None:
    """The time of a message by the log or by GPS; None if neither has a date. As in mavsummarize.py,
    microseconds are compared with EARLIEST too, so that 20 minutes are enough.
    """
    now: float = msg._timestamp
    if now >= EARLIEST:
        return now
    if msg.get_type() == "GPS_RAW_INT" and msg.time_usec >= EARLIEST:
        return float(msg.time_usec * 1.0e-6)
    return None


def _clock(seconds: float) -> str:
    """As mavsummarize.py writes it: minutes are rounded, not cut off."""
    return f"{seconds / 60:3.0f}:{seconds % 60:02.0f}"
