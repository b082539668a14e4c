"""Common parts of the subcommands that write a log: options, progress and report."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections.abc import Callable

from mavwire._signals import ended_in_order
from mavwire._text import printable
from mavwire.cli._errors import CommandError, refused
from mavwire.cli._foreign import warn_without_records
from mavwire.cli._progress import Progress
from mavwire.cli._shared_arguments import add_shared
from mavwire.logs.rewriting import Rewritten


def add_common(parser: ArgumentParser) -> None:
    """LOG, --out, --dialect and --quiet."""
    parser.add_argument("log", metavar="LOG", help="telemetry log or raw stream, also .gz and .zst")
    parser.add_argument("-o", "--out", required=True, metavar="FILE", help="log to write")
    add_shared(parser, "any_dialect")
    parser.add_argument("--quiet", action="store_true", help="no report and no progress")


def run(command: str, args: Namespace, logs: list[str], work: Callable[..., Rewritten]) -> int:
    """Let `work(progress=)` write `args.out`, and print a report."""
    if args.out == "-":
        raise CommandError("--out is a file, not standard output: ./- is a file of that name")
    size = sum(os.path.getsize(log) for log in logs if os.path.isfile(log))
    refusing, bar = refused(ValueError, ImportError), Progress(args.out, enabled=not args.quiet)
    with bar, refusing, ended_in_order():
        done = work(progress=lambda read: bar.update_bytes(read, size))
    if not done.records:
        for log in logs:
            warn_without_records(command, log, args.dialect)
    if not args.quiet:
        print(report(args.out, done))
    return 0


def report(out: str, done: Rewritten) -> str:
    """The lines of the report."""
    lines = [f"{printable(out)}: {done.written:,} of {done.records:,} records"]
    if done.bad_bytes:
        lines.append(
            f"  left out {done.bad_bytes:,} bytes in {done.bad_places:,} places: no record"
        )
    if done.restamped:
        lines.append(f"  replaced {done.restamped:,} times that damage made implausible")
    if done.damage:
        lines.append(f"  the compressed log is cut off or damaged: {done.damage}")
    return "\n".join(lines)
