"""Files of parameters, and how two of them differ.

A line has a name and a value. A line of QGroundControl has vehicle id, component id, name, value and
type. Spaces, tabs or commas separate them; `#` starts a comment. A file is read as a whole
before the first value is used: a mistake at its end must not leave a vehicle with half of it.
"""

from __future__ import annotations

import fnmatch
import sys
from dataclasses import dataclass, field

from mavwire._text import printable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping
    from typing import Any

    ValueInfo = Callable[[str, Any], Any]

EXCLUDED = tuple(
    """ARSPD_OFFSET CMD_INDEX CMD_TOTAL FENCE_TOTAL FORMAT_VERSION GND_ABS_PRESS GND_TEMP
    LOG_LASTFILE MIS_TOTAL SYSID_SW_MREV SYS_NUM_RESETS""".split()
)
"""Parameters of one vehicle that must not go to another."""

SMALLEST_DIFFERENCE = 0.000001
# Characters of a word that an error shows: a file that is none of parameters may be one line.
MOST_SHOWN = 80


class MAVParmFileError(ValueError):
    """A value in a parameter file is not a number, or the file has no parameters. The text names
    the file, and the line.
    """

    __module__ = "mavwire.mavparm"


@dataclass
class ParameterFile:
    """The content of a file: its `values` and its invalid lines."""

    path: str
    values: list[tuple[str, float]] = field(default_factory=list)
    invalid: list[str] = field(default_factory=list)
    names: int = 0
    """The number of lines with a parameter, wanted or not."""
    component: tuple[str, ...] = ()
    """The vehicle and component of the first line that has them. Lines of others are left out."""

    def why_empty(self) -> str:
        """The error text for a file without parameters; empty for another file."""
        if self.names:
            return ""
        expected = "each line needs a name and a value, or the five columns of QGroundControl"
        return f"{self.path}: no parameters found; {expected}"

    def show_invalid(self) -> None:
        """Print what is no line of such a file."""
        for text in self.invalid:
            print(f"Invalid line: {printable(text)}")

    def show_loaded(self) -> None:
        """Print that, and how many values there are."""
        self.show_invalid()
        self.warn_if_empty()
        print(f"Loaded {len(self.values)} parameters from {self.path}")

    def warn_if_empty(self) -> None:
        """Print to standard error that a file has no parameters."""
        if why := self.why_empty():
            print(printable(why), file=sys.stderr)

    def check_any(self) -> None:
        """Raise MAVParmFileError for a file without parameters."""
        if why := self.why_empty():
            self.show_invalid()
            raise MAVParmFileError(printable(why))


def read_parameter_file(
    path: str, wildcard: str = "*", excluded: Collection[str] = EXCLUDED
) -> ParameterFile:
    """The values whose names match `wildcard` and are not `excluded`. Raises OSError that names the
    file, and MAVParmFileError for a value that is no number.
    """
    found = ParameterFile(path)
    try:
        with open(path, encoding="utf-8-sig", errors="replace") as file:
            for number, line in enumerate(file, start=1):
                _read_line(line, number, found, wildcard, excluded)
    except OSError as error:
        raise OSError(error.errno, error.strerror, path) from error  # one of reading names no file
    return found


def _read_line(
    line: str, number: int, found: ParameterFile, wildcard: str, excluded: Collection[str]
) -> None:
    text = line.partition("#")[0].strip().replace(",", " ")
    words = text.split()
    if not words:
        return
    if _is_of_component(words):
        found.component = found.component or tuple(words[:2])
        if tuple(words[:2]) == found.component:
            words = words[2:4]
    if len(words) != 2:
        found.invalid.append(text)
        return
    found.names += 1
    name, number_text = words
    if name in excluded or not matches(name, wildcard):
        return
    try:
        value = number_of(number_text)
        float(value)
    except (ValueError, OverflowError) as error:  # the latter for hexadecimal beyond any float
        found.show_invalid()
        name, number_text = name[:MOST_SHOWN], number_text[:MOST_SHOWN]
        text = f"{found.path}:{number}: the value of {name} is no number: {number_text}"
        raise MAVParmFileError(printable(text)) from error
    found.values.append((name, value))


def _is_of_component(words: list[str]) -> bool:
    """Whether a line is one of QGroundControl: vehicle, component, name, value, type."""
    return len(words) == 5 and all(
        one.isascii() and one.isdigit() for one in (*words[:2], words[4])
    )


def number_of(text: str) -> float:
    """A number as parameter files and users write it; hexadecimal gives an int."""
    return int(text[2:], 16) if text[:2].lower() == "0x" else float(text)


def matches(name: str, wildcard: str) -> bool:
    """Whether a name is one of those that are meant, in any letter case."""
    return fnmatch.fnmatch(name.upper(), wildcard.upper())


def differences(
    first: Mapping[str, Any],
    second: Mapping[str, Any],
    *,
    wildcard: str = "*",
    smallest: float = SMALLEST_DIFFERENCE,
    tabs: bool = False,
    only_first: bool = True,
    only_second: bool = True,
    value_info: ValueInfo | None = None,
) -> Iterator[str]:
    """A line for each parameter that differs by more than `smallest`, or, where that is wanted, is on
    one side alone. `value_info(name, value)` explains a value in a comment; None is no explanation.
    """
    for name in sorted(first.keys() | second.keys()):
        if not matches(name, wildcard):
            continue
        one, other = first.get(name), second.get(name)
        if one is None:
            line = row(name, "", f"{other:.4f}") if only_second else None
        elif other is None:
            line = row(name, f"{one:.4f}").rstrip() if only_first else None
        elif abs(one - other) > smallest:
            line = row(name, f"{one:.4f}", f"{other:.4f}", tabs)
        else:
            line = None
        if line is not None:
            yield line + _comment(name, one, other, value_info)


def row(name: str, first: str, second: str = "", tabs: bool = False) -> str:
    """A name and a column for each side."""
    return f"{name}\t{first}\t{second}" if tabs else f"{name:<16.16} {first:>12} {second:>12}"


def heading(tabs: bool = False) -> str:
    """The names of the columns."""
    return row("PARAMETER", "FILE1", "FILE2", tabs)


def _comment(name: str, first: Any, second: Any, value_info: ValueInfo | None) -> str:
    """The meaning of a value on either side."""
    if value_info is None:
        return ""
    sides = (("FILE1", first), ("FILE2", second))
    infos = ((side, value_info(name, value)) for side, value in sides if value is not None)
    told = [f"{side}={info}" for side, info in infos if info is not None]
    return f" # {' '.join(told)}" if told else ""
