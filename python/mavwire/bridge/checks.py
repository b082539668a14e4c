"""Checks of single options: each returns the value, or raises ConfigError with the option's name."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterable, Iterator

from mavwire._text import did_you_mean

from .errors import ConfigError

# More than any list of messages, systems or components has.
MAX_LISTED = 65_536
# Of an integer that is shown.
MAX_BITS = 1024
# Some centuries: who says more has mistaken the unit.
MAX_SECONDS = 1e10


def number(name: str, value: object) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ConfigError(f"{name} must be a number, not {value!r}")
    try:
        found = float(value)
    except OverflowError:  # of an integer, perhaps one of more digits than Python writes
        raise ConfigError(f"{name} must be a finite number, and is too large for one") from None
    if not math.isfinite(found):
        raise ConfigError(f"{name} must be a finite number, not {value!r}")
    return found


def seconds(name: str, value: object, least: float = 0.0) -> float:
    """A number of seconds, `least` or more and `MAX_SECONDS` or less."""
    time = number(name, value)
    if time < least:
        raise ConfigError(f"{name} must be {least:g} seconds or more, not {value!r}")
    if time > MAX_SECONDS:
        raise ConfigError(f"{name} must be {MAX_SECONDS:.0f} seconds or less, not {value!r}")
    return time


def whole(name: str, value: object, most: int, least: int = 0) -> int:
    """A whole number in a range."""
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        # Python writes no integers of thousands of digits.
        is_long = isinstance(value, int) and value.bit_length() > MAX_BITS
        shown = "one of so many digits" if is_long else repr(value)
        raise ConfigError(f"{name} must be a number from {least} to {most}, not {shown}")
    return value


def rate(name: str, value: object) -> float | None:
    """So many a second; None for no limit."""
    if value is None:
        return None
    each = number(name, value)
    if each <= 0:
        raise ConfigError(f"{name} must be more than 0 a second, not {value!r}")
    return each


def flag(name: str, value: object) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise ConfigError(f"{name} must be true or false, not {value!r}")
    return value


def text(name: str, value: object) -> str:
    """A text that is not empty."""
    if not isinstance(value, str):
        raise ConfigError(f"{name} must be a text, not {value!r}")
    if not value:
        raise ConfigError(f"{name} must not be empty")
    return value


def listed(name: str, values: object) -> Iterator[object]:
    """The items of a list, one after the other: who gives an endless one is told so."""
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise ConfigError(f"{name} must be a list, not {values!r}")
    for count, value in enumerate(values):
        if count == MAX_LISTED:
            raise ConfigError(f"{name} has more than {MAX_LISTED:,} items")
        yield value


def content(name: str, path: object, most: int) -> bytes:
    """The content of a small file. ConfigError."""
    if not isinstance(path, str | os.PathLike):
        raise ConfigError(f"{name} must be a path, not {path!r}")
    try:
        with open(path, "rb") as file:
            data = file.read(most + 1)
    except OSError as error:
        raise ConfigError(f"{name}: {path}: {error.strerror or error}") from None
    except ValueError:  # it has a null byte
        raise ConfigError(f"{name} must be a path, not {path!r}") from None
    if len(data) > most:
        raise ConfigError(f"{name}: {path}: longer than {most:,} bytes")
    return data


def only_known(given: Iterable[str], known: Collection[str]) -> None:
    """Options that there are."""
    for option in given:
        if option not in known:
            reason = f"unknown option {option!r}{did_you_mean(option, known)}"
            raise ConfigError(reason)
