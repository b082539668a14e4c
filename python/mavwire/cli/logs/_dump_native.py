"""The common cases of `mavwire dump` in one native loop, without an object for each message."""

from __future__ import annotations

import os
from argparse import Namespace
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from mavwire.cli._reading import Reading
from mavwire.cli.logs._dump_format import Csv
from mavwire.cli.logs._dump_select import Selection
from mavwire.links.inspect_message import local_time

# Options whose meaning depends on more than the message itself.
SLOW_OPTIONS = (
    "follow", "no_timestamps", "planner", "verbose", "show_types", "show_loss", "reduce",
    "csv_safe", "event_definitions",
)  # fmt: skip


def options_fit(args: Namespace) -> bool:
    """Whether the native loop supports all options of the command line."""
    return (
        not any(getattr(args, name) for name in SLOW_OPTIONS)
        and args.format != "mat"
        and args.condition is None
        and args.reduce_rate <= 0
        and not (args.parms and args.output)
    )


def fits(args: Namespace, log: Any) -> bool:
    """Whether the native loop can dump this log with these options."""
    from mavwire import _native, mavutil

    return (
        type(log) in (mavutil.mavmmaplog, mavutil.mavlogfile)
        # The shadow has its own parser, which is to see everything.
        and type(log.mav).parse_char is _native.MAVLink.parse_char
        and not log.first_byte
        and not log.notimestamps
        and options_fit(args)
    )


def open_without_index(args: Namespace, path: str) -> Any:
    """A telemetry log without an index, which would cost time and memory. None where the output may
    differ from that with an index.
    """
    from mavwire import mavutil
    from mavwire._native import LogKind
    from mavwire.links.recognise import log_kind

    if args.types is not None or ":" in path or not options_fit(args):
        return None
    if not os.path.isfile(path) or log_kind(path, readonly=True) is not LogKind.TLOG:
        return None
    log = mavutil.mavlogfile(path)
    # After the first good record the state of the reader does not depend on what was read before.
    first = log.recv_msg()
    if first is None or first.get_msgId() < 0 or not fits(args, log):
        log.close()
        return None
    log.f.seek(0)
    return log


def dump(
    args: Namespace,
    log: Reading,
    selection: Selection,
    shape: Any,
    write: Callable[[bytes], Any],
    record: Callable[[bytes], Any] | None,
) -> None:
    """Dump a log that fits, from its position to its end."""
    from mavwire._native import dump_log

    def wanted(kind: str) -> bool:
        is_wanted = selection.wants(kind)
        if is_wanted and not args.quiet:
            log.count_unknown(kind)
        return is_wanted

    is_table = isinstance(shape, Csv)
    # The native loop reads these; see `rust/py/src/dump`.
    options = SimpleNamespace(
        format="none" if args.quiet else args.format,
        write=write,
        record=record,
        wanted=wanted,
        types=selection.visited,
        progress=log.progress.update,
        source_system=args.source_system,
        source_component=args.source_component,
        link=args.link,
        show_source=args.show_source,
        show_seq=args.show_seq,
        separator=shape.separator if is_table else ",",
        columns=shape.types if is_table else [],
        local_time=local_time,
    )
    dump_log(log.link, options)
