"""Files that subcommands write: complete or as they were, with errors that name them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import IO, TYPE_CHECKING

from mavwire._atomic_file import Replacement, is_replaceable
from mavwire._signals import ended_in_order
from mavwire.cli._errors import CommandError, refused

if TYPE_CHECKING:
    from mavwire.plots.windows import Figures


class OutputFile:
    """A binary file that is being written; CommandError says which one could not be, and why."""

    def __init__(self, name: str, file: IO[bytes]) -> None:
        self._name = name
        self._file = file

    def write(self, data: bytes) -> None:
        """Append bytes."""
        try:
            self._file.write(data)
        except OSError as error:
            raise CommandError(f"{self._name}: {error.strerror}") from error


@contextmanager
def writing(
    path: str, logs: Iterable[str] = (), option: str = "--output", in_place: bool = False
) -> Iterator[OutputFile]:
    """A file that replaces `path` at the end. An error or a signal leaves the old file. A pipe, a device
    and a file that is written `in_place` get each write at once. CommandError for one of the logs that
    are read, and for a file that cannot be written.
    """
    refuse_log(path, logs, option)
    name = f"{option} {path}".lstrip()
    is_whole = not in_place and is_replaceable(path)
    with ended_in_order():
        try:
            target = Replacement(path, in_place)
        except OSError as error:
            raise CommandError(f"{name}: {error.strerror}") from error
        try:  # right away, and to the end: what came in between would leave a draft
            yield OutputFile(name, target.file)
            with _named(name):
                target.finish()
        except BaseException as error:
            with _named(name):
                target.discard()
            if is_whole and isinstance(error, BrokenPipeError):
                reason = "nobody reads standard output any more"
                raise CommandError(f"{name} is not written: {reason}") from error
            raise


@contextmanager
def _named(name: str) -> Iterator[None]:
    """Turn an OSError into a CommandError with the user's name of the file."""
    try:
        yield
    except OSError as error:
        raise CommandError(f"{name}: {error.strerror}") from error


def refuse_log(path: str, logs: Iterable[str], option: str = "--output") -> None:
    """CommandError if a file to write is one of the logs that are read."""
    for log in logs:
        if os.path.exists(log) and os.path.exists(path) and os.path.samefile(log, path):
            told = f"{option} {path} is the log itself: name another file"
            raise CommandError(told.lstrip())


def open_figures(output: str | None, option: str = "--image") -> Figures:
    """Figures for windows, or for the image `output` of an option; CommandError if there can be none."""
    from mavwire.plots.windows import Figures

    with refused(ImportError, ValueError):
        return Figures(output, option)
