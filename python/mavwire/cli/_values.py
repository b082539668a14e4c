"""The values of options: texts as times, sizes, numbers and lists, with errors that say what would do."""

from __future__ import annotations

import re
from argparse import ArgumentTypeError

from mavwire.cli._errors import CommandError, refused

_UNITS = {"ms": 1e-3, "s": 1.0, "m": 60.0, "h": 3600.0, "": 1.0}


def duration(text: str) -> float:
    """200ms, 0.2s, 5m, 1h; seconds without a unit."""
    match = re.fullmatch(r"(\d+(?:\.\d*)?|\.\d+)\s*(ms|s|m|h|)", text)
    if match is None:
        raise ArgumentTypeError(f"not a time: {text!r}; say 200ms, 1.5s or 5m")
    return float(match[1]) * _UNITS[match[2]]


def fraction(text: str) -> float:
    """5% or 0.05."""
    number, percent = (text[:-1], 100.0) if text.endswith("%") else (text, 1.0)
    try:
        value = float(number) / percent
    except ValueError:
        raise ArgumentTypeError(f"not a fraction: {text!r}; say 5% or 0.05") from None
    if not 0 <= value <= 1:
        raise ArgumentTypeError(f"must be between 0 and 100%: {text!r}")
    return value


def factor(text: str) -> float:
    """A number above 0, up to where no pause of a log takes any time."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1e6:
        raise ArgumentTypeError(f"must be above 0 and below 1000000: {text!r}")
    return value


def size(text: str) -> int:
    """1000, 500k, 100M, 2G."""
    units = {"k": 10**3, "m": 10**6, "g": 10**9}
    number, unit = (
        (text[:-1], units[text[-1:].lower()]) if text[-1:].lower() in units else (text, 1)
    )
    if not (number.isascii() and number.isdecimal() and len(number) < 15 and int(number)):
        raise ArgumentTypeError(f"not a size: {text!r}; say 500k, 100M or 2G")
    return int(number) * unit


def split(text: str | None, option: str) -> list[str] | None:
    """The words between commas; None for none given. CommandError for an option that names nothing,
    as where a variable of a shell is empty.
    """
    if text is None:
        return None
    words = [one.strip() for one in text.split(",") if one.strip()]
    if not words:
        raise CommandError(f"{option} names nothing: leave it out for all")
    return words


def systems_of(text: str | None) -> list[int] | None:
    """System ids between commas; CommandError for what is no number."""
    try:
        return None if text is None else [int(one) for one in split(text, "--systems") or ()]
    except ValueError as error:
        raise CommandError(f"--systems takes numbers between commas, not {text!r}") from error


def time_of(text: str | None) -> float | None:
    """Seconds since 1970 of a text that says so many, or a date and time; UTC where it names no
    zone.
    """
    if text is None:
        return None
    if text.isdecimal() and len(text) == 4 and text[:2] in ("19", "20"):
        raise CommandError(
            f"{text} is a year or a number of seconds: write {text}-01-01 or {text}.0"
        )
    try:
        return float(text)
    except ValueError:
        pass
    from mavwire.logs.selection import seconds_of

    with refused(ValueError):
        return seconds_of(text)
