"""Options of commands that turn logs into tables: which records and fields, and how values are shown."""

from __future__ import annotations

import argparse
from typing import Any

from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._values import split, systems_of, time_of


def add_query(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    add_shared(parser, "types")
    parser.add_argument("--fields", help="fields to keep, separated by commas (default: all)")
    parser.add_argument(
        "--unknown",
        choices=["table", "ignore"],
        help="messages that the dialect does not define: table: write them as mavwire.unknown, in Parquet or "
        "Arrow for --from-unknown; ignore: say nothing (default: say how many)",
    )
    add_values(parser)


def add_values(parser: argparse.ArgumentParser) -> None:
    """Add the options for all types and fields."""
    add_shared(parser, "systems")
    parser.add_argument("--units", choices=["si"], help="si: metres, volts, ... (default: as sent)")
    parser.add_argument("--enums", choices=["names"], help="names of values (default: numbers)")
    parser.add_argument(
        "--invalid",
        choices=["null", "keep"],
        help="null: leave out values that mean 'unknown', such as 65535 mV; keep: write them as sent "
        "(default: null with --units si and for mcap, else keep)",
    )
    add_shared(parser, "start", "end", "any_dialect")


def query_of(args: argparse.Namespace) -> dict[str, Any]:
    """The arguments of `convert` and `ingest` that they become."""
    return {
        **values_of(args),
        "types": split(args.types, "--types"),
        "fields": split(args.fields, "--fields"),
        "unknown": args.unknown,
    }


def values_of(args: argparse.Namespace) -> dict[str, Any]:
    """The arguments of readers that the options of `add_values` become."""
    return {
        **{name: getattr(args, name) for name in ("units", "enums", "invalid", "dialect")},
        "systems": systems_of(args.systems),
        "start": time_of(args.start),
        "end": time_of(args.end),
    }
