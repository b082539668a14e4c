"""Files that subcommands write, with errors that name them."""

from __future__ import annotations

import os

from mavwire.cli._errors import CommandError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from contextlib import ExitStack
    from typing import Any


class OutputFile:
    """A binary file that is being written; CommandError says which one could not be, and why."""

    def __init__(self, path: str, option: str) -> None:
        self._name = f"{option} {path}".lstrip()
        self._file: Any = None
        self._do(lambda: setattr(self, "_file", open(path, "wb")))

    def write(self, data: bytes) -> None:
        """Append bytes."""
        self._do(lambda: self._file.write(data))

    def close(self) -> None:
        """Close the file; what was buffered is written."""
        self._do(self._file.close)

    def _do(self, action: Any) -> None:
        try:
            action()
        except OSError as error:
            raise CommandError(f"{self._name}: {error.strerror}") from error


def open_output(
    path: str, logs: Iterable[str], stack: ExitStack, option: str = "--output"
) -> OutputFile:
    """A file to write, closed with `stack`; CommandError if it is one of the logs that are read."""
    refuse_log(path, logs, option)
    file = OutputFile(path, option)
    stack.callback(file.close)
    return file


def refuse_log(path: str, logs: Iterable[str], option: str = "--output") -> None:
    """CommandError if a file to write is one of the logs that are read."""
    for log in logs:
        if same_file(log, path):
            raise CommandError(f"{option} {path} is the log itself".lstrip())


def same_file(one: str, other: str) -> bool:
    """Whether two names, links among them, lead to one file."""
    return os.path.exists(one) and os.path.exists(other) and os.path.samefile(one, other)
