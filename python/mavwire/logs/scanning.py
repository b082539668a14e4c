"""`scan_polars`: a message type of many logs as a polars LazyFrame.

polars says which columns it needs, and only those are gathered. `start`, `end` and `systems` limit the
rows that are decoded. Columns that a filter of polars asks for are decoded first, the others for the rows
that it keeps.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Unpack

from mavwire._extras import extra
from mavwire._native import RecordBatches
from mavwire.dialects import UPSTREAM

from .common_columns import Surveys, empty_of
from .dialect import portable, restored
from .query import Values, takes
from .reading import BATCH_ROWS, batches, check_readable, logs_of, native_dialect
from .selection import Selection

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Iterator

    from .dialect import Dialects


@takes(Values)
def scan_polars(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    message: str,
    *,
    dialect: Dialects = UPSTREAM,
    **query: Unpack[Values],
) -> Any:
    """The messages of one type of one or many logs as a `polars.LazyFrame`.

    Needs polars. Columns are those of the dialect, or of all dataflash logs with the type. A column is null for
    a log that does not have it. ValueError if columns of one name have no common type. The arguments are
    those of `mavwire.scan`. The rows are read when the frame is collected. Before that only the
    descriptions of dataflash logs are read. A text column is always followed by `<name>_raw`.
    Raises FileNotFoundError and its kin for a log that cannot be read.
    """
    with extra("data"):
        from polars.io.plugins import register_io_source

    if not isinstance(message, str):
        raise ValueError(f"a scan is of one message type, not of {message!r}")
    logs = logs_of(paths)
    for path in logs:
        check_readable(path)
    source = _Source(logs, message, dialect, query)
    return register_io_source(source, schema=source.schema, is_pure=True)


class _Source:
    """The callback of polars for the rows of a scan. It is pickled by the arguments of the scan."""

    def __init__(
        self,
        paths: list[str],
        message: str,
        dialect: Dialects,
        query: Values,
    ) -> None:
        with extra("data"):
            import polars as pl

        module, self._native = native_dialect(dialect)
        self._selection = Selection.of(module, message, **query)
        self._surveys = Surveys()
        self._empty = empty_of(paths, self._surveys, module, self._native, self._selection)
        self._selection.allow([message])
        self._paths = paths
        self._arguments = message, dialect, query
        self.schema = pl.DataFrame(self._empty).schema

    def __reduce__(self) -> tuple[Any, ...]:
        message, dialect, query = self._arguments
        return _restored, (self._paths, message, portable(dialect), query)

    def __call__(
        self,
        with_columns: list[str] | None,
        predicate: Any,
        n_rows: int | None,
        batch_size: int | None,
    ) -> Iterator[Any]:
        with extra("data"):
            import polars as pl

        wanted = Selection(**vars(self._selection))
        needed = set(with_columns or self.schema)
        if predicate is not None:
            asked = [*dict.fromkeys(predicate.meta.root_names())] or [*self.schema][:1]
            wanted.predicate = asked, partial(_kept, self._empty.select(asked), predicate)
            needed.update(asked)
        wanted.columns = [name for name in self.schema if name in needed]
        wanted.batch_rows = batch_size or BATCH_ROWS
        empty = self._empty.select(wanted.columns)
        left = n_rows
        for table in batches(self._paths, self._surveys, self._native, wanted):
            frame = pl.DataFrame(table._batches.fitted(empty))
            if with_columns is not None:
                frame = frame.select(with_columns)
            if left is not None:
                frame = frame.head(left)
                left -= len(frame)
            yield frame
            if left is not None and left <= 0:
                return


def _kept(empty: RecordBatches, predicate: Any, rows: RecordBatches) -> RecordBatches:
    """The numbers of the rows that a predicate of polars keeps."""
    import polars as pl

    numbers = pl.int_range(pl.len(), dtype=pl.UInt32).filter(predicate)
    return RecordBatches.from_stream(pl.DataFrame(rows.fitted(empty)).select(numbers))


def _restored(paths: list[str], message: str, dialect: tuple[str, bool], query: Values) -> _Source:
    return _Source(paths, message, restored(*dialect), query)
