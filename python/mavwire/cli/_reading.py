"""Logs and links that subcommands read, and the errors of opening them."""

from __future__ import annotations

import os
import sys
import time
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from functools import partial
from itertools import chain, islice
from typing import Any, TypeVar

from mavwire import _log_link
from mavwire._log_link import kind_of
from mavwire._native import LogKind, identify
from mavwire._text import in_words, naming, no_such_dialect
from mavwire.cli._errors import CommandError, tell
from mavwire.cli._progress import Progress

T = TypeVar("T")

PROGRESS_EVERY = 20_000
# The name of standard input in texts, and of its file. The suffix suits each kind of log.
STANDARD_INPUT = "standard input"
STANDARD_INPUT_FILE = "stdin.log"
UNKNOWN_ID = "UNKNOWN_"
# Seconds between looks at the end of a log that is followed.
FOLLOW_EVERY = 0.05


def definitions(
    dialect: str | list[str] | None = None, wire_protocol: str | None = None
) -> AbstractContextManager[None]:
    """The same as of `mavwire._log_link`; CommandError names a dialect that does not load."""
    return _log_link.definitions(dialect, wire_protocol, _naming_dialect)


@contextmanager
def _naming_dialect(dialect: str | list[str]) -> Iterator[None]:
    """Turn errors of loading a dialect into a CommandError that names it."""
    name = dialect if isinstance(dialect, str) else ", ".join(dialect)
    try:
        yield
    except FileNotFoundError as error:
        raise CommandError(no_such_dialect(name)) from error
    except (OSError, ValueError) as error:
        raise CommandError(f"--dialect {name}: {in_words(error, name)}") from error


@contextmanager
def standard_input() -> Iterator[str]:
    """The path of a temporary file that holds what standard input gives, read to its end."""
    from shutil import copyfileobj
    from tempfile import TemporaryDirectory

    if sys.stdin is None or sys.stdin.isatty():
        raise CommandError("- is a log on standard input: zcat flight.tlog.gz | mavwire ... -")
    with TemporaryDirectory(prefix="mavwire-") as folder:
        path = os.path.join(folder, STANDARD_INPUT_FILE)
        try:
            with open(path, "wb") as file:
                copyfileobj(sys.stdin.buffer, file)
        except OSError as error:
            raise CommandError(f"cannot keep standard input in {folder}: {error}") from error
        yield path


@contextmanager
def opening(path: str, name: str | None = None) -> Iterator[None]:
    """Turn errors of opening a log or a link into a CommandError. `name` is the user's name of it,
    if that is not its path.
    """
    hint = "; LOG is a .tlog, .BIN or .log file, or a link such as udpin:0.0.0.0:14550"
    # Not where it is the content that is wrong, or the way there.
    if os.path.isfile(path) or os.path.islink(path):
        hint = ""
    try:
        yield
    except FileNotFoundError as error:
        raise CommandError(f"no such log: {name or path}") from error
    except (OSError, ValueError, ImportError) as error:
        raise CommandError(f"cannot open {name or path}: {in_words(error, path)}{hint}") from error


@contextmanager
def _unpacked(command: str, path: str, name: str) -> Iterator[str]:
    """The path of a log, or of a temporary file with the content of a compressed one. Damage to the
    compressed file is reported on standard error.
    """

    def damaged(why: str) -> None:
        tell(f"mavwire {command}: the compressed log is cut off or damaged ({why}): {name!r}")

    with ExitStack() as stack:
        with opening(path, name):
            if os.path.isfile(path) and identify(path) in (LogKind.GZIP, LogKind.ZSTD):
                from mavwire.logs.sources import decompressed  # which few logs need

                path = stack.enter_context(decompressed(path, damaged))
        yield path


def _condition_error(condition: str, error: Exception) -> CommandError:
    """The error of a condition, with its text."""
    if not condition.strip():
        return CommandError(f"--condition {condition!r}: the condition is empty")
    return CommandError(f"--condition {condition!r}: {in_words(error)}")


def _word_in(msg: Any) -> ValueError | None:
    """The error of a message of a text log with a word in place of a number."""
    try:
        msg.to_dict()
    except ValueError as error:
        return error
    return None


