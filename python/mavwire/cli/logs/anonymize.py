"""`mavwire anonymize LOG -o FILE`: a telemetry log without what tells who flew where.

Positions are shifted, all by the same degrees; serial numbers, call signs, passwords and the like
are emptied; signatures, keys, and messages that may hold anything are left out. Times, altitudes,
headings and magnetic fields stay: a log with a known flight in it can still be recognised.
"""

from __future__ import annotations

import argparse
from functools import partial

from mavwire.cli._errors import CommandError
from mavwire.cli.logs._rewriting import add_common, run


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_common(parser)
    parser.add_argument(
        "--shift",
        metavar="NORTH,EAST",
        help="degrees; the same for logs that belong together (default: made up)",
    )


def main(args: argparse.Namespace) -> int:
    from mavwire.logs.rewriting import anonymize

    work = partial(anonymize, args.log, args.out, shift=_shift(args.shift), dialect=args.dialect)
    return run("anonymize", args, [args.log], work)


def _shift(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        north, east = (float(one) for one in text.split(","))
    except ValueError as error:
        raise CommandError(f"--shift takes two numbers, NORTH,EAST, not {text!r}") from error
    return north, east
