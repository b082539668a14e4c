"""`Batches`: what `scan` gives, tables one after the other, and of one type an Arrow stream."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .extras import extra

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Self

    from mavwire._native import RecordBatches

    from .table import Table


class Batches:
    """An iterator of tables, which gives each once.

    Where one type is scanned it is an Arrow stream too, which DuckDB, polars and
    `pyarrow.RecordBatchReader.from_stream` read in bounded memory; that needs pyarrow. Each stream
    reads the logs from their beginning.
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
        with extra("data"):
            import pyarrow as pa

        schema = pa.schema(self._empty())
        batches = (one for table in self._begin() for one in _fitted(table, schema).to_batches())
        reader = pa.RecordBatchReader.from_batches(schema, batches)
        return reader.__arrow_c_stream__(requested_schema)


def _fitted(table: Table, schema: Any) -> Any:
    """A pyarrow table with the columns of the stream: dataflash logs may describe a type otherwise."""
    with extra("data"):
        import pyarrow as pa

    found = pa.table(table)
    if found.schema.equals(schema, check_metadata=True):
        return found
    columns = [
        found[field.name].cast(field.type, safe=False)
        if field.name in found.column_names
        else pa.nulls(len(found), field.type)
        for field in schema
    ]
    return pa.table(columns, schema=schema)