class Reading:
    """A log that is being read: the `link` of mavutil, with progress."""

    def __init__(self, command: str, path: str, link: Any, progress: Progress) -> None:
        self.command = command
        self.path = path
        self.link = link
        self.progress = progress
        self.by_index = False
        """Whether records were looked up by type."""
        self.unknown: dict[tuple[int, int | None] | None, int] = {}
        """Messages that were printed though the dialect does not define them, as `unknown_text` takes them."""
        self.is_text = self._is_text_log()
        self._checked: str | None = None
        """The condition whose names were checked."""

    def messages(
        self,
        types: Iterable[str] | None = None,
        condition: str | None = None,
        blocking: bool = False,
    ) -> Iterator[Any]:
        """The messages of `recv_match` for these arguments, to the end of the log. Lines of a text
        log with a word in place of a number are left out.
        """
        self._check_names(condition)
        if blocking and self._is_telemetry_log():
            yield from self._follow(types, condition)
            return
        wanted = None if types is None else list(types)
        self.by_index = wanted is not None
        # In a text log it is for `holds` to say what a condition over words gives.
        checked = None if self.is_text else condition
        receive = self._received(wanted, checked, blocking)
        if self.is_text:
            receive = (msg for msg in receive if self._has_numbers(msg) and self.holds(condition))
        try:
            with naming(self.path):
                for first in receive:
                    yield first
                    yield from islice(receive, PROGRESS_EVERY)
                    self.show_progress()
        except Exception as error:
            if condition is None or isinstance(error, (CommandError, OSError)):
                raise
            raise _condition_error(condition, error) from error

    def _received(
        self, types: list[str] | None, condition: str | None, blocking: bool
    ) -> Iterator[Any]:
        """The messages for these arguments, to the end of the log."""
        receive = self.link.recv_match
        return iter(lambda: receive(condition, types, blocking), None)

    @property
    def used_index(self) -> bool:
        """Whether records were found by an index."""
        return self.by_index and bool(getattr(self.link, "counts", None))

    def _is_telemetry_log(self) -> bool:
        from mavwire import mavutil

        return isinstance(self.link, mavutil.mavlogfile)

    def _follow(self, types: Iterable[str] | None, condition: str | None) -> Iterator[Any]:
        """The messages of a telemetry log, and those that are appended to it, without an end. One
        that became shorter was begun anew.
        """
        while True:
            yield from self.messages(types, condition)
            if os.fstat(self.link.f.fileno()).st_size < self.link.f.tell():
                text = f"mavwire {self.command}: the log was cut, it is read from its start again"
                tell(f"{text}: {self.path!r}")
                # The index is built again too.
                getattr(self.link, "init_arrays", partial(self.link.f.seek, 0))()
            time.sleep(FOLLOW_EVERY)

    def _is_text_log(self) -> bool:
        if hasattr(self.link, "mav"):
            return False
        from mavwire.DFReader import DFReader_text

        return isinstance(self.link, DFReader_text)

    def _has_numbers(self, msg: Any) -> bool:
        """Whether numeric fields hold numbers. Warns if not."""
        error = _word_in(msg)
        if error is not None:
            tell(f"mavwire {self.command}: {msg.get_type()} passed over: {error}")
        return error is None

    def _has_words(self) -> bool:
        """Whether one of the newest messages has a word in the place of a number."""
        newest = self.link.messages.values()
        return self.is_text and any(_word_in(msg) for msg in newest if hasattr(msg, "to_dict"))

    def chunks(self, condition: str | None = None) -> Iterator[Iterator[Any]]:
        """All messages, BAD_DATA and UNKNOWN included, some thousands at a time: for loops in which
        a generator would cost more than the reading. CommandError for a condition that is wrong,
        also where the loop never asks whether it holds.
        """
        self.holds(condition)
        receive = iter(self.link.recv_msg, None)
        for first in receive:
            yield chain((first,), islice(receive, PROGRESS_EVERY))
            self.holds(condition)  # with messages: now a field may turn out not to be there
            self.show_progress()

    def holds(self, condition: str | None) -> bool:
        """Whether a condition holds now, with the newest messages of the vehicle. It does not if a
        numeric field holds a word.
        """
        if condition is None:
            return True
        self._check_names(condition)
        try:
            return bool(self.link.check_condition(condition))
        except Exception as error:
            if isinstance(error, ValueError) and self._has_words():
                return False
            raise _condition_error(condition, error) from error

    def _check_names(self, condition: str | None) -> None:
        """Warn once of unknown names in a condition."""
        if condition is None or condition is self._checked:
            return
        from mavwire.cli._message_types import tell_unknown_in

        self._checked = condition
        tell_unknown_in(condition, self)

    def count_unknown(self, kind: str) -> None:
        """Count a message that is printed, by its type."""
        msgid = kind.removeprefix(UNKNOWN_ID)
        if msgid != kind and msgid.isdecimal():  # a row of a CSV log may have any name
            self.unknown[int(msgid), None] = self.unknown.get((int(msgid), None), 0) + 1

    def show_progress(self) -> None:
        """Update the progress bar."""
        self.progress.update(getattr(self.link, "percent", 0.0))


