"""When nothing was received for longer than some time (mavsigloss.py)."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace

from mavwire.cli._message_types import wanted
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "no_timestamps", "planner", "robust")
    parser.add_argument(
        "--deltat", type=float, default=1.0, help="seconds of silence (default: %(default)s)"
    )
    add_shared(parser, "condition", "types")


def main(args: Namespace) -> int:
    read_each("sigloss", args, lambda log: _tell_losses(log, args))
    return 0


def _tell_losses(log: Reading, args: Namespace) -> None:
    last = None
    for msg in log.messages(wanted(args.types, log), args.condition):
        stamp = msg._timestamp
        if not stamp:  # how a dataflash log describes itself, before it has a time
            continue
        if last is not None and stamp - last > args.deltat:
            print(f"Sig lost for {stamp - last:.1f}s at {time.ctime(stamp)}")
        last = stamp
