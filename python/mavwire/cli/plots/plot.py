"""`mavwire plot LOG... EXPR... --out FILE`: values of logs over time, as an image or a page.

An expression is a field such as ATTITUDE.roll, or a formula of fields as mavgraph takes them:
"degrees(ATTITUDE.pitch)", "mag_field(RAW_IMU)", "BATTERY_STATUS[0].voltages[0]*0.001",
"VFR_HUD.alt{VFR_HUD.groundspeed>5}". With :2 behind it, it has the axis on the right. Flight modes
are shaded. FILE ends in .png, .svg or .pdf (needs matplotlib), or in .html, a page to zoom in.
"""

from __future__ import annotations

import argparse
import os

from mavwire._text import printable
from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._output import refuse_log
from mavwire.cli._shared_arguments import add_shared

LOG_SUFFIXES = (".tlog", ".bin", ".log", ".px4log", ".csv", ".raw", ".mavlink")
PACKED = (".gz", ".zst")
"""Suffixes after those. Alone they may be a field: XKF1.GZ."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "what",
        metavar="LOG or EXPR",
        nargs="+",
        help="logs, and what to plot of them, in any order",
    )
    parser.add_argument("-o", "--out", required=True, metavar="FILE", help="image or page")
    parser.add_argument("--labels", help="names for the legend, separated by commas")
    parser.add_argument("--title", help="default: the names of the logs")
    add_shared(parser, "condition")
    parser.add_argument("--xaxis", metavar="EXPR", help="plot over this in the place of time")
    add_shared(parser, "system")
    parser.add_argument(
        "--relative",
        action="store_true",
        help="seconds from the start of each log, to compare them",
    )
    parser.add_argument(
        "--timeshift", type=float, default=0.0, metavar="SECONDS", help="move the first log in time"
    )
    parser.add_argument(
        "--flightmode",
        choices=("apm", "px4"),
        help="whose flight modes they are (default: as the log says)",
    )
    parser.add_argument("--no-modes", action="store_true", help="do not shade flight modes")
    add_shared(parser, "any_dialect")
    parser.add_argument("--quiet", action="store_true", help="say nothing of what was left out")


def main(args: argparse.Namespace) -> int:
    from mavwire import plots

    logs = [one for one in args.what if is_log(one)]
    expressions = [one for one in args.what if not is_log(one)]
    if not logs:
        raise CommandError(f"there is no log among {', '.join(args.what)}")
    if not expressions:
        raise CommandError("no expression given: name a field, such as ATTITUDE.roll")
    refuse_log(args.out, logs, "--out")
    with refused(ValueError, ImportError):
        done = plots.plot(
            logs,
            expressions,
            args.out,
            labels=None if args.labels is None else args.labels.split(","),
            title=args.title,
            condition=args.condition,
            xaxis=args.xaxis,
            system=args.system,
            relative=args.relative,
            timeshift=args.timeshift,
            modes=not args.no_modes,
            flightmode=args.flightmode,
            dialect=args.dialect,
        )
    if not args.quiet:
        for note in done.notes:
            tell(f"mavwire plot: {note}")
        print(printable(f"{done.path}: {done.points:,} points"))
    return 0


def is_log(name: str) -> bool:
    """Whether an argument is a file, or can only mean one."""
    stem, suffix = os.path.splitext(name.lower())
    plain = stem if suffix in PACKED else stem + suffix
    return os.path.exists(name) or plain.endswith(LOG_SUFFIXES)
