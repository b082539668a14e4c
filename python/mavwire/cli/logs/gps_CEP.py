"""How far the positions of GPS receivers that stand still scatter (mavgps_CEP.py).

CEP50 is the radius of the circle that holds half of the positions, HEP50 the same for altitudes.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import defaultdict
from math import radians
from typing import Any

from mavwire._sphere import great_circle
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

# Type -> number of the receiver.
RECEIVERS = {"GPS": 1, "GPS_RAW_INT": 1, "GPS2_RAW": 2}
FIX_3D = 3
# Kinds of fix that are told apart, in the order of output; all others in three dimensions are one.
KINDS = {5: "RTK5", 6: "RTK6", FIX_3D: "NORM"}
# Fewer positions than this say too little.
LEAST = 101

Position = tuple[float, float, float]


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs")


def main(args: Namespace) -> int:
    found: dict[tuple[int, int, int], list[Position]] = defaultdict(list)

    def read(log: Reading) -> None:
        for msg in log.messages(RECEIVERS):
            kind = msg.get_type()
            fix = msg.Status if kind == "GPS" else msg.fix_type
            if fix >= FIX_3D:
                key = fix if fix in KINDS else FIX_3D, _sysid(log, msg), RECEIVERS[kind]
                found[key].append(_position(msg))

    read_each("gps_CEP", args, read)
    order = list(KINDS)
    for fix, sysid, receiver in sorted(found, key=lambda key: (order.index(key[0]), *key[1:])):
        points = found[fix, sysid, receiver]
        if len(points) >= LEAST:
            print(f"GPS-{KINDS[fix]} {sysid}:{receiver} {_scatter(points)} ({len(points)} points)")
    return 0


def _sysid(log: Reading, msg: Any) -> int:
    """The system id of the receiver. Dataflash logs have it as a parameter."""
    if hasattr(log.link, "mav"):
        return int(msg.get_srcSystem())
    return int(log.link.params.get("SYSID_THISMAV", 0))


def _position(msg: Any) -> Position:
    """Latitude and longitude in degrees, altitude in metres."""
    if msg.get_type() == "GPS":
        return msg.Lat, msg.Lng, msg.Alt
    return msg.lat * 1e-7, msg.lon * 1e-7, msg.alt * 1e-3


def _scatter(points: list[Position]) -> str:
    """How far half and how far 99% of the points are from the middle one."""
    middle = len(points) // 2
    lat, lon, alt = (sorted(column)[middle] for column in zip(*points, strict=True))
    away = sorted(
        great_circle(radians(lat), radians(lon), radians(one[0]), radians(one[1])) for one in points
    )
    heights = sorted(abs(one[2] - alt) for one in points)
    last = int(len(points) * 0.99)
    return (
        f"CEP50:{away[middle]:.3f}m CEP99:{away[last]:.2f}m"
        f" HEP50:{heights[middle]:.3f}m HEP99:{heights[last]:.3f}m"
    )
