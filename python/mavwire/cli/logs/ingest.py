"""`mavwire ingest LOG... -o LAKE`: many logs to one Delta Lake table for each message type.

A second run adds only new logs, and replaces the rows of logs that changed. Rows have the path of
their log and its SHA-256 in the columns `log` and `digest`. DuckDB, polars and Spark read the tables.
LOG may be a pattern or a URL. --workers makes the files on processes of this machine, --scheduler on
a Dask cluster, and --shard in jobs of a batch system that run at the same time. Needs
pip install 'mavwire[lake]'.
"""

from __future__ import annotations

import argparse
import re

from mavwire._signals import ended_in_order
from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._progress import Progress
from mavwire.cli.logs._query_arguments import add_query, query_of
from mavwire.cli.logs._told_rows import tell_rows


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "logs", metavar="LOG", nargs="*", help="telemetry or dataflash log, also .gz and .zst"
    )
    parser.add_argument("-o", "--out", required=True, metavar="LAKE", help="folder of the tables")
    add_query(parser)
    parser.add_argument(
        "--partition",
        default="day,vehicle",
        help="folders of a table, some of day, month, year (of the start of the log) and vehicle (system "
        "id of the sender), or '' for none (default: day,vehicle)",
    )
    parser.add_argument(
        "--compact", action="store_true", help="then merge small files into some of 64 to 256 MB"
    )
    runner = parser.add_mutually_exclusive_group()
    runner.add_argument("--workers", type=int, metavar="N", help="processes of this machine")
    runner.add_argument("--scheduler", metavar="ADDRESS", help="of a cluster: tcp://host:8786")
    parser.add_argument(
        "--shard", metavar="N/JOBS", help="do the logs of one of several jobs: 3/16"
    )
    parser.add_argument("--quiet", action="store_true", help="no summary and no progress")


def main(args: argparse.Namespace) -> int:
    """Run the subcommand; 1 where a log could not be read."""
    if not args.logs and not args.compact:
        raise CommandError("name logs, or --compact to merge files")
    from mavwire import lake

    refusing, bar = refused(ValueError, ImportError), Progress("", enabled=not args.quiet)
    with bar, refusing, ended_in_order():
        rows = lake.ingest(
            args.logs,
            args.out,
            args.scheduler,
            workers=args.workers,
            partition=[one for one in args.partition.split(",") if one],
            shard=_shard(args.shard),
            progress=lambda done, logs: bar.update(100.0 * done / logs, f"{logs:,} logs"),
            **query_of(args),
        ) if args.logs else []  # fmt: skip
        merged = lake.compact(args.out) if args.compact else {}
    new = [row for row in rows if row.error or not row.skipped]
    failed = tell_rows("ingest", "added", new, args)
    if len(new) < len(rows) and not args.quiet:
        print(f"{args.out}: {len(rows) - len(new):,} logs were added before")
    if failed:
        tell(f"mavwire ingest: {failed:,} of {len(rows):,} logs could not be read")
    if args.compact and not args.quiet:
        print(f"{args.out}: merged {sum(merged.values()):,} files of {len(merged)} tables")
    return 1 if failed else 0


def _shard(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    found = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text)
    if found is None:
        raise CommandError(
            f"--shard takes the number of a job and of how many, as 3/16, not {text!r}"
        )
    return int(found[1]), int(found[2])
