"""`mavwire convert LOG... -o OUT`: logs to Parquet, CSV, JSON lines, Arrow or MCAP files.

One folder for each message type, one file in it for each log; of MCAP one file for each log, which
Foxglove and PlotJuggler open. And a manifest with what became of every log: a second run does what
is missing. With --workers or --scheduler many logs are converted at the same time, by processes of
this machine or a Dask cluster; LOG may then be a URL too (needs
pip install 'mavwire[fleet]').
"""

from __future__ import annotations

import argparse
import os
from typing import Any

from mavwire._signals import ended_in_order
from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._progress import Progress
from mavwire.cli.logs._query_arguments import add_query, query_of
from mavwire.cli.logs._told_rows import tell_rows
from mavwire.logs.manifest import Converted


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from mavwire.logs.formats import COMPRESSIONS

    parser.add_argument(
        "logs", metavar="LOG", nargs="+", help="telemetry or dataflash log, also .gz and .zst"
    )
    parser.add_argument("-o", "--out", required=True, help="folder for the files")
    parser.add_argument("--format", choices=list(COMPRESSIONS), default="parquet")
    parser.add_argument(
        "--compression",
        choices=sorted({one for some in COMPRESSIONS.values() for one in some}),
        help="default: zstd for parquet and mcap, none for the others",
    )
    add_query(parser)
    parser.add_argument(
        "--from-unknown",
        action="store_true",
        help="read tables mavwire.unknown of an earlier run, with a dialect that defines more",
    )
    parser.add_argument(
        "--csv-safe",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="csv: write ' before a text that a spreadsheet would run as a formula (default: yes)",
    )
    cluster = parser.add_mutually_exclusive_group()
    cluster.add_argument("--workers", type=int, metavar="N", help="processes of this machine")
    cluster.add_argument("--scheduler", metavar="ADDRESS", help="of a cluster: tcp://host:8786")
    parser.add_argument("--quiet", action="store_true", help="no summary and no progress")


def main(args: argparse.Namespace) -> int:
    """Run the subcommand; 1 where a log could not be read, or none describes a wanted type."""
    if args.workers is not None and args.workers < 1:
        raise CommandError(f"--workers takes a number from 1 on, not {args.workers}")
    given = ("format", "compression", "csv_safe")
    options = {**{name: getattr(args, name) for name in given}, **query_of(args)}
    with Progress("", enabled=not args.quiet) as bar, refused(ValueError), ended_in_order():
        rows = _convert(args, options, bar)
    for problem in (undescribed := _undescribed(rows, options["types"] or [])):
        tell(f"mavwire convert: {problem}")
    failed = len(undescribed)
    failed += tell_rows("convert", "converted", rows, args, not undescribed, args.from_unknown)
    return 1 if failed else 0


def _is_fleet(args: argparse.Namespace) -> bool:
    return args.workers is not None or args.scheduler is not None


def _undescribed(rows: list[Converted], types: list[str]) -> list[str]:
    """The errors for types that none of the dataflash logs describes. A log may do without those of another."""
    from mavwire.logs.checks import no_record_type
    from mavwire.logs.reading import described_by
    from mavwire.logs.sources import is_dataflash

    written = {os.path.dirname(file) for row in rows for file in row.files}
    missing = [name for name in types if name not in written]
    known: set[str] = set()
    if missing and all(row.error is None and is_dataflash(row.path) for row in rows):
        for described in described_by([row.path for row in rows]):
            known.update(described)
            missing = [name for name in missing if name not in described]
            if not missing:
                break
        return [no_record_type(name, known, len(rows)) for name in missing]
    return []


def _convert(args: argparse.Namespace, options: dict[str, Any], bar: Progress) -> list[Converted]:
    if not _is_fleet(args):
        from mavwire.logs.conversion import convert

        with refused(ImportError):
            return convert(
                args.logs,
                args.out,
                progress=lambda log, done: bar.update(done, log),
                from_unknown=args.from_unknown,
                **options,
            )
    if args.from_unknown:
        raise CommandError("--from-unknown: not with --workers and --scheduler")
    from mavwire import fleet

    try:
        return fleet.convert(
            args.logs,
            args.out,
            args.scheduler,
            workers=args.workers,
            progress=lambda done, logs: bar.update(100.0 * done / logs, f"{logs:,} logs"),
            **options,
        )
    except ImportError as error:
        raise CommandError(str(error)) from error
    except OSError as error:
        if error.filename is not None:
            raise
        raise CommandError(str(error)) from error
