"""A word on standard error about a file that is something else than a telemetry log.

Whatever looks like a frame in it has been read all the same; the reader of the output should know
what it was read from.
"""

from __future__ import annotations

import os
import sys

TELEMETRY = "tlog"


def warn_if_foreign(command: str, path: str) -> bool:
    """Whether `path` is a file and no log of any kind, after saying what it is. That a log is empty
    is said too.
    """
    from mavwire.links.recognise import TLOG_PROBE, log_kind, looks_like_tlog, read_head

    if not os.path.isfile(path) or log_kind(path, readonly=True) != TELEMETRY:
        return False
    if looks_like_tlog(read_head(path, TLOG_PROBE)):
        return False
    from mavwire.logs import LogFormatError, TelemetryLog

    if not os.path.getsize(path):
        print(f"mavwire {command}: the log is empty: {path!r}", file=sys.stderr)
        return False
    try:
        with TelemetryLog(path) as log:
            compressed = log.compressed
    except LogFormatError as error:
        print(f"mavwire {command}: {error}", file=sys.stderr)
        return True
    except OSError:  # gone since it was read
        return False
    if compressed and command != "info":
        print(
            f"mavwire {command}: a compressed log, which info, convert and mavwire.read take as it is;"
            f" unpack it first: {path!r}",
            file=sys.stderr,
        )
        return True
    return False
