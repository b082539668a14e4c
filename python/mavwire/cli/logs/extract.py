"""Each stretch of a log that was flown in one mode, or in some, as a log beside it (mavextract.py).

A stretch begins with all parameters and mission items that the log told before, one of a dataflash
log with the formats too.
"""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from contextlib import ExitStack
from typing import Any

from mavwire._log_link import kind_of
from mavwire.cli._errors import CommandError
from mavwire.cli._output import OutputFile, writing
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._telemetry import record

MAV_TYPE_GCS = 6
# Types that readers of a stretch need, and the start of the text that names the vehicle.
TELEMETRY_KEPT = frozenset(("PARAM_VALUE", "MISSION_ITEM", "MISSION_ITEM_INT"))
DATAFLASH_KEPT = frozenset(("FMT", "UNIT", "MULT", "FMTU", "PARM", "CMD"))
VEHICLE = "Ardu"


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition", "no_timestamps", "robust")
    parser.add_argument(
        "--mode", default="auto", help="flight mode, or several with commas (default: %(default)s)"
    )
    parser.add_argument("--link", type=int, help="only from this link of the ground station")


def main(args: Namespace) -> int:

    def extract(log: Reading) -> None:
        with ExitStack() as stack:
            _extraction(log, args)(log, args, stack).run()

    read_each("extract", args, extract, title="Processing {}")
    return 0


def _extraction(log: Reading, args: Namespace) -> type[Extraction]:
    """The class for this kind of log; CommandError where there is none."""
    kind = "text" if log.is_text else kind_of(log.link)
    if kind == "telemetry":
        return Extraction
    if kind == "dataflash" and args.link is None:
        return DataflashExtraction
    if kind == "dataflash":
        raise CommandError(f"--link: {log.path} is a dataflash log, which has no links")
    raise CommandError(f"{log.path} is a {kind} log; this is for telemetry and dataflash logs")


class Extraction:
    """Writes the stretches of one telemetry log."""

    suffix = "tlog"
    looked_at = TELEMETRY_KEPT | {"HEARTBEAT"}
    """The types that may explain others or tell the mode: most messages do neither."""

    def __init__(self, log: Reading, args: Namespace, stack: ExitStack) -> None:
        self._log = log
        self._args = args
        self._stack = stack
        self._modes: list[str] = args.mode.upper().split(",")
        self._kept: list[bytes] = []
        self._in_mode = False
        self._count = 0
        self._file: OutputFile | None = None
        self._unwritten: list[bytes] = []

    def run(self) -> None:
        """Read the log to its end."""
        for chunk in self._log.chunks(self._args.condition):
            self._read(chunk)

    def _read(self, messages: Iterable[Any]) -> None:
        wanted_link, condition = self._args.link, self._args.condition
        for msg in messages:
            if wanted_link is not None and msg._link != wanted_link:
                continue
            kind = msg.get_type()
            if kind in self.looked_at:
                self._look_at(msg, kind)
            if not self._in_mode:
                if self._file is not None:
                    self._end()
            elif kind != "BAD_DATA" and (condition is None or self._log.holds(condition)):
                if self._file is None:
                    self._file = self._begin()
                self._unwritten.append(self._record(msg))
        self._write()

    def _look_at(self, msg: Any, kind: str) -> None:
        if self._explains(msg, kind):
            self._kept.append(self._record(msg))
        elif self._tells_mode(msg, kind):
            self._in_mode = self._log.link.flightmode.upper() in self._modes

    def _explains(self, msg: Any, kind: str) -> bool:
        """Whether later stretches need this message to be understood."""
        return kind in TELEMETRY_KEPT

    def _tells_mode(self, msg: Any, kind: str) -> bool:
        """Whether the mode may be another one from here on."""
        return kind == "HEARTBEAT" and msg.type != MAV_TYPE_GCS

    def _record(self, msg: Any) -> bytes:
        """The record of a message in a log."""
        return record(msg)

    def _write(self) -> None:
        """One call for many records: a call for each costs more than making it."""
        if self._file is not None:
            self._file.write(b"".join(self._unwritten))
        self._unwritten.clear()

    def _begin(self) -> OutputFile:
        path = self._free_name()
        print(f"Creating {path}")
        file = self._stack.enter_context(writing(path, self._args.logs, option=""))
        for one in self._kept:
            file.write(one)
        return file

    def _free_name(self) -> str:
        """The next name with a number that no file has: another log's stretch may be there."""
        folder = os.path.dirname(self._log.path)
        while True:
            self._count += 1
            name = f"{self._modes[0]}{self._count}.{self.suffix}"
            path = os.path.join(folder, name)
            if not os.path.lexists(path):
                return path

    def _end(self) -> None:
        self._write()
        self._file = None
        self._stack.close()


class DataflashExtraction(Extraction):
    """Writes the stretches of one binary dataflash log."""

    suffix = "bin"
    looked_at = DATAFLASH_KEPT | {"MSG", "MODE"}

    def _explains(self, msg: Any, kind: str) -> bool:
        return kind in DATAFLASH_KEPT or (kind == "MSG" and msg.Message.startswith(VEHICLE))

    def _tells_mode(self, msg: Any, kind: str) -> bool:
        return kind == "MODE"

    def _record(self, msg: Any) -> bytes:
        frame: bytes = msg.get_msgbuf()
        return frame
