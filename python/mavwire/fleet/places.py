"""Logs wherever they are: local paths and what fsspec opens, and ranges of their bytes.

The native reader takes files, ranges of files, and bytes. A log of an object store is fetched into
memory, or into a temporary file where it is large.
"""

from __future__ import annotations

import glob
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, SupportsIndex

from mavwire._native import identify
from mavwire._text import naming
from mavwire.logs.format_error import COMPRESSED, LogFormatError
from mavwire.logs.reading import absolute, check_readable, matches, paths_of
from mavwire.logs.sources import Source, is_dataflash

IN_MEMORY = 128 << 20
"""Bytes of a log that are held in memory; a larger one goes to a file."""

ByteRange = tuple[int, int]
"""The first byte, and the first one that does not belong to it."""
Part = tuple[int, int, bool]
"""The same of a telemetry log, and whether its records have time stamps."""


def is_url(path: str) -> bool:
    """Whether fsspec has to open it."""
    return "://" in path or "::" in path


def file_system(url: str, options: Mapping[str, Any] | None) -> tuple[Any, str]:
    """The file system of a URL and the path in it; ImportError and ValueError as fsspec raises."""
    from fsspec.core import url_to_fs

    fs, path = url_to_fs(url, **(options or {}))
    return fs, str(path)


def expand(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    options: Mapping[str, Any] | None = None,
) -> list[str]:
    """Paths, patterns and URLs as a list of absolute paths and URLs, each once.

    A pattern that matches nothing, or whose file system nobody has, stays as it is, and is then a
    log that is missing. Other errors are those of the file system.
    """
    found = [one for path in paths_of(paths) for one in _matches(path, options)]
    return list(dict.fromkeys(found))


def _matches(path: str, options: Mapping[str, Any] | None) -> list[str]:
    path = path.removeprefix("file://").removeprefix("local://")
    if not is_url(path):
        return [absolute(one) for one in matches(path)]
    if "::" in path or not glob.has_magic(path):
        return [_one_spelling(path)]
    try:
        fs, inner = file_system(path, options)
        found = [] if fs.exists(inner) else sorted(map(fs.unstrip_protocol, fs.glob(inner)))
    except (ImportError, ValueError):
        found = []  # which the log's row says
    return [_one_spelling(one) for one in found or [path]]


def _one_spelling(url: str) -> str:
    """A log of fsspec's memory has two addresses, of which patterns give one: it would be two logs."""
    return url.replace("memory:///", "memory://", 1) if url.startswith("memory:///") else url


def status(path: str, options: Mapping[str, Any] | None = None) -> tuple[int, int]:
    """Bytes of a log and when it was changed, in nanoseconds since 1970; 0 where nobody says."""
    if not is_url(path):
        found = os.stat(path)
        return found.st_size, found.st_mtime_ns
    fs, inner = file_system(path, options)
    size = fs.size(inner) or 0
    try:
        changed = fs.modified(inner)
    except (NotImplementedError, KeyError, TypeError):
        return size, 0
    return size, round(changed.timestamp() * 1e6) * 1000


@contextmanager
def located(
    path: str, byte_range: ByteRange | Part | None = None, options: Mapping[str, Any] | None = None
) -> Iterator[Source]:
    """The native reader's argument for a log or a range of it.

    OSError and what fsspec raises where it cannot be read, ValueError for a range that is not
    there.
    """
    if byte_range is not None and not _is_range(byte_range):
        raise ValueError(f"{path}: a range is the first byte and the end, not {byte_range!r}")
    if not is_url(path):
        check_readable(path)
        if byte_range is not None:
            _check_range(path, *byte_range[:2], os.path.getsize(path))
        yield path if byte_range is None else (path, *byte_range)
        return
    fs, inner = file_system(path, options)
    size = fs.size(inner)
    if byte_range is not None:
        start, end = byte_range[:2]
        _check_range(path, start, end, end if size is None else size)
        yield bytes(fs.cat_file(inner, start=start, end=end))
        return
    if size is not None and size <= IN_MEMORY:
        yield bytes(fs.cat_file(inner))
        return
    with tempfile.TemporaryDirectory(prefix="mavwire-") as folder:
        copy = os.path.join(folder, os.path.basename(inner) or "log")
        fs.get_file(inner, copy)
        yield copy


def _is_range(given: object) -> bool:
    sequence = isinstance(given, tuple | list) and len(given) in (2, 3)
    return sequence and all(isinstance(one, SupportsIndex) for one in given)  # type: ignore[attr-defined]


def _check_range(path: str, start: int, end: int, size: int) -> None:
    if not 0 <= start <= end:
        raise ValueError(f"{path}: no range of bytes: {start} to {end}")
    if end > size:
        raise ValueError(f"{path} ends {end - size} bytes before the range {start} to {end} does")


HEAD = 256 << 10
"""First bytes of a log, which tell what it is."""


def _head(path: str, options: Mapping[str, Any] | None) -> Source:
    """A local log, or the first bytes of another one."""
    if not is_url(path):
        return path
    fs, inner = file_system(path, options)
    return bytes(fs.cat_file(inner, start=0, end=min(HEAD, fs.size(inner) or HEAD)))


def begins_as_dataflash(path: str, options: Mapping[str, Any] | None = None) -> bool:
    """Whether a log begins as a dataflash log. Raises OSError or an error of fsspec if it cannot be read."""
    return is_dataflash(_head(path, options))


def check_divisible(path: str, options: Mapping[str, Any] | None = None) -> None:
    """Raise LogFormatError for a log of which nothing but ranges from its start can be read."""
    head = _head(path, options)
    with naming(path):
        kind = identify(head)
    if kind in COMPRESSED:
        what = "a compressed log, which can be read from its start alone"
    elif is_dataflash(head):
        what = "a dataflash log, whose first bytes say what its records are (FMT)"
    else:
        return
    raise LogFormatError(f"no range of {what}; leave byte_range out: {path!r}")


LOOKERS = 16
"""Threads that ask for the sizes of logs at URLs."""


def statuses(
    logs: list[str], options: Mapping[str, Any] | None
) -> dict[str, tuple[int, int] | Exception]:
    """The size and time of each log, or why these cannot be had."""

    def ask(path: str) -> tuple[int, int] | Exception:
        try:
            return status(path, options)
        except Exception as error:  # file systems of fsspec raise errors of any type
            return error

    remote = [path for path in logs if is_url(path)]
    with ThreadPoolExecutor(LOOKERS) as pool:
        found = dict(zip(remote, pool.map(ask, remote), strict=True))
    return {path: found[path] if path in found else ask(path) for path in logs}
