"""What a file without records is, in the words of an error."""

from __future__ import annotations

# What tells a file's format is in its first bytes.
HEAD_SIZE = 8192
ZSTD = (b"\x28\xb5\x2f\xfd", *(bytes((first,)) + b"\x2a\x4d\x18" for first in range(0x50, 0x60)))
"""How zstd files begin: with a frame, or one that is skipped."""
COMPRESSED = (b"\x1f\x8b\x08", *ZSTD)
"""How gzip and zstd begin."""


class LogFormatError(ValueError):
    """A file that is no telemetry log; the text names the file and what it is instead."""


def is_foreign(head: bytes) -> bool:
    """Whether a file that holds no record is something else than a log that ends within its first
    one, or right behind that, which is damaged.
    """
    from mavwire.links.recognise import LENGTH_HEAD, frame_length

    # Of a record the first byte of its time, which is 0 until the year 4253; of a raw stream a marker.
    stamped = head[8] in b"\xfd\xfe" if len(head) > 8 else head[:1] == b"\0"
    begins = stamped or head[:1] in (b"", b"\xfd", b"\xfe")
    frame = head[8:] if stamped else head
    goes_on = len(frame) >= LENGTH_HEAD and len(frame) > frame_length(frame[:LENGTH_HEAD])
    return goes_on or not begins or other_format(head) is not None


def not_telemetry(path: str, head: bytes, damage: str | None = None) -> LogFormatError:
    """The error that tells what a file without records is, by its first bytes, and what is wrong
    with a compressed one.
    """
    other = other_format(head)
    if other is None:
        from mavwire.links.recognise import DATAFLASH_SUFFIXES

        name = path.lower().removesuffix(".gz").removesuffix(".zst")
        return no_record("dataflash" if name.endswith(DATAFLASH_SUFFIXES) else "telemetry", path)
    kind, remedy = other
    said = f", as far as it can be read ({damage})" if damage else ""
    return LogFormatError(f"a {kind}, not a telemetry log{said}; {remedy}: {path!r}")


def no_record(kind: str, path: str) -> LogFormatError:
    formats = "`mavwire info --help` names the kinds of logs"
    remedy = f"{formats}; copy a truncated log again"
    return LogFormatError(f"no {kind} record found; {remedy}: {path!r}")


def begins_described(head: bytes) -> bool:
    """Whether a dataflash log begins with what describes its records."""
    from mavwire._native import begins_as_text_log
    from mavwire.links.recognise import DATAFLASH_HEAD

    return head.startswith(DATAFLASH_HEAD) or begins_as_text_log(head)


def undescribed(path: str) -> LogFormatError:
    """The error for a dataflash log in which nothing says what its records are."""
    lacks = "a dataflash log without its first part, which says what the records are (FMT)"
    return LogFormatError(f"{lacks}; copy it again from its start: {path!r}")


def other_format(head: bytes) -> tuple[str, str] | None:
    """What kind of file begins like this, if it is a known one, and what to do with it."""
    from mavwire._native import begins_as_text_log
    from mavwire.links.recognise import DATAFLASH_HEAD

    tables = "open_log and mavwire convert read those"
    if head.startswith(DATAFLASH_HEAD):
        return "dataflash log", tables
    if begins_as_text_log(head):
        return "dataflash text log", tables
    again = "repeat the copy or the download"
    for magic, name, remedy in (
        (b"PK\x03\x04", "ZIP archive", "unpack it first"),
        (b"\x1f\x8b", "gzip file", again),
        (ZSTD, "zstd file", again),
        (b"\x7fELF", "program", "name a log"),
        (b"ULog\x01\x12\x35", "ULog", "pyulog reads those"),
    ):
        if head.startswith(magic):
            return name, remedy
    return None
