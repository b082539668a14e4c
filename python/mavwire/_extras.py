"""Error texts for missing libraries that only some features need."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def extra(name: str) -> Iterator[None]:
    """For imports: ImportError names the extra of mavwire that brings what is missing."""
    try:
        yield
    except ModuleNotFoundError as error:
        text = f"{error.name} is needed: pip install 'mavwire[{name}]'"
        raise ModuleNotFoundError(text, name=error.name) from error
