"""Opening what the subcommands read, with errors that say what was wrong and what would do."""

from __future__ import annotations

import os
from contextlib import contextmanager
from functools import partial
from itertools import chain, islice

from mavwire.cli._errors import CommandError, no_such_dialect
from mavwire.cli._progress import Progress

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Any

PROGRESS_EVERY = 20_000


@contextmanager
def definitions(dialect: str | None = None, wire_protocol: str | None = None) -> Iterator[None]:
    """The dialect and wire protocol of this run, in place of the process's own, which are back
    afterwards. None leaves either as it is.
    """
    from mavwire import mavutil
    from mavwire.links import state

    before = state.wire_protocol, state.mavlink, state.current_dialect
    try:
        if wire_protocol is not None:
            state.set_wire_protocol(wire_protocol)
        with _naming_dialect(dialect, dialect or state.current_dialect):
            mavutil.set_dialect(dialect or state.current_dialect)
        yield
    finally:
        state.wire_protocol, state.mavlink, state.current_dialect = before


@contextmanager
def _naming_dialect(option: str | None, name: str) -> Iterator[None]:
    """What goes wrong while a dialect is loaded becomes a CommandError that names it."""
    try:
        yield
    except FileNotFoundError as error:
        raise CommandError(no_such_dialect(name)) from error
    except (OSError, ValueError) as error:
        raise CommandError(f"--dialect {option}: {error}") from error


@contextmanager
def opening(path: str) -> Iterator[None]:
    """What goes wrong while a log or a link is opened becomes a CommandError that says so."""
    try:
        yield
    except FileNotFoundError as error:
        raise CommandError(f"no such log: {path}") from error
    except (OSError, ValueError, ImportError) as error:
        raise CommandError(
            f"cannot open {path}: {error}; LOG is a .tlog, .BIN or .log file, or a link such as"
            " udpin:0.0.0.0:14550"
        ) from error


@contextmanager
def _naming(condition: str | None) -> Iterator[None]:
    """What goes wrong with a condition becomes a CommandError that shows it."""
    try:
        yield
    except Exception as error:
        if condition is None or isinstance(error, OSError):
            raise
        kind = type(error).__name__
        raise CommandError(f"--condition {condition!r}: {kind}: {error}") from error


class Reading:
    """A log that is being read: `link` as mavutil gives it, with progress for who waits."""

    def __init__(self, path: str, link: Any, progress: Progress) -> None:
        self.path = path
        self.link = link
        self.progress = progress

    def messages(
        self, types: Iterable[str] | None = None, condition: str | None = None
    ) -> Iterator[Any]:
        """The messages that `recv_match` gives for these arguments, to the end of the log."""
        wanted = None if types is None else list(types)
        receive = iter(partial(self.link.recv_match, condition, wanted), None)
        with _naming(condition):
            for first in receive:
                yield first
                yield from islice(receive, PROGRESS_EVERY)
                self.show_progress()

    def chunks(self) -> Iterator[Iterator[Any]]:
        """All messages, BAD_DATA and UNKNOWN included, some thousands at a time: for loops in which
        a generator would cost more than the reading.
        """
        receive = iter(self.link.recv_msg, None)
        for first in receive:
            yield chain((first,), islice(receive, PROGRESS_EVERY))
            self.show_progress()

    def holds(self, condition: str | None) -> bool:
        """Whether a condition holds now, with the newest messages of the vehicle."""
        if condition is None:
            return True
        with _naming(condition):
            return bool(self.link.check_condition(condition))

    def show_progress(self) -> None:
        """Tell how much of the log is read."""
        self.progress.update(getattr(self.link, "percent", 0.0))


@contextmanager
def reading(command: str, path: str, **options: Any) -> Iterator[Reading]:
    """Open a log for `mavwire COMMAND`, show progress, close it, and say so where it was no log.

    `options` are those of `mavlink_connection`.
    """
    from mavwire import mavutil
    from mavwire.cli._foreign import warn_if_foreign

    progress = Progress(os.path.basename(path))
    try:
        with opening(path):
            link = mavutil.mavlink_connection(path, progress_callback=progress.update, **options)
        try:
            yield Reading(path, link, progress)
        finally:
            link.close()
    finally:
        progress.finish()
    if not options.get("notimestamps"):
        warn_if_foreign(command, path)
