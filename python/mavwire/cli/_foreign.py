"""Warnings about files that are no logs, or not the kind of log that their name says.

Commands may find bytes in such a file that look like a record, so the user has to know.
"""

from __future__ import annotations

import os
from contextlib import closing
from typing import TYPE_CHECKING, Any

from mavwire._log_link import open_link
from mavwire._native import LogKind, identify
from mavwire.cli._errors import tell

if TYPE_CHECKING:
    from mavwire.logs.dialect import Dialects
    from mavwire.logs.unknown import Counts

DAMAGED = "a telemetry log with damage before each record; run `mavwire repair` on it, and read the result"


def warn_if_foreign(
    command: str, path: str, name: str | None, unknown: Counts, *, is_indexed: bool
) -> None:
    """Warn of a file that mavutil finds no message in, of a log that is empty or cut off in its first
    record, or else of the messages in `unknown`, which were printed though the dialect does not define them.

    `name` is the user's name of the file. `is_indexed` says that the command took records from the
    index of the log, which has some that reading from the start misses.
    """
    said = _without_message(path, is_indexed) if os.path.isfile(path) else ""
    if said or unknown:
        _say(command, said or _undefined(unknown), path, name)


def _without_message(path: str, is_indexed: bool) -> str:
    """Why mavutil finds no message in a file; empty where it finds one."""
    from mavwire.links import state

    try:
        kind = identify(path)
        if kind is LogKind.DATAFLASH or (kind.is_telemetry and (is_indexed or _begins(path, kind))):
            return ""
        said, _ = _lacking(path, state.mavlink)
        if not said and kind.is_telemetry and not _has_message(open_link(path)):
            from mavwire.logs import open_log  # which only such files need

            with open_log(path, dialect=state.mavlink) as log:
                unknown = log.info().unknown
            return _undefined(unknown) if unknown else DAMAGED
    except OSError:  # gone since it was read
        return ""
    return said


def _undefined(counts: Counts) -> str:
    from mavwire.links import state
    from mavwire.logs.unknown import unknown_text

    return unknown_text(counts, state.mavlink, "option")


def warn_without_records(
    command: str, path: str, dialect: Dialects, name: str | None = None
) -> bool:
    """Warn of a log in which a command that reads logs of any kind as tables found no record. Returns
    whether the file is no log.
    """
    if not os.path.isfile(path):
        return False
    try:
        said, is_foreign = _lacking(path, dialect)
    except OSError:  # gone since it was read
        return False
    if said:
        _say(command, said, path, name)
    return is_foreign


def _say(command: str, said: str, path: str, name: str | None) -> None:
    said = said.removesuffix(f": {path!r}")
    tell(f"mavwire {command}: {said}: {name or path!r}")


def _lacking(path: str, dialect: Dialects) -> tuple[str, bool]:
    """Why there is no record in a file, and whether that is since it is no log; nothing where there
    is one.
    """
    from mavwire.logs.format_error import LogFormatError
    from mavwire.logs.no_records import lacking

    try:
        return lacking(path, dialect), False
    except LogFormatError as error:
        return str(error), True


def _begins(path: str, kind: LogKind) -> bool:
    """Whether there is a message in a telemetry log that is read without an index."""
    from mavwire import mavutil

    return _has_message(mavutil.mavlogfile(path, notimestamps=kind is LogKind.RAW))


def _has_message(link: Any) -> bool:
    with closing(link) as log:
        return any(msg.get_msgId() >= 0 for msg in iter(log.recv_msg, None))
