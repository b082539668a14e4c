"""A word on standard error about a file that is no log, or not the kind of log its name says.

Whatever looks like a record in it has been read all the same; the reader of the output should know
what it was read from.
"""

from __future__ import annotations

import os
import sys

TELEMETRY = "tlog"
EMPTY = "the log is empty"
NO_RECORD = "no record of the log is whole; copy it again if there should be more"


def warn_if_foreign(
    command: str, path: str, nothing_read: bool = False, name: str | None = None
) -> bool:
    """Whether `path` is a file and no log of any kind, after saying what it is. That a log is empty
    or cut off in its first record is said too. `nothing_read` tells that no message came out of it,
    `name` what the user calls it, where that is not its path.
    """
    from mavwire.links.recognise import log_kind

    if not os.path.isfile(path):
        return False
    try:
        lacking, problem = _lacking(command, path), ""
        if not lacking and log_kind(path, readonly=True) == TELEMETRY:
            problem = _telemetry_problem(command, path, nothing_read)
        elif not lacking:
            problem = _dataflash_problem(path)
    except OSError:  # gone since it was read
        return False
    if said := lacking or problem:
        said = said.removesuffix(f": {path!r}")
        print(f"mavwire {command}: {said}: {name or path!r}", file=sys.stderr)
    return bool(problem)


def _lacking(command: str, path: str) -> str:
    """What a log lacks that is so short that no record of it is whole; nothing of another file."""
    from mavwire.links.recognise import LONGEST_RECORD

    if os.path.getsize(path) > LONGEST_RECORD:
        return ""
    from mavwire.links import state
    from mavwire.logs.sources import is_compressed
    from mavwire.logs.telemetry import LogFormatError, open_log

    try:
        compressed = is_compressed(path)
        with open_log(path, dialect=state.mavlink, resync="skip") as log:
            if compressed and command != "info":
                return ""
            if not compressed and next(iter(log), None) is not None:
                return ""
            found = log.info()
    except LogFormatError:
        return ""
    if found.messages:
        return ""
    return NO_RECORD if found.bytes else EMPTY


def _telemetry_problem(command: str, path: str, nothing_read: bool) -> str:
    """What makes a file no telemetry log that the command could read, if anything does."""
    from mavwire.links.recognise import TLOG_PROBE, looks_like_tlog, read_head

    if looks_like_tlog(read_head(path, TLOG_PROBE)) and not nothing_read:
        return ""
    from mavwire.links import state
    from mavwire.logs import LogFormatError, TelemetryLog

    try:
        with TelemetryLog(path, dialect=state.mavlink, resync="skip") as log:
            if not log.compressed:
                return ""
    except LogFormatError as error:
        return str(error)
    if command == "info":
        return ""
    return (
        "a compressed log, which info, convert and mavwire.read take as it is;"
        f" unpack it first: {path!r}"
    )


def _dataflash_problem(path: str) -> str:
    """What makes a file no dataflash log, if anything does."""
    from mavwire.DFReader import DFReader_binary, DFReader_text
    from mavwire.links.recognise import DATAFLASH_HEAD, FMT_LEN, log_kind, read_head

    head = read_head(path, FMT_LEN)
    if len(head) == FMT_LEN and head.startswith(DATAFLASH_HEAD):
        return ""
    text = log_kind(path, readonly=True) == "text"
    with (DFReader_text if text else DFReader_binary)(path) as log:
        empty = log.recv_msg() is None
    return f"no dataflash log, there is no record in it: {path!r}" if empty else ""
