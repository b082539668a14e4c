"""`Batches`: what `scan` gives, tables one after the other, and of one type an Arrow stream."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Self

    from mavwire._native import RecordBatches

    from .table import Table


class Batches:
    """An iterator of tables, which gives each once.

    Where one type is scanned it is an Arrow stream too, which DuckDB, polars and
    `pyarrow.RecordBatchReader.from_stream` read in bounded memory. Each stream reads the logs from
    their beginning. Its columns are those of the dialect, or of all dataflash logs with the
    type. A column is null for a log that does not have it.
    """

    def __init__(
        self, begin: Callable[[], Iterator[Table]], empty: Callable[[], RecordBatches] | None
    ) -> None:
        self._begin = begin
        self._tables = begin()
        self._empty = empty
        """Makes a table of the type without rows; None where there is not one type."""

    def __iter__(self) -> Self:
        return self

    def __next__(self) -> Table:
        return next(self._tables)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        if self._empty is None:
            raise TypeError("a scan of one type is an Arrow stream: name one type")
        return self._empty().stream(one._batches for one in self._begin())
