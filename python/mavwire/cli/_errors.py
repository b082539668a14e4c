"""Errors that the user can correct, and the exception that carries their text."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from mavwire._text import printable


class CommandError(Exception):
    """Printed as ``mavwire COMMAND: error: ...`` without a traceback; ``exit_code`` ends the
    process.
    """

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(message)
        self.exit_code = exit_code


@contextmanager
def refused(*kinds: type[Exception], exit_code: int = 1) -> Iterator[None]:
    """Turn errors of these kinds, which the user can correct, into a CommandError."""
    try:
        yield
    except kinds as error:
        text = describe_link_error(error) if isinstance(error, OSError) else str(error)
        raise CommandError(text, exit_code) from error


def tell(text: str) -> None:
    """Print a line on standard error. Control characters in names and texts are escaped."""
    print(printable(text), file=sys.stderr)


def describe_os_error(error: OSError) -> str:
    """The reason and the file of an error. An error of standard output has no file name."""
    reason = error.strerror or str(error)
    if error.filename is None:
        return f"standard output: {reason}"
    return f"{error.filename or repr(error.filename)}: {reason}"


def describe_link_error(error: OSError) -> str:
    """The reason and the link or file of an error. Without a name it is the text of the error."""
    return f"{error.filename}: {error.strerror}" if error.filename else str(error)
