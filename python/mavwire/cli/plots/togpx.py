"""Where a vehicle was, as a GPX track beside the log (mavtogpx.py)."""

from __future__ import annotations

import math
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, NamedTuple

from mavwire.cli._message_types import tell_unknown
from mavwire.cli._output import refuse_log, writing
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

TYPES = ("GPS_RAW_INT", "GPS", "GPS2", "GLOBAL_POSITION_INT", "POS")
FIX_2D = 2
HEADER = """<?xml version="1.0" encoding="UTF-8"?>
<gpx
  version="1.0"
  creator="pymavlink"
  xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
  xmlns="http://www.topografix.com/GPX/1/0"
  xsi:schemaLocation="http://www.topografix.com/GPX/1/0 \
http://www.topografix.com/GPX/1/0/gpx.xsd">
<trk>
<trkseg>
"""
FOOTER = "</trkseg>\n</trk>\n</gpx>\n"


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")
    parser.add_argument("--nofixcheck", action="store_true", help="positions without a fix as well")
    parser.add_argument("--type", nargs="*", dest="types", help="message types to take it from")


def main(args: Namespace) -> int:
    for path in args.logs:
        refuse_log(f"{path}.gpx", args.logs, option="")
    read_each("togpx", args, lambda log: _write(log, args), title="")
    return 0


def _write(log: Reading, args: Namespace) -> None:
    """Write the track. After an error the file is as it was."""
    count, path = 0, f"{log.path}.gpx"
    with writing(path, option="") as file:
        file.write(HEADER.encode())
        for point in _points(log, args):
            file.write(point.encode())
            count += 1
        file.write(FOOTER.encode())
    print(f"Created {path} with {count} points")


class Point(NamedTuple):
    """A position: degrees, metres, metres a second. `course`, `speed` and `fix_type` are None where
    its message has no such field.
    """

    lat: float
    lon: float
    altitude: float
    course: float | None = None
    speed: float | None = None
    fix_type: int | None = None

    def filled_in(self, last: Point) -> Point:
        """The point with the missing values of the point before, of any type."""
        known = last._asdict()
        return self._replace(**{name: known[name] for name in known if getattr(self, name) is None})

    def gpx(self, stamp: float) -> str:
        """One point of a track."""
        return (
            f'<trkpt lat="{self.lat}" lon="{self.lon}">\n'
            f"  <ele>{self.altitude}</ele>\n"
            f"  <time>{_clock(math.floor(stamp))}</time>\n"
            f"  <course>{self.course}</course>\n"
            f"  <speed>{self.speed}</speed>\n"
            "  <fix>3d</fix>\n"
            "</trkpt>\n"
        )


@lru_cache(maxsize=1)
def _clock(second: int) -> str:
    """The time is local, though it says otherwise: mavtogpx.py's."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.localtime(second))


def _points(log: Reading, args: Namespace) -> Iterator[str]:
    last = Point(0.0, 0.0, 0.0, 0.0, 0.0, 0)
    tell_unknown(args.types or (), log)
    for msg in log.messages(args.types or TYPES, args.condition):
        point = _point(msg)
        if point is None:
            continue
        last = point = point.filled_in(last)
        has_fix = args.nofixcheck or (point.fix_type or 0) >= FIX_2D
        if has_fix and point.lat != 0.0 and point.lon != 0.0:
            yield point.gpx(msg._timestamp)


def _point(msg: Any) -> Point | None:
    kind = msg.get_type()
    if kind == "GPS_RAW_INT":
        lat, lon, alt = msg.lat / 1.0e7, msg.lon / 1.0e7, msg.alt / 1.0e3
        return Point(lat, lon, alt, msg.cog / 100.0, msg.vel / 100.0, msg.fix_type)
    if kind == "GLOBAL_POSITION_INT":
        lat, lon, alt = msg.lat / 1.0e7, msg.lon / 1.0e7, msg.alt / 1.0e3
        speed = math.sqrt(msg.vx**2 + msg.vy**2) / 100.0
        return Point(lat, lon, alt, msg.hdg / 100.0, speed)
    if kind in ("GPS", "GPS2"):
        return Point(msg.Lat, msg.Lng, msg.Alt, msg.GCrs, msg.Spd, msg.Status)
    if kind == "POS":
        return Point(msg.Lat, msg.Lng, msg.Alt)
    return None
