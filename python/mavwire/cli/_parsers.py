"""The argparse parsers of the subcommands."""

from __future__ import annotations

import re
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from typing import Any

from mavwire._arguments import PlainParser

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
        formatter_class=RawDescriptionHelpFormatter,
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
