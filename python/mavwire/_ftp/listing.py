"""The entries of a directory as an answer holds them: D and a name, or F, a name, a tab and a size."""

from __future__ import annotations

from collections.abc import Iterator

from . import log
from .result import DirectoryEntry

MAX_ENTRIES = 100_000


class InvalidEntry(ValueError):
    """An entry that says no size."""


def split_entries(payload: bytes) -> list[bytes]:
    """The entries of an answer; the offset of the next request counts all of them."""
    return [one for one in payload.split(b"\0") if one]


def parse_entries(raw: list[bytes]) -> Iterator[DirectoryEntry]:
    """Entries that are files or directories. Names that would lead elsewhere are left out."""
    for one in raw:
        text = one.decode("utf-8", "surrogateescape")
        entry = _parse(text[0], text[1:])
        if entry is not None and _is_name(entry):
            yield entry


def writable(text: str) -> str:
    """A text for logs: files take them as UTF-8, which a stray byte of a name is none of."""
    return text.encode("utf-8", "backslashreplace").decode()


def _parse(kind: str, rest: str) -> DirectoryEntry | None:
    if kind == "D":
        return DirectoryEntry(rest, True, 0)
    if kind != "F":  # S marks an entry that is skipped
        return None
    name, tab, size = rest.rpartition("\t")
    if not tab:
        raise InvalidEntry(rest)
    if not size.isascii() or not size.isdigit():
        log.error("Invalid file size: %s", writable(size))
        size = "0"
    return DirectoryEntry(name, False, int(size[:20]))


def _is_name(entry: DirectoryEntry) -> bool:
    """Whether a name is that of something inside the directory."""
    inside = entry.name and "/" not in entry.name and "\\" not in entry.name
    if inside and (entry.is_dir or entry.name not in (".", "..")):
        return True
    log.warning("Ignored directory entry %a", entry.name)
    return False
