"""A word on standard error about a file that is no log, or not the kind of log its name says.

Whatever looks like a record in it has been read all the same; the reader of the output should know
what it was read from.
"""

from __future__ import annotations

import os
from types import ModuleType, SimpleNamespace

from mavwire._native import LogKind, LogScan, identify
from mavwire.cli._errors import tell
from mavwire.links.recognise import TELEMETRY

# Which messages are looked for. The class for it in `mavwire.logs` takes time to load.
_EVERYTHING = SimpleNamespace(types=None, unknown=None, systems=None, start=None, end=None)
DAMAGED = "a telemetry log with damage before each record; run `mavwire repair` on it, and read the result"
COMPRESSED = "a compressed log, which info, convert and mavwire.read take as it is; unpack it first"


def warn_if_foreign(command: str, path: str, name: str | None = None) -> bool:
    """Whether `path` is a file and no log that the command reads by messages, as mavutil does, after
    saying what it is. That a log is empty or cut off in its first record is said too. `name` is what
    the user calls it, where that is not its path.
    """
    if not os.path.isfile(path):
        return False
    from mavwire.links import state

    try:
        kind = identify(path)
        if _has_messages(path, kind):
            return False
        said, is_foreign = _lacking(path, state.mavlink)
    except OSError:  # gone since it was read
        return False
    if not said and kind in TELEMETRY | {LogKind.GZIP, LogKind.ZSTD}:
        said, is_foreign = DAMAGED if kind in TELEMETRY else COMPRESSED, True
    if said:
        _say(command, said, path, name)
    return is_foreign


def warn_without_records(command: str, path: str, dialect: str, name: str | None = None) -> bool:
    """The same, for a command that reads logs of any kind as tables, whatever they are called, and
    has read no record of this one.
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


def _lacking(path: str, dialect: str | ModuleType) -> tuple[str, bool]:
    """Why there is no record in a file, and whether that is since it is no log; nothing where there
    is one.
    """
    from mavwire.logs.format_error import LogFormatError
    from mavwire.logs.no_records import lacking

    try:
        return lacking(path, dialect), False
    except LogFormatError as error:
        return str(error), True


def _has_messages(path: str, kind: LogKind) -> bool:
    """Whether mavutil is sure to find a message in a file."""
    if kind not in TELEMETRY:
        return kind is LogKind.DATAFLASH
    from mavwire.links import state

    native = state.mavlink.MAVLink(None)._dialect
    return next(LogScan(path, native, False, _EVERYTHING), None) is not None
