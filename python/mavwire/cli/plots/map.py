"""`mavwire map LOG --out FILE`: where a vehicle was, coloured by flight mode, with home and mission.

FILE ends in .html (a page to zoom in, which needs no network), .kml or .gpx.
"""

from __future__ import annotations

import argparse

from mavwire._text import printable
from mavwire.cli._errors import refused
from mavwire.cli._output import refuse_log
from mavwire.cli._shared_arguments import add_shared


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_shared(parser, "log")
    parser.add_argument("-o", "--out", required=True, metavar="FILE", help=".html, .kml or .gpx")
    add_shared(parser, "system", "any_dialect")
    parser.add_argument("--quiet", action="store_true", help="no summary")


def main(args: argparse.Namespace) -> int:
    from mavwire import plots

    refuse_log(args.out, [args.log], "--out")
    with refused(ValueError, ImportError):
        track = plots.draw_map(args.log, args.out, system=args.system, dialect=args.dialect)
    if not args.quiet:
        waypoints = f", {len(track.waypoints)} waypoints" if track.waypoints else ""
        print(printable(f"{args.out}: {len(track.times):,} positions{waypoints}"))
    return 0
