"""The parameters in logs, the newest value of each, or how they changed (mavparms.py)."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator

from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

TYPES = ("PARAM_VALUE", "PARM")
# Columns of QGroundControl's files: the ids of vehicle and autopilot, and the type float.
QGC_OWNER = "1 1"
QGC_TYPE = 9


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs")
    parser.add_argument("-c", "--changes", action="store_true", help="show only the changes")
    parser.add_argument("--qgc", action="store_true", help="write QGroundControl's format")


def main(args: Namespace) -> int:
    values: dict[str, float] = {}
    read_each("parms", args, lambda log: _read(log, values, args.changes), title="")
    if args.qgc:
        print("\n# # Vehicle-Id Component-Id Name Value Type\n")
    if not args.changes:
        for name in sorted(values):
            line = f"{name:<15} {values[name]:.6f}"
            line = f"{QGC_OWNER} {line} {QGC_TYPE}" if args.qgc else line
            print(line)
    return 0


def _read(log: Reading, values: dict[str, float], show_changes: bool) -> None:
    """Bring `values` to where they stand at the end of the log."""
    for name, value, stamp in _parameters(log):
        if show_changes and name in values and values[name] != value:
            clock = time.asctime(time.localtime(stamp))
            line = f"{clock} {name:<15} {values[name]:.6f} -> {value:.6f}"
            print(line)
        values[name] = value


def _parameters(log: Reading) -> Iterator[tuple[str, float, float]]:
    """Name, value and time of each parameter that the log tells."""
    for msg in log.messages(TYPES):
        if msg.get_type() == "PARAM_VALUE":
            name, value = msg.param_id, msg.param_value
        else:
            name, value = msg.Name, msg.Value
        if name:
            yield name, value, msg._timestamp
