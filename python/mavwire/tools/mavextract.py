"""Each stretch of a log that was flown in one mode, as a log beside it (mavextract.py).

A stretch begins with all parameters and mission items that the log told before.
"""

from __future__ import annotations

import os
from contextlib import ExitStack

from mavwire.cli._output import OutputFile, open_output
from mavwire.cli._reading import definitions, reading
from mavwire.tools._arguments import add_condition, add_logs, add_no_timestamps, add_robust
from mavwire.tools._telemetry import record, require_telemetry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterable
    from typing import Any

    from mavwire.cli._reading import Reading

# What a stretch needs to be understood.
KEPT = frozenset(("PARAM_VALUE", "MISSION_ITEM", "MISSION_ITEM_INT"))


def add_arguments(parser: ArgumentParser) -> None:
    """mavextract.py's options."""
    add_logs(parser)
    add_condition(parser)
    add_no_timestamps(parser)
    add_robust(parser)
    parser.add_argument("--mode", default="auto", help="flight mode (default: %(default)s)")
    parser.add_argument("--link", type=int, help="only from this link of the ground station")


def main(args: Namespace) -> int:
    """Run the subcommand."""
    for path in args.logs:
        print(f"Processing {path}")
        with (
            definitions(),
            reading(
                "extract", path, notimestamps=args.no_timestamps, robust_parsing=args.robust
            ) as log,
            ExitStack() as stack,
        ):
            require_telemetry(log)
            Extraction(log, args, stack).run()
    return 0


class Extraction:
    """Writes the stretches of one log."""

    def __init__(self, log: Reading, args: Namespace, stack: ExitStack) -> None:
        self._log = log
        self._args = args
        self._stack = stack
        self._mode: str = args.mode.upper()
        self._kept: list[bytes] = []
        self._in_mode = False
        self._count = 0
        self._file: OutputFile | None = None
        self._unwritten: list[bytes] = []

    def run(self) -> None:
        """Read the log to its end."""
        for chunk in self._log.chunks():
            self._read(chunk)

    def _read(self, messages: Iterable[Any]) -> None:
        wanted_link, condition = self._args.link, self._args.condition
        for msg in messages:
            if wanted_link is not None and msg._link != wanted_link:
                continue
            kind = msg.get_type()
            if kind in KEPT:
                self._kept.append(record(msg))
            elif kind == "HEARTBEAT":
                self._in_mode = self._log.link.flightmode.upper() == self._mode
            if not self._in_mode:
                self._end()
            elif kind != "BAD_DATA" and (condition is None or self._log.holds(condition)):
                if self._file is None:
                    self._file = self._begin()
                self._unwritten.append(record(msg))
        self._write()

    def _write(self) -> None:
        """One call for many records: a call for each costs more than making it."""
        if self._file is not None:
            self._file.write(b"".join(self._unwritten))
        self._unwritten.clear()

    def _begin(self) -> OutputFile:
        path = self._free_name()
        print(f"Creating {path}")
        file = open_output(path, self._args.logs, self._stack, option="")
        for one in self._kept:
            file.write(one)
        return file

    def _free_name(self) -> str:
        """The next name with a number that no file has: another log's stretch may be there."""
        folder = os.path.dirname(self._log.path)
        while True:
            self._count += 1
            name = f"{self._log.link.flightmode}{self._count}.tlog"
            path = os.path.join(folder, name)
            if not os.path.lexists(path):
                return path

    def _end(self) -> None:
        if self._file is not None:
            self._write()
            self._file.close()
            self._file = None
