"""Where a vehicle was by a dataflash log, as KML lines in the colours of PX4's main states (mavkml.py).

`mavwire map LOG --out track.kml` draws any log, with flight modes, home and mission.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from html import escape
from itertools import chain, count
from typing import Any

from mavwire.cli._errors import CommandError, tell
from mavwire.cli._output import refuse_log, writing
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

# The state that mavkml.py assumes at the start, and its name for it before the first STAT.
FIRST_STATE, NO_STATE = 0, -1
# Seconds between points, at least.
STEP = 0.1
# aabbggrr by main state; a state beyond them has the colour of none.
COLOURS = (
    "ff0000ff", "ff008000", "ffff0000", "ffee82ee", "ff00ffff", "ff00a5ff", "ff87b8de", "fffffff0",
    "ffe6d8ad", "ff00fc7c",
)  # fmt: skip
HEADER = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">
"""


class Line:
    """A stretch of one source in one main state: its points, as KML writes them."""

    def __init__(self, source: str, state: int) -> None:
        self.source = source
        self.state = state
        self.points: list[str] = []


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "no_timestamps", "condition")
    add = parser.add_argument
    add("--aoff", type=float, default=0.0, help="metres to add to the altitude")
    add("-o", "--output", metavar="FILE", default="mav.kml", help="(default: %(default)s)")
    add(
        "-s", "--source", metavar="TYPE", default="GPOS",
        help="message with Lat, Lon and Alt: GPOS (default) or GPS",
    )  # fmt: skip
    add("-e", "--extrude", action="store_true", help="walls from the lines to the ground")


def main(args: Namespace) -> int:
    refuse_log(args.output, args.logs)
    of_each = read_each("kml", args, lambda log: _lines(log, args), title="Processing {}")
    lines = list(chain.from_iterable(of_each))
    if not lines:
        hint = f"no {args.source} in the logs; `mavwire map LOG --out FILE.kml` draws any log"
        tell(f"mavwire kml: {hint}")
    with writing(args.output) as file:
        file.write(document(lines, args.extrude).encode())
    print(f"KML written to {args.output}")
    return 0


def _lines(log: Reading, args: Namespace) -> list[Line]:
    """The lines of one log, in the order in which they begin."""
    state, named = FIRST_STATE, NO_STATE
    lines: list[Line] = []
    line: Line | None = None
    last: float | None = None
    for msg in log.messages(("STAT", args.source), args.condition):
        kind = msg.get_type()
        if kind == "STAT" and hasattr(msg, "MainState"):
            named = msg.MainState
            if named != state:
                state, line, last = named, None, None
        if kind != args.source:
            continue
        if last is not None and msg._timestamp - last < STEP:
            continue
        last = msg._timestamp
        if line is None:
            line = Line(kind, named)
            lines.append(line)
        line.points.append(_point(log, msg, args.aoff))
    return lines


def _point(log: Reading, msg: Any, offset: float) -> str:
    try:
        return f"{msg.Lon},{msg.Lat},{msg.Alt + offset}"
    except AttributeError as error:
        kind = msg.get_type()
        raise CommandError(
            f"{log.path}: {kind} has no Lat, Lon and Alt; `mavwire map` finds positions by itself"
        ) from error


def document(lines: list[Line], extrude: bool) -> str:
    """A KML file with a placemark for each line."""
    ids = count(2)
    styles, places = [], []
    for line in lines:
        line_id, place_id, style_id, colour_id = (next(ids) for _ in range(4))
        state = line.state if 0 <= line.state < len(COLOURS) else 0
        styles.append(
            f'        <Style id="{style_id}">\n'
            f'            <LineStyle id="{colour_id}">\n'
            f"                <color>{COLOURS[state]}</color>\n"
            "                <colorMode>normal</colorMode>\n"
            "            </LineStyle>\n"
            "        </Style>\n"
        )
        wall = "                <extrude>1</extrude>\n" if extrude else ""
        places.append(
            f'        <Placemark id="{place_id}">\n'
            f"            <name>{escape(line.source)}:{line.state}</name>\n"
            f"            <styleUrl>#{style_id}</styleUrl>\n"
            f'            <LineString id="{line_id}">\n'
            f"{wall}"
            "                <altitudeMode>absolute</altitudeMode>\n"
            f"                <coordinates>{' '.join(line.points)}</coordinates>\n"
            "            </LineString>\n"
            "        </Placemark>\n"
        )
    if not lines:
        return f'{HEADER}    <Document id="1"/>\n</kml>\n'
    content = "".join(styles + places)
    return f'{HEADER}    <Document id="1">\n{content}    </Document>\n</kml>\n'
