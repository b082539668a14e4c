"""Lines that commands print about the logs that they turned into tables."""

from __future__ import annotations

import argparse
from collections.abc import Iterable

from mavwire._text import printable
from mavwire.cli._errors import tell
from mavwire.cli._foreign import warn_without_records
from mavwire.logs.dialect import dialect_module
from mavwire.logs.manifest import Converted
from mavwire.logs.unknown import counts_of, unknown_text


def tell_rows(
    command: str,
    done: str,
    rows: Iterable[Converted],
    args: argparse.Namespace,
    tells_empty: bool = True,
    are_tables: bool = False,
) -> int:
    """Say what became of each log, or table of unknown messages; how many failed."""
    failed = 0
    for row in rows:
        is_empty = row.error is None and not row.rows and not row.skipped
        if is_empty and not row.unknown and not are_tables:
            warn_without_records(command, row.path, args.dialect)
        if row.error is not None:
            failed += not row.skipped  # what is damaged is damaged for ever
            tell(f"mavwire {command}: {row.path}: {row.error}")
        if row.unknown and args.unknown is None:
            text = unknown_text(counts_of(row.unknown), dialect_module(args.dialect))
            tell(f"mavwire {command}: {row.path}: left out: {text}")
        if not args.quiet and (row.rows or (row.error is None and tells_empty)):
            what = f"{done} before" if row.skipped else done
            files = f" in {len(row.files)} files" if row.files or not row.digest else ""
            bad = f", {row.bad_bytes:,} bytes were not part of any message" if row.bad_bytes else ""
            print(printable(f"{row.path}: {what}, {row.rows:,} rows{files}{bad}"))
    return failed
