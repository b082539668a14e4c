"""Tasks of workers: convert some logs, or parts of logs, and give their files their names.

A task may be done twice: a worker that dies takes what it did with it, one that was only thought
dead goes on. Each attempt writes files in a folder of its own, and only whole files get names,
which are the same in each attempt.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from mavwire._text import in_words
from mavwire.logs.conversion import Job
from mavwire.logs.manifest import Converted
from mavwire.logs.reading import native_dialect
from mavwire.logs.selection import Selection

from .places import ByteRange, Part, located
from .stores import store_of


@dataclass(frozen=True)
class Piece:
    """A log, or a part of one."""

    path: str
    name: str
    """The name of its files without suffix."""
    byte_range: ByteRange | Part | None = None


@dataclass(frozen=True)
class Recipe:
    """How logs are converted, and where to."""

    out: str
    staging: str | None
    """A folder on the disk of `out` for files that are not complete; None for a place of fsspec."""
    selection: Selection
    dialect: str | os.PathLike[str]
    format: str
    compression: str
    storage_options: dict[str, Any] | None = None


def convert_pieces(pieces: list[Piece], recipe: Recipe) -> list[Converted]:
    """A row for each piece; size and time of the log are left to the client."""
    return [_convert(piece, recipe) for piece in pieces]


def _convert(piece: Piece, recipe: Recipe) -> Converted:
    try:
        place = located(piece.path, piece.byte_range, recipe.storage_options)
        with place as source, _workspace(recipe) as folder:
            native = native_dialect(recipe.dialect)[1]
            # On the disk of `out`, a file that cannot be written could not be at its place either.
            named = None if recipe.staging is None else recipe.out
            job = Job(
                folder, native, recipe.selection, recipe.format, recipe.compression, None, named
            )
            row = job.run(piece.path, piece.name, source)
            publish(folder, row, recipe)
            return row
    except Exception as error:  # file systems of fsspec raise errors of any type
        return Converted(piece.path, piece.name, error=in_words(error, piece.path))


def publish(folder: str, made: Converted, recipe: Recipe) -> None:
    """Give the files in a folder their names in `out`. Where one cannot have its own, those that
    have are `stale`: the client removes them, as it alone knows whether another attempt was whole.
    """
    store = store_of(recipe.out, recipe.storage_options)
    names = {name.replace(os.sep, "/"): rows for name, rows in made.files.items()}
    try:
        for name in names:
            store.publish(os.path.join(folder, *name.split("/")), name)
            made.stale.append(name)
    except Exception as error:  # file systems of fsspec raise errors of any type
        made.files, made.rows, made.error = {}, 0, in_words(error)
    else:
        made.files, made.stale = names, []


@contextmanager
def _workspace(recipe: Recipe) -> Iterator[str]:
    with tempfile.TemporaryDirectory(
        prefix="task-", dir=recipe.staging, ignore_cleanup_errors=True
    ) as folder:
        yield folder
