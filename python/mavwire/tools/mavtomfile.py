"""A telemetry log as a MATLAB script, one matrix for each message type (mavtomfile.py)."""

from __future__ import annotations

import os
from contextlib import ExitStack

from mavwire.cli._message_types import wanted
from mavwire.cli._output import OutputFile, open_output
from mavwire.cli._reading import definitions, reading
from mavwire.links.recording import shown
from mavwire.tools._arguments import add_condition, add_dialect, add_logs

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterator
    from typing import Any

    from mavwire.cli._reading import Reading


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
    rows: dict[str, int] = {}
    for msg in log.messages(condition=args.condition):
        kind = msg.get_type()
        if kind in ("BAD_DATA", "FMT", "PARM") or kind.startswith("UNKNOWN_"):
            continue
        if types is not None and kind not in types:
            continue
        cells = list(_cells(msg))
        row = rows[kind] = rows.get(kind, 0) + 1
        if row == 1:
            names = "','".join(name for name, _ in cells)
            file.write(f"{kind}.columns = {{'timestamp','{names}'}};\n".encode())
        values = "".join(f",{value:.20g}" for _, value in cells)
        file.write(f"{kind}.data({row},:) = [{msg._timestamp:f}{values}];\n".encode())


def _cells(msg: Any) -> Iterator[tuple[str, float]]:
    """The numbers of a message with the names of their columns; arrays are counted from 1."""
    for name in msg.get_fieldnames():
        value = shown(name, getattr(msg, name))
        if isinstance(value, (list, tuple)):
            for number, one in enumerate(value, 1):
                yield f"{name}{number}", float(one)
        elif isinstance(value, (int, float)):
            yield name, float(value)


if __name__ == "__main__":
    from mavwire.tools._script import run

    run(__file__)
