"""When GPS got and lost its fix, and how long it had one (mavgpslock.py)."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace

from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli.logs._track import minutes

TYPES = ("GPS_RAW_INT", "GPS_RAW", "GPS")
NO_GPS = 0
FIX_2D = 2


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")


def main(args: Namespace) -> int:
    seconds = sum(read_each("gpslock", args, lambda log: _locked(log, args.condition)))
    print(f"Total time locked: {minutes(seconds)}")
    return 0


def _locked(log: Reading, condition: str | None) -> int:
    """Tell of the changes in one log; how many seconds there was a fix."""
    seconds, now = 0, 0
    since: int | None = None
    locked = False
    for msg in log.messages(TYPES, condition):
        fix = msg.Status if msg.get_type() == "GPS" else msg.fix_type
        now = int(msg._timestamp)
        if since is None:  # it begins here with any fix
            since = now
            continue
        if locked == (fix >= FIX_2D):
            continue
        locked = not locked
        if locked:
            print(f"Locked at {time.ctime(now)} after {now - since} seconds")
        else:
            print(f"Lost {'protocol' if fix == NO_GPS else 'GPS'} lock at {time.ctime(now)}")
            seconds += now - since
        since = now
    if locked and since is not None:
        seconds += now - since
    if seconds:
        print(f"Lock time : {minutes(seconds)}")
    return seconds
