"""Errors for files without records."""

from __future__ import annotations

from mavwire._native import LogKind
from mavwire._text import OTHER_TEXT

COMPRESSED = frozenset((LogKind.GZIP, LogKind.ZSTD))
_TABLES = "open_log and mavwire convert read those"
_AGAIN = "repeat the copy or the download"
_OTHERS = {
    LogKind.DATAFLASH: ("dataflash log", _TABLES),
    LogKind.DATAFLASH_TEXT: ("dataflash text log", _TABLES),
    LogKind.HEADERLESS: ("dataflash log", _TABLES),
    LogKind.OTHER_TEXT: ("text log in UTF-16 or with carriage returns alone", OTHER_TEXT),
    LogKind.GZIP: ("gzip file", _AGAIN),
    LogKind.ZSTD: ("zstd file", _AGAIN),
    LogKind.ZIP: ("ZIP archive", "unpack it first"),
    LogKind.PROGRAM: ("program", "name a log"),
    LogKind.ULOG: ("ULog", "pyulog reads those"),
    LogKind.PNG: ("PNG image", "name a log"),
    LogKind.PCAP: ("packet capture", "there is no MAVLink frame in it"),
    LogKind.SQLITE: ("database", "name a log"),
}
"""Names of formats, and advice for files of them."""


class LogFormatError(ValueError):
    """A file that is no telemetry log; the text names the file and what it is instead."""


def not_telemetry(path: str, kind: LogKind, damage: str | None = None) -> LogFormatError:
    """The error that tells what a file without records is, and what is wrong with a compressed one."""
    if kind not in _OTHERS:
        from mavwire.links.recognise import DATAFLASH_SUFFIXES

        name = path.lower().removesuffix(".gz").removesuffix(".zst")
        return no_record("dataflash" if name.endswith(DATAFLASH_SUFFIXES) else "telemetry", path)
    other, remedy = _OTHERS[kind]
    said = f", as far as it can be read ({damage})" if damage else ""
    return LogFormatError(f"a {other}, not a telemetry log{said}; {remedy}: {path!r}")


def no_record(kind: str, path: str) -> LogFormatError:
    formats = "`mavwire info --help` names the kinds of logs"
    remedy = f"{formats}; copy a truncated log again"
    return LogFormatError(f"no {kind} record found; {remedy}: {path!r}")


def undescribed(path: str) -> LogFormatError:
    """The error for a dataflash log in which nothing says what its records are."""
    lacks = "a dataflash log without its first part, which says what the records are (FMT)"
    return LogFormatError(f"{lacks}; copy it again from its start: {path!r}")
