"""A word on standard error about a file that is no log, or not the kind of log its name says.

Whatever looks like a record in it has been read all the same; the reader of the output should know
what it was read from.
"""

from __future__ import annotations

import os

from mavwire.cli._errors import tell

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType

TELEMETRY = ("tlog", "raw")
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
        if _has_messages(path):
            return False
        said, is_foreign = _lacking(path, state.mavlink)
        if not said:
            said, is_foreign = _other_reader(path), True
    except OSError:  # gone since it was read
        return False
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


def _has_messages(path: str) -> bool:
    """Whether mavutil finds a message in a file, of which it knows by its name what it is."""
    from mavwire.links.recognise import DATAFLASH_HEAD, FMT_LEN, log_kind, read_head

    kind = log_kind(path, readonly=True)
    if kind in TELEMETRY:
        return _has_telemetry(path)
    head = read_head(path, FMT_LEN)
    if len(head) == FMT_LEN and head.startswith(DATAFLASH_HEAD):
        return True
    # Readers refuse an empty log, and find what chance made in one that is not described.
    if not head or _is_undescribed(path):
        return False
    from mavwire.DFReader import DFReader_binary, DFReader_text

    with (DFReader_text if kind == "text" else DFReader_binary)(path) as log:
        return log.recv_msg() is not None


def _is_undescribed(path: str) -> bool:
    """Whether a file is a dataflash log without its first part, which nothing describes further on."""
    from mavwire.logs.format_error import LogFormatError
    from mavwire.logs.sources import is_headerless, open_dataflash

    if not is_headerless(path):
        return False
    try:
        open_dataflash(path, path)
    except LogFormatError:
        return True
    return False


def _has_telemetry(path: str) -> bool:
    from mavwire.links.recognise import TLOG_PROBE, looks_like_tlog, read_head

    if looks_like_tlog(read_head(path, TLOG_PROBE)):
        return True
    from mavwire.links import state
    from mavwire.logs.format_error import LogFormatError
    from mavwire.logs.sources import is_dataflash
    from mavwire.logs.telemetry import TelemetryLog

    if is_dataflash(path):  # in which chance makes a message or two
        return False
    try:
        with TelemetryLog(path, dialect=state.mavlink, resync="skip") as log:
            return not log.compressed and next(iter(log), None) is not None
    except LogFormatError:
        return False


def _other_reader(path: str) -> str:
    """What to do with a log that has records, none of which mavutil finds."""
    from mavwire.logs.sources import is_compressed, is_dataflash

    if is_compressed(path):
        return COMPRESSED
    if is_dataflash(path):
        return "a dataflash log; call it .BIN, or .log if it is a text, to have it read as one"
    return "a telemetry log with damage before each record; run `mavwire repair` on it, and read the result"