# Shared options -> what `mavlink_connection` calls them.
_LINK_OPTIONS = {
    "no_timestamps": "notimestamps",
    "planner": "planner_format",
    "robust": "robust_parsing",
    "zero_time_base": "zero_time_base",
}


def link_options(args: Namespace) -> dict[str, Any]:
    """The options of a command line for `reading`."""
    given = vars(args)
    return {theirs: given[ours] for ours, theirs in _LINK_OPTIONS.items() if ours in given}


@contextmanager
def reading(
    command: str,
    path: str,
    show_progress: bool = True,
    first_try: Callable[[str], Any] = lambda path: None,
    name: str | None = None,
    **options: Any,
) -> Iterator[Reading]:
    """Open a log for `mavwire COMMAND`, decompress it if need be, show progress, close it, and warn if
    it was no log.

    `name` is the user's name of the log, if that is not its path. `options` are those of
    `mavlink_connection`, which opens the log if `first_try` of the path gives None.
    """
    name = name or path
    with (
        _unpacked(command, path, name) as plain,
        _opened(command, plain, show_progress, first_try, name, options) as log,
    ):
        yield log


@contextmanager
def _opened(
    command: str,
    path: str,
    show_progress: bool,
    first_try: Callable[[str], Any],
    name: str,
    options: dict[str, Any],
) -> Iterator[Reading]:
    """The same of a log that is not compressed."""
    from mavwire.cli._foreign import warn_if_foreign

    with Progress(os.path.basename(name), show_progress) as progress:
        with opening(path, name):
            link = first_try(path) or _log_link.open_link(
                path, progress_callback=progress.update, **options
            )
        try:
            log = Reading(command, name, link, progress)
            yield log
        except AttributeError as error:
            msg: Any = error.obj
            if not hasattr(msg, "fmt"):  # no message of a dataflash log: it is ours
                raise
            raise CommandError(f"{name}: {msg.get_type()} has no column {error.name}") from error
        except (LookupError, ValueError, OverflowError) as error:
            if kind_of(link) != "CSV":
                raise
            raise CommandError(f"{name}: a row without a time or a cell: {error}") from error
        finally:
            link.close()
    if not options.get("notimestamps"):
        warn_if_foreign(command, path, name, log.unknown, is_indexed=log.used_index)


def results(
    command: str,
    args: Namespace,
    work: Callable[[Reading], T],
    title: str = "Processing log {}",
    dialect: str | None = None,
    wire_protocol: str | None = None,
    **options: Any,
) -> Iterator[T]:
    """The result of `work` for each log of a command line, once the log is closed. Its title is
    printed in front.

    The dialect is that of the command line, if it has one. `options` are those of `reading`.
    """
    for path in args.logs:
        if title:
            print(title.format(path))
        with (
            definitions(dialect or getattr(args, "dialect", None), wire_protocol),
            reading(command, path, **link_options(args), **options) as log,
        ):
            result = work(log)
        yield result


def read_each(
    command: str, args: Namespace, work: Callable[[Reading], T], **options: Any
) -> list[T]:
    """The `results` of all logs."""
    return list(results(command, args, work, **options))
