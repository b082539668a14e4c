"""`compact`: small files of a lake become large ones."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from functools import partial
from typing import Any

from mavwire.fleet.grouping import grouped

from . import delta
from .committing import Lake, Replacement
from .doing import FILE_BYTES
from .rewriting import Reader, rewritten

SMALL_BYTES = 64 << 20
"""Bytes of a file below which it is merged with others."""


def compact(lake: str | os.PathLike[str], *, retention_hours: int | None = None) -> dict[str, int]:
    """Merge the files of each partition that are smaller than 64 MB, sorted by time, into some of up to
    256 MB: `{message: files that were merged}`.

    Files that were replaced stay for readers of earlier versions, and go after `retention_hours` (a week
    if None). A run that is killed leaves each table as it was before or as it is afterwards. ValueError
    for a folder that is no lake.
    """
    root = os.fsdecode(lake)
    opened = Lake(root, None)
    merged: dict[str, int] = {}
    if not opened.ledger().batch:
        raise ValueError(f"{root} is no lake: make one with mavwire ingest")
    for name in opened.ledger().tables:
        with opened.staging() as folder:
            work = tempfile.mkdtemp(dir=folder)
            done = opened.replace(work, name, partial(_merged, root, name, work))
        if done:
            merged[name] = done
        with opened.locked():  # vacuum would remove files that another run has not committed yet
            table = delta.opened(os.path.join(root, name))
            table.create_checkpoint()
            week = retention_hours is None
            table.vacuum(retention_hours, dry_run=False, enforce_retention_duration=week)
    return merged


def _merged(root: str, name: str, work: str, table: Any) -> Iterator[Replacement]:
    """Files of a table, and those that take their place."""
    partitions: dict[str, list[dict[str, Any]]] = {}
    for file in delta.files_of(table):
        if file["size"] < SMALL_BYTES:
            partitions.setdefault(str(file["partition_values"]), []).append(file)
    for files in partitions.values():
        files.sort(key=lambda file: (file["time"] is None, file["time"], file["path"]))
        for group in grouped([(file, file["size"]) for file in files], FILE_BYTES):
            if len(group) > 1:
                reader = Reader([os.path.join(root, name, file["path"]) for file in group])
                yield group, rewritten(reader, work, name, group[0]["partition_values"])
