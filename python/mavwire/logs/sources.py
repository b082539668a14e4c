"""Runs over logs of any kind: telemetry logs, raw streams, dataflash logs."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from mavwire._native import (
    DataflashTables,
    LogColumns,
    LogKind,
    RecordBatches,
    decompress,
    identify,
)
from mavwire._text import naming

from .format_error import COMPRESSED, no_record, not_telemetry, undescribed
from .selection import Selection

Opened = tuple[DataflashTables, list[tuple[str, RecordBatches]] | None]
"""The survey of a dataflash log, and its tables if the same pass found them."""

Source = str | tuple[str, int, int] | tuple[str, int, int, bool] | bytes
"""Sources of the native readers: a path, a path with the first byte and the end of a range, the same
with whether its records have time stamps, or the bytes of a log.
"""


def is_dataflash(source: Source) -> bool:
    """Whether a log begins as a dataflash log does, binary or text; false for one that cannot be
    read.
    """
    try:
        return identify(source, unpack=True).is_dataflash
    except OSError:
        return False


def open_dataflash(source: Source, path: str) -> DataflashTables | None:
    """The survey of a dataflash log; None for another kind of log. LogFormatError for one that lacks its
    first part, so that nothing describes its records.
    """
    opened = read_dataflash(source, path)
    return None if opened is None else opened[0]


def read_dataflash(source: Source, path: str, query: Selection | None = None) -> Opened | None:
    """The same with the whole tables that `query` asks for, where one pass gives both."""
    opened = DataflashTables.read(source, query)
    if (
        opened is not None
        and not describes(opened[0])
        and identify(source, unpack=True) is LogKind.HEADERLESS
    ):
        raise undescribed(path)
    return opened


def describes(tables: DataflashTables) -> bool:
    """Whether a dataflash log says what any of its records are, beyond those that say so."""
    return not set(tables.names) <= {"FMT"}


def columns_from(
    tables: DataflashTables | None, source: Source, native: Any, query: Selection
) -> LogColumns:
    """A run over a dataflash log, or where that is None over the telemetry log `source`; ValueError
    for what makes no sense with its kind.
    """
    if tables is None:
        query.check_telemetry()
        return LogColumns(source, native, query)
    query.check_dataflash()
    return tables.columns(query)


def file_status(path: str) -> tuple[int, int]:
    """Bytes of a file, and when it was changed in nanoseconds since 1970."""
    status = os.stat(path)
    return status.st_size, status.st_mtime_ns


def is_compressed(path: str) -> bool:
    """Whether a file is compressed with gzip or zstd."""
    with naming(path):
        return identify(path) in COMPRESSED


@contextmanager
def decompressed(path: str, warn: Callable[[str], object] = lambda damage: None) -> Iterator[str]:
    """A file with the bytes of a log, for readers that go to and fro in it: the log itself, or for
    the time being a file of what is in a compressed one, as far as that is whole. `warn` is told
    what is wrong with it; LogFormatError where nothing of it is whole.
    """
    if not is_compressed(path):
        yield path
        return
    import tempfile  # which costs as much as all else here

    name = os.path.basename(path)
    for suffix in (".gz", ".zst"):
        name = name.removesuffix(suffix)
    # Windows removes no file that is still open, as by a log that was dropped without being closed.
    with tempfile.TemporaryDirectory(prefix="mavwire-", ignore_cleanup_errors=True) as folder:
        copy = os.path.join(folder, name or "log")  # names tell kinds of logs
        damage = decompress(path, copy)
        if damage is not None:
            if not os.path.getsize(copy):
                raise not_telemetry(path, identify(path), damage)
            warn(damage)
        yield copy


def check_run(source: Source, path: str, position: int, bad_bytes: int, damage: str | None) -> None:
    """Raise LogFormatError where a run over a file found no record, and it is no log that is empty or
    cut off in its first.
    """
    if bad_bytes == position and (position or damage):
        check_has_records(source, path, damage)


def check_has_records(source: Source, path: str, damage: str | None) -> None:
    """Raise LogFormatError for a file in which no record was found, unless it is a log that is cut
    off in its first one, compressed or not; `damage` is what is wrong with a compressed file.
    """
    kind = identify(source, unpack=True)
    if kind.is_dataflash:
        raise no_record("dataflash", path)
    if damage or kind is not LogKind.CUT:
        raise not_telemetry(path, identify(source) if damage else kind, damage)
