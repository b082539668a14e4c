"""How long a vehicle was in the air, by its speed over ground (mavflighttime.py)."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from typing import Any, NamedTuple

from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli.logs._track import FIX_3D, Track, minutes

TYPES = ("GPS_RAW_INT", "GPS")


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")
    parser.add_argument(
        "--groundspeed", type=float, default=3.0,
        help="metres a second above which it flies (default: %(default)s)",
    )  # fmt: skip


def main(args: Namespace) -> int:

    def read(log: Reading) -> Flight:
        flight = Flight(args.groundspeed)
        flight.read(log, args.condition)
        return flight

    flights = read_each("flighttime", args, read)
    print(f"Total time in air: {minutes(sum(one.seconds for one in flights))}")
    metres = sum(one.track.metres for one in flights)
    print(f"Total distance travelled: {metres:.1f} meters")
    return 0


class Fix(NamedTuple):
    """A GPS message in degrees and metres a second. `stamp` changes with every fix."""

    fix_type: int
    groundspeed: float
    lat: float
    lon: float
    stamp: int


def fix_of(msg: Any) -> Fix:
    """A position of a telemetry or a dataflash log."""
    if msg.get_type() == "GPS_RAW_INT":
        lat, lon = msg.lat / 1.0e7, msg.lon / 1.0e7
        return Fix(msg.fix_type, msg.vel * 0.01, lat, lon, msg.time_usec)
    stamp = msg.TimeUS if hasattr(msg, "TimeUS") else msg.TimeMS
    return Fix(msg.Status, msg.Spd, msg.Lat, msg.Lng, stamp)


class Flight:
    """The flights in one log: `seconds` in the air and the `track`."""

    def __init__(self, groundspeed: float) -> None:
        self.seconds = 0
        self.track = Track()
        self._groundspeed = groundspeed
        self._took_off: int | None = None

    def read(self, log: Reading, condition: str | None) -> None:
        """Add everything to the end of the log, and tell of each take-off and landing."""
        now = None
        for msg in log.messages(TYPES, condition):
            fix = fix_of(msg)
            if fix.fix_type < FIX_3D:
                continue
            now = int(msg._timestamp)
            self.track.add(fix.lat, fix.lon, fix.stamp)
            if self._took_off is None and fix.groundspeed > self._groundspeed:
                self._took_off = now
                self._tell("In air", now, f"{log.link.percent:.0f}", fix, "")
            elif self._took_off is not None and fix.groundspeed < self._groundspeed:
                lasted = now - self._took_off
                percent = f"{log.link.percent:.1f}"
                self._tell("On ground", now, percent, fix, f"  time={lasted:.1f} seconds")
                self.seconds += lasted
                self._took_off = None
        if self._took_off is not None and now is not None:
            self.seconds += now - self._took_off
        if self.seconds > 0:
            print(f"Flight time : {minutes(self.seconds)}")

    def _tell(self, what: str, now: int, percent: str, fix: Fix, lasted: str) -> None:
        clock = time.asctime(time.localtime(now))
        speed = f"groundspeed {fix.groundspeed:.1f}"
        print(f"{what} at {clock} (percent {percent}% {speed}{lasted})")
