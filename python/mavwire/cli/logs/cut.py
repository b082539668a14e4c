"""`mavwire cut LOG -o FILE`: some of the records of a telemetry log as a log of their own.

By message type, system and time. Bytes that belong to no record are left out.
"""

from __future__ import annotations

import argparse
from functools import partial

from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._values import split, systems_of, time_of
from mavwire.cli.logs._rewriting import add_common, run


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_common(parser)
    add_shared(parser, "types", "systems", "start", "end")


def main(args: argparse.Namespace) -> int:
    from mavwire.logs.rewriting import cut

    work = partial(
        cut, args.log, args.out, split(args.types, "--types"), systems_of(args.systems),
        time_of(args.start), time_of(args.end), dialect=args.dialect,
    )  # fmt: skip
    return run("cut", args, [args.log], work)
