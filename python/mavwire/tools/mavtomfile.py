"""A telemetry log as a MATLAB script, one matrix for each message type (mavtomfile.py)."""

from __future__ import annotations

import os
from contextlib import ExitStack
from operator import attrgetter

from mavwire.cli._message_types import wanted
from mavwire.cli._output import OutputFile, open_output
from mavwire.cli._reading import definitions, reading
from mavwire.links.recording import shown
from mavwire.tools._arguments import add_condition, add_dialect, add_logs

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from typing import Any

    from mavwire.cli._reading import Reading

# How numbers are written: as double precision floats, of which those here are equal to the integer.
FULL, SHORT = "%.20g", "%d"
NUMBERS = (int, float, list, tuple)
INTEGERS = frozenset(("uint8_t", "int8_t", "uint16_t", "int16_t", "uint32_t", "int32_t"))


def add_arguments(parser: ArgumentParser) -> None:
    """mavtomfile.py's options."""
    add_logs(parser)
    add_condition(parser)
    add_dialect(parser)
    parser.add_argument("-o", "--output", metavar="FILE", help="(default: the log's name with .m)")
    parser.add_argument("--types", help="only these message types, comma separated")


def main(args: Namespace) -> int:
    """Run the subcommand."""
    from mavwire.cli._errors import CommandError

    if args.output and len(args.logs) > 1:
        raise CommandError("--output takes one log; without it each has a file of its own")
    for path in args.logs:
        print(f"Processing {path}")
        output = args.output or f"{os.path.splitext(path)[0]}.m"
        with (
            definitions(args.dialect),
            reading("tomfile", path, zero_time_base=True) as log,
            ExitStack() as stack,
        ):
            file = open_output(output, [path], stack)
            print(f"Creating {output}")
            _write(log, args, file)
    return 0


def _write(log: Reading, args: Namespace, file: OutputFile) -> None:
    types = wanted(args.types, log)
    matrices: dict[str, Matrix | None] = {}
    for msg in log.messages(condition=args.condition):
        kind = msg.get_type()
        if kind not in matrices:
            matrices[kind] = Matrix(msg) if _is_wanted(kind, types) else None
            if matrix := matrices[kind]:
                file.write(matrix.columns.encode())
        if matrix := matrices[kind]:
            file.write(matrix.row(msg).encode())


def _is_wanted(kind: str, types: list[str] | None) -> bool:
    if kind in ("BAD_DATA", "FMT", "PARM") or kind.startswith("UNKNOWN_"):
        return False
    return types is None or kind in types


class Matrix:
    """The numbers of the messages of a type, a row for each message; arrays are counted from 1."""

    def __init__(self, first: Any) -> None:
        numbers = {name: shown(name, getattr(first, name)) for name in first.get_fieldnames()}
        numbers = {name: one for name, one in numbers.items() if isinstance(one, NUMBERS)}
        types = dict(zip(first.get_fieldnames(), getattr(first, "fieldtypes", ()), strict=False))
        names, formats = ["timestamp"], ["%f"]
        for name, value in numbers.items():
            is_array = isinstance(value, (list, tuple))
            columns = [f"{name}{n}" for n in range(1, len(value) + 1)] if is_array else [name]
            names += columns
            formats += [SHORT if types.get(name) in INTEGERS else FULL] * len(columns)
        kind = first.get_type()
        self.columns = f"{kind}.columns = {{{','.join(map(repr, names))}}};\n"
        self._names = list(numbers)
        self._values = attrgetter("_timestamp", *numbers)
        self._is_flat = 0 < len(numbers) == len(names) - 1
        self._format = f"{kind}.data(%d,:) = [{','.join(formats)}];\n"
        self._rows = 0

    def row(self, msg: Any) -> str:
        """The line of a message."""
        self._rows += 1
        return self._format % (
            self._rows,
            *(self._values(msg) if self._is_flat else self._cells(msg)),
        )

    def _cells(self, msg: Any) -> list[float]:
        cells = [msg._timestamp]
        for name in self._names:
            value = shown(name, getattr(msg, name))
            cells += value if isinstance(value, (list, tuple)) else [value]
        return cells


if __name__ == "__main__":
    from mavwire.tools._script import run

    run(__file__)
