"""The messages of logs at which a condition holds (mavsearch.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from mavwire.cli._message_types import wanted
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition", "types")
    parser.add_argument(
        "--stop", action="store_true", help="of each log, no more than the first of these types"
    )
    parser.add_argument(
        "--stopcondition", action="store_true", help="no more than the first that is found"
    )


def main(args: Namespace) -> int:
    read_each("search", args, lambda log: _search(log, args), title="Loading {} ...")
    return 0


def _search(log: Reading, args: Namespace) -> None:
    for msg in log.messages(wanted(args.types, log)):
        found = log.holds(args.condition)
        if found:
            print(msg)
        if args.stop or (found and args.stopcondition):
            return
