"""A word on standard error about a file that is no log, or not the kind of log its name says.

Whatever looks like a record in it has been read all the same; the reader of the output should know
what it was read from.
"""

from __future__ import annotations

import os
import sys

TELEMETRY = "tlog"
# What the FMT record of FMT itself takes: a dataflash log has at least that.
FMT_LEN = 89


def warn_if_foreign(command: str, path: str, nothing_read: bool = False) -> bool:
    """Whether `path` is a file and no log of any kind, after saying what it is. That a log is empty
    is said too. `nothing_read` tells that no message came out of it.
    """
    from mavwire.links.recognise import log_kind

    if not os.path.isfile(path):
        return False
    if not os.path.getsize(path):
        _tell(command, f"the log is empty: {path!r}", path)
        return False
    try:
        if log_kind(path, readonly=True) == TELEMETRY:
            problem = _telemetry_problem(command, path, nothing_read)
        else:
            problem = _dataflash_problem(path)
    except OSError:  # gone since it was read
        return False
    if problem:
        _tell(command, problem, path)
    return bool(problem)


def _tell(command: str, problem: str, path: str) -> None:
    from mavwire.cli._reading import is_standard_input

    if is_standard_input(path):  # a file whose name nobody has given
        problem = problem.replace(repr(path), "standard input")
    print(f"mavwire {command}: {problem}", file=sys.stderr)


def _telemetry_problem(command: str, path: str, nothing_read: bool) -> str:
    """What makes a file no telemetry log that the command could read, if anything does."""
    from mavwire.links.recognise import TLOG_PROBE, looks_like_tlog, read_head

    if looks_like_tlog(read_head(path, TLOG_PROBE)) and not nothing_read:
        return ""
    from mavwire.logs import LogFormatError, TelemetryLog
    from mavwire.logs.telemetry import HEAD_SIZE, not_telemetry

    try:
        with TelemetryLog(path) as log:
            if not log.compressed:
                found = next(iter(log), None) is not None
                return "" if found else str(not_telemetry(path, read_head(path, HEAD_SIZE)))
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
    from mavwire.links.recognise import DATAFLASH_HEAD, log_kind, read_head

    head = read_head(path, FMT_LEN)
    if len(head) == FMT_LEN and head.startswith(DATAFLASH_HEAD):
        return ""
    text = log_kind(path, readonly=True) == "text"
    with (DFReader_text if text else DFReader_binary)(path) as log:
        empty = log.recv_msg() is None
    return f"no dataflash log, there is no record in it: {path!r}" if empty else ""
