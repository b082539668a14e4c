"""Texts about logs without records, with advice. All commands use them."""

from __future__ import annotations

from .dialect import Dialects
from .sources import check_run
from .telemetry import open_log

EMPTY = "the log is empty: repeat the copy or the download"
NO_RECORD = "the log ends within its first record: repeat the copy or the download"


def lacking(path: str, dialect: Dialects) -> str:
    """Why a log has no record; empty for a log that has any. LogFormatError for a file that is not a log."""
    with open_log(path, dialect=dialect) as log:
        found = log.info()
    if found.messages:
        return ""
    check_run(path, path, found.bytes, found.bad_bytes, found.damage)
    return NO_RECORD if found.bytes else EMPTY


def check_records(path: str, dialect: Dialects) -> None:
    """Raise ValueError for a file without a record, which tells why there is none."""
    if said := lacking(path, dialect):
        raise ValueError(f"{said}: {path!r}")
