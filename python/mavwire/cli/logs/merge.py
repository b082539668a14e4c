"""Telemetry logs as one, in the order of time (mavmerge.py).

With --exact natively: every good record of damaged logs, times to the microsecond, no messages.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from contextlib import ExitStack
from heapq import merge
from operator import attrgetter

from mavwire.cli._errors import CommandError
from mavwire.cli._output import writing
from mavwire.cli._reading import definitions, reading
from mavwire.cli._telemetry import is_damaged, record, require_telemetry
from mavwire.dialects import UPSTREAM


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("logs", metavar="LOG", nargs="+", help="telemetry log, also .gz and .zst")
    parser.add_argument("-o", "--output", metavar="FILE", help="write the records to a log")
    parser.add_argument(
        "--exact", action="store_true", help="only write, fast, all that is good in damaged logs"
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="print no messages")


def main(args: Namespace) -> int:
    if args.exact:
        return _merge_exactly(args)
    with definitions(UPSTREAM, "2.0"), ExitStack() as stack:
        logs = [
            # One bar tells how far it is: they are read side by side.
            stack.enter_context(reading("merge", path, show_progress=number == 0))
            for number, path in enumerate(args.logs)
        ]
        for log in logs:
            require_telemetry(log)
        file = stack.enter_context(writing(args.output, args.logs)) if args.output else None
        for msg in merge(*(log.messages() for log in logs), key=attrgetter("_timestamp")):
            if is_damaged(msg):
                continue
            if not args.quiet:
                print(msg)
            if file is not None:
                file.write(record(msg))
    return 0


def _merge_exactly(args: Namespace) -> int:
    from functools import partial

    from mavwire.cli.logs._rewriting import run
    from mavwire.logs.rewriting import merge as merge_logs

    if args.output is None:
        raise CommandError("--exact writes a log: name it by --output")
    args.out, args.dialect = args.output, UPSTREAM
    return run("merge", args, args.logs, partial(merge_logs, args.logs, args.output))
