"""A telemetry log as one log for each system in it (mavsplit_sysid.py)."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from contextlib import ExitStack

from mavwire.cli._message_types import wanted
from mavwire.cli._output import OutputFile, writing
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._telemetry import is_damaged, record, require_telemetry


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "no_timestamps", "condition", "types")


def main(args: Namespace) -> int:
    read_each("split_sysid", args, lambda log: _split(log, args), title="Processing {}")
    return 0


def _split(log: Reading, args: Namespace) -> None:
    """Write each message to the log of who sent it."""
    require_telemetry(log)
    stem = os.path.splitext(log.path)[0]
    files: dict[int, OutputFile] = {}
    with ExitStack() as stack:
        for msg in log.messages(wanted(args.types or None, log), args.condition):
            if is_damaged(msg):
                continue
            sysid = msg.get_srcSystem()
            if sysid not in files:
                path = f"{stem}-{sysid}.tlog"
                print(f"Creating {path}")
                files[sysid] = stack.enter_context(writing(path, args.logs, option=""))
            files[sysid].write(record(msg))
