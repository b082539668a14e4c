"""`mavwire repair LOG -o FILE`: the good records of a damaged telemetry log, for any reader.

Bytes that belong to no record are left out. Times that damage made implausible are replaced by that
of the last good record: behind such bytes, and single ones days from the times in front and behind.
Says what it did.
"""

from __future__ import annotations

import argparse
from functools import partial

from mavwire.cli.logs._rewriting import add_common, run


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_common(parser)


def main(args: argparse.Namespace) -> int:
    from mavwire.logs.rewriting import repair

    return run(
        "repair", args, [args.log], partial(repair, args.log, args.out, dialect=args.dialect)
    )
