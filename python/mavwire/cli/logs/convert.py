"""`mavwire convert LOG... -o OUT`: logs to Parquet, CSV, JSON lines, Arrow or MCAP files.

One folder for each message type, one file in it for each log; of MCAP one file for each log, which
Foxglove and PlotJuggler open. And a manifest with what became of every log: a second run does what
is missing. With --workers or --scheduler many logs are converted at the same time, by processes of
this machine or a Dask cluster; LOG may then be a pattern or a URL too (needs
pip install 'mavwire[fleet]').
"""

from __future__ import annotations

import argparse
import glob
import os
from typing import TYPE_CHECKING, Any

from mavwire._signals import ended_in_order
from mavwire._text import printable
from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._foreign import warn_without_records
from mavwire.cli._progress import Progress
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._values import split, systems_of, time_of
from mavwire.logs.dialect import dialect_module
from mavwire.logs.unknown import counts_of, unknown_text

if TYPE_CHECKING:
    from mavwire.logs.manifest import Converted


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the subcommand."""
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
    add_shared(parser, "types", "systems")
    parser.add_argument("--fields", help="fields to keep, separated by commas (default: all)")
    parser.add_argument("--units", choices=["si"], help="si: metres, volts, ... (default: as sent)")
    parser.add_argument("--enums", choices=["names"], help="names of values (default: numbers)")
    parser.add_argument(
        "--invalid",
        choices=["null", "keep"],
        help="null: leave out values that mean 'unknown', such as 65535 mV; keep: write them as sent "
        "(default: null with --units si and for mcap, else keep)",
    )
    parser.add_argument(
        "--unknown",
        choices=["table", "ignore"],
        help="messages that the dialect does not define: table: write them as mavwire.unknown; "
        "ignore: say nothing (default: say how many)",
    )
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
    add_shared(parser, "start", "end", "any_dialect")
    cluster = parser.add_mutually_exclusive_group()
    cluster.add_argument("--workers", type=int, metavar="N", help="processes of this machine")
    cluster.add_argument("--scheduler", metavar="ADDRESS", help="of a cluster: tcp://host:8786")
    parser.add_argument("--quiet", action="store_true", help="no summary and no progress")


def main(args: argparse.Namespace) -> int:
    """Run the subcommand; 1 where a log could not be read, or none describes a wanted type."""
    if args.workers is not None and args.workers < 1:
        raise CommandError(f"--workers takes a number from 1 on, not {args.workers}")
    given = ("format", "compression", "units", "enums", "invalid", "unknown", "csv_safe", "dialect")
    options = {
        **{name: getattr(args, name) for name in given},
        "types": split(args.types, "--types"),
        "systems": systems_of(args.systems),
        "fields": split(args.fields, "--fields"),
        "start": time_of(args.start),
        "end": time_of(args.end),
    }
    bar = Progress("", enabled=not args.quiet)
    try:
        with refused(ValueError), ended_in_order():
            rows = _convert(args, options, bar)
    finally:
        bar.finish()
    for problem in (undescribed := _undescribed(rows, options["types"] or [])):
        tell(f"mavwire convert: {problem}")
    failed = len(undescribed)
    for row in rows:
        is_empty = row.error is None and not row.files and not row.skipped
        if is_empty and not row.unknown and not args.from_unknown:
            warn_without_records("convert", row.path, args.dialect)
        if row.error is not None:
            failed += not row.skipped  # what is damaged is damaged for ever
            hint = "" if _is_fleet(args) else _hint(row.path, args.logs)
            tell(f"mavwire convert: {row.path}: {row.error}{hint}")
        if row.unknown and args.unknown is None:
            text = unknown_text(counts_of(row.unknown), dialect_module(args.dialect))
            tell(f"mavwire convert: {row.path}: left out: {text}")
        nothing = not row.files and (row.error is not None or undescribed)
        if not args.quiet and not nothing:
            done = "converted before" if row.skipped else "converted"
            bad = f", {row.bad_bytes:,} bytes were not part of any message" if row.bad_bytes else ""
            count = f"{row.rows:,} rows in {len(row.files)} files"
            print(printable(f"{row.path}: {done}, {count}{bad}"))
    return 1 if failed else 0


def _is_fleet(args: argparse.Namespace) -> bool:
    return args.workers is not None or args.scheduler is not None


def _hint(path: str, logs: list[str]) -> str:
    """Advice for a pattern that was taken as the name of a missing log."""
    patterns = {os.path.abspath(log) for log in logs if glob.has_magic(log)}
    if path not in patterns or os.path.lexists(path):
        return ""
    return "; patterns are taken with --workers or --scheduler"


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
