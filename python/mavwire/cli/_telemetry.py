"""Telemetry logs: the check for one, and its records."""

from __future__ import annotations

from typing import Any

from mavwire._log_link import kind_of
from mavwire.cli._errors import CommandError, refused
from mavwire.cli._reading import Reading

BAD_DATA = -1
# The last time that a record can have, in microseconds.
MAX_STAMP = 2**64 - 1


def require_telemetry(log: Reading) -> None:
    """CommandError for a dataflash or CSV log."""
    kind = kind_of(log.link)
    if kind != "telemetry":
        if kind == "dataflash":
            _check_records(log.path)
        raise CommandError(f"{log.path} is a {kind} log; this is for telemetry only")


def _check_records(path: str) -> None:
    """CommandError for a file without a record whose name is that of a dataflash log."""
    from mavwire.links import state
    from mavwire.logs.no_records import check_records

    with refused(ValueError):
        check_records(path, state.mavlink)


def is_damaged(msg: Any) -> bool:
    """Whether it is BAD_DATA."""
    return bool(msg.get_msgId() == BAD_DATA)


def record(msg: Any) -> bytes:
    """A message as a record of a telemetry log."""
    return record_of(msg._timestamp, msg.get_msgbuf())


def record_of(stamp: float, frame: bytes) -> bytes:
    """A frame as a record of a telemetry log; times are cut to microseconds as pymavlink does."""
    micros = min(int(stamp * 1.0e6), MAX_STAMP)  # a float may round beyond
    return micros.to_bytes(8, "big") + frame
