"""A telemetry log as a MATLAB script, one matrix for each message type (mavtomfile.py)."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections import Counter
from typing import Any

from mavwire._log_link import kind_of
from mavwire.cli._errors import CommandError
from mavwire.cli._message_types import wanted
from mavwire.cli._output import OutputFile, writing
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.links.signing import shown

# How numbers are written: as double precision floats, of which those here are equal to the integer.
FULL, SHORT = "%.20g", "%d"
INTEGERS = frozenset(("uint8_t", "int8_t", "uint16_t", "int16_t", "uint32_t", "int32_t"))


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition", "dialect")
    parser.add_argument("-o", "--output", metavar="FILE", help="(default: the log's name with .m)")
    add_shared(parser, "types")


def main(args: Namespace) -> int:
    if args.output and len(args.logs) > 1:
        raise CommandError("--output takes one log; without it each has a file of its own")

    def write(log: Reading) -> None:
        output = args.output or f"{os.path.splitext(log.path)[0]}.m"
        with writing(output, args.logs) as file:
            print(f"Creating {output}")
            _write(log, args, file)

    read_each("tomfile", args, write, title="Processing {}", zero_time_base=True)
    return 0


def _write(log: Reading, args: Namespace, file: OutputFile) -> None:
    types = wanted(args.types, log)
    source = kind_of(log.link)
    rows = Counter[str]()
    layouts: dict[Any, Layout] = {}
    for msg in log.messages(condition=args.condition):
        kind = msg.get_type()
        if not _is_wanted(kind, types):
            continue
        described_by = msg.fmt if source == "dataflash" else type(msg)
        layout = layouts.get(described_by) or Layout(msg)
        if source != "CSV":  # where each row may have other cells that are numbers
            layouts[described_by] = layout
        rows[kind] += 1
        if rows[kind] == 1:
            names = "','".join(layout.columns)
            file.write(f"{kind}.columns = {{'timestamp','{names}'}};\n".encode())
        file.write(layout.row(msg, rows[kind]).encode())


def _is_wanted(kind: str, types: list[str] | None) -> bool:
    if kind in ("BAD_DATA", "FMT", "PARM") or kind.startswith("UNKNOWN_"):
        return False
    return types is None or kind in types


class Layout:
    """Which numbers a message has, and how they are written. Arrays are counted from 1."""

    def __init__(self, msg: Any) -> None:
        types = dict(zip(msg.get_fieldnames(), getattr(type(msg), "fieldtypes", ()), strict=False))
        self.columns: list[str] = []
        self._names: list[str] = []
        self._has_arrays = False
        formats = []
        for name in msg.get_fieldnames():
            value = getattr(msg, name)
            if isinstance(value, (list, tuple)):
                columns = [f"{name}{n}" for n in range(1, len(value) + 1)]
                self._has_arrays = True
            elif isinstance(value, (int, float)):
                columns = [name]
            else:
                continue
            self._names.append(name)
            self.columns += columns
            formats += [SHORT if types.get(name) in INTEGERS else FULL] * len(columns)
        self._format = f"{msg.get_type()}.data(%d,:) = [{','.join(['%f', *formats])}];\n"

    def row(self, msg: Any, number: int) -> str:
        """The line of a message."""
        cells = [number, msg._timestamp]
        for name in self._names:
            value = getattr(msg, name)
            if self._has_arrays and isinstance(value, (list, tuple)):
                cells += shown(name, value)
            else:
                cells.append(value)
        return self._format % tuple(cells)
