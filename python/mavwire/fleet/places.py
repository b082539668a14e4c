"""Logs wherever they are: local paths and what fsspec opens, and ranges of their bytes.

The native reader takes a local file that it reads from the start. A range of a log, and a log on an
object store, is therefore copied to a temporary file first.
"""

from __future__ import annotations

import errno
import glob
import os
import tempfile
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

CHUNK = 8 << 20

ByteRange = tuple[int, int]
"""The first byte, and the first one that does not belong to it."""


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

    A pattern that matches nothing stays as it is, and is then a log that is missing.
    """
    every = [paths] if isinstance(paths, str | os.PathLike) else paths
    found = [one for path in every for one in _matches(os.fspath(path), options)]
    return list(dict.fromkeys(found))


def _matches(path: str, options: Mapping[str, Any] | None) -> list[str]:
    path = path.removeprefix("file://")
    if not is_url(path):
        pattern = glob.has_magic(path) and not os.path.lexists(path)
        matches = sorted(glob.glob(path, recursive=True)) if pattern else []
        return [os.path.abspath(one) for one in matches or [path]]
    if "::" in path or not glob.has_magic(path):
        return [path]
    fs, inner = file_system(path, options)
    return [fs.unstrip_protocol(one) for one in sorted(fs.glob(inner))] or [path]


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
def localised(
    path: str, byte_range: ByteRange | None = None, options: Mapping[str, Any] | None = None
) -> Iterator[str]:
    """A local file with the bytes of a log, gone afterwards unless it is the log itself.

    OSError and what fsspec raises where it cannot be read, ValueError for a range that is not
    there.
    """
    if byte_range is None and not is_url(path):
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="mavwire-") as folder:
        copy = os.path.join(folder, os.path.basename(path) or "log")  # names tell kinds of logs
        with _opened(path, options) as source, open(copy, "wb") as target:
            _copy(path, source, target, byte_range)
        yield copy


def _opened(path: str, options: Mapping[str, Any] | None) -> Any:
    if is_url(path):
        fs, inner = file_system(path, options)
        return fs.open(inner, "rb")
    if os.path.isdir(path):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    return open(path, "rb")


def _copy(path: str, source: Any, target: Any, byte_range: ByteRange | None) -> None:
    start, end = byte_range or (0, None)
    if start:
        source.seek(start)
    left = None if end is None else end - start
    while left is None or left > 0:
        piece = source.read(CHUNK if left is None else min(CHUNK, left))
        if not piece:
            break
        target.write(piece)
        left = None if left is None else left - len(piece)
    if left:
        raise ValueError(f"{path} ends {left} bytes before the range {start} to {end} does")
