"""When nothing was received for longer than some time (mavsigloss.py)."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace

from mavwire.cli._message_types import wanted
from mavwire.cli._reading import definitions, link_options, reading
from mavwire.cli._shared_arguments import add_shared


def add_arguments(parser: ArgumentParser) -> None:
    """mavsigloss.py's options."""
    add_shared(parser, "logs", "no_timestamps", "planner", "robust")
    parser.add_argument(
        "--deltat", type=float, default=1.0, help="seconds of silence (default: %(default)s)"
    )
    add_shared(parser, "condition", "types")


def main(args: Namespace) -> int:
    """Run the subcommand."""
    with definitions():
        for path in args.logs:
            print(f"Processing log {path}")
            last = None
            with reading("sigloss", path, **link_options(args)) as log:
                for msg in log.messages(wanted(args.types, log), args.condition):
                    stamp = msg._timestamp
                    if not stamp:  # how a dataflash log describes itself, before it has a time
                        continue
                    if last is not None and stamp - last > args.deltat:
                        print(f"Sig lost for {stamp - last:.1f}s at {time.ctime(stamp)}")
                    last = stamp
    return 0
