"""The errors of definitions. Each names a file and a line."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any
from xml.parsers.expat import ExpatError

from mavwire._native import DefinitionError


class MAVParseError(Exception):
    """A definition, template or option that cannot be used. ``message`` says what, and where it is
    known, where.
    """

    def __init__(self, message: str, inner_exception: BaseException | None = None) -> None:
        super().__init__(*([message] if inner_exception is None else [message, inner_exception]))
        self.message = message
        self.inner_exception = inner_exception
        self.exception_info: tuple[
            type[BaseException] | None, BaseException | None, TracebackType | None
        ] = sys.exc_info()

    def __str__(self) -> str:
        return self.message

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, self.inner_exception)


class MAVSyntaxError(MAVParseError, ExpatError):
    """Text that is not well-formed XML, or uses a part of XML that definitions must not use.

    Also an ``ExpatError``, which is what code written for other parsers expects.
    """

    def __init__(self, message: str, inner_exception: BaseException | None = None) -> None:
        super().__init__(message, inner_exception)
        self.code = getattr(inner_exception, "code", 0)
        self.lineno = getattr(inner_exception, "lineno", 0)
        self.offset = getattr(inner_exception, "offset", 0)


@contextmanager
def parse_errors() -> Iterator[None]:
    """Raise errors of the native reader as those of ``mavparse``."""
    try:
        yield
    except DefinitionError as error:
        kind = MAVSyntaxError if hasattr(error, "lineno") else MAVParseError
        raise kind(str(error), error) from None
