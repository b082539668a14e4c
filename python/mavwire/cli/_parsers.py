"""The argparse parsers of the subcommands, in a module of their own: few command lines need them."""

from __future__ import annotations

import os
import re
import sys
from argparse import RawDescriptionHelpFormatter

from mavwire._arguments import PlainParser

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from typing import Any

NUMBERS = re.compile(r"-\.?\d[\d.eE+-]*(,[\d.eE+-]+)+")
"""Some of them between commas, a negative one first."""


def parse(name: str, command: Any, arguments: list[str]) -> Namespace:
    """The arguments of `mavwire NAME`; the process ends where they are wrong, or ask for help."""
    return parser_of(name, command).parse_args(_joined(arguments))


def parser_of(name: str, command: Any) -> ArgumentParser:
    """The parser of `mavwire NAME`."""
    parser = PlainParser(
        prog=f"mavwire {name}",
        description=command.__doc__,
        formatter_class=Formatter,
    )
    command.add_arguments(parser)
    return parser


def _joined(arguments: list[str]) -> list[str]:
    """`--shift -1,2` as `--shift=-1,2`: argparse takes a negative number for a value, but several of
    them for an option.
    """
    words: list[str] = []
    for one in arguments:
        if words and re.fullmatch("--[^=]+", words[-1]) and NUMBERS.fullmatch(one):
            words[-1] += f"={one}"
        else:
            words.append(one)
    return words


class Formatter(RawDescriptionHelpFormatter):
    """argparse makes one for each option, and looks for the width with `shutil`, which loads every
    compression that Python knows.
    """

    def __init__(self, prog: str, **options: Any) -> None:
        super().__init__(prog, **{"width": _columns() - 2, **options})


def _columns() -> int:
    """Characters in a line of the terminal, as `shutil.get_terminal_size` tells."""
    told = os.environ.get("COLUMNS", "")
    if told.isdecimal() and int(told) > 0:
        return int(told)
    try:
        return os.get_terminal_size(sys.__stdout__.fileno()).columns or 80  # type: ignore[union-attr]
    except (AttributeError, ValueError, OSError):  # closed, or no terminal
        return 80
