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
    reads the logs from their beginning. Its columns are those of the dialect, or of the first
    dataflash log that describes the type; what does not fit them in another log is null.
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

        schema = schema_of(self._empty())
        batches = (one for table in self._begin() for one in fitted(table, schema).to_batches())
        reader = pa.RecordBatchReader.from_batches(schema, batches)
        return reader.__arrow_c_stream__(requested_schema)


def schema_of(empty: Any) -> Any:
    """The pyarrow schema of several logs, of a table of the first. Values of dataflash logs may not
    fit it, so any column of theirs may lack some.
    """
    with extra("data"):
        import pyarrow as pa

    schema = pa.schema(empty)
    if b"msgid" in (schema.metadata or {}):  # a message of telemetry is the same in all logs
        return schema
    return pa.schema([one.with_nullable(True) for one in schema], metadata=schema.metadata)


def fitted(table: Table, schema: Any) -> Any:
    """A pyarrow table with the columns of a schema: dataflash logs may describe a type otherwise.
    What does not fit a column there is null.
    """
    with extra("data"):
        import pyarrow as pa

    found = pa.table(table)
    if found.schema.equals(schema, check_metadata=True):
        return found
    columns = [
        _fitted_column(found[field.name], field.type)
        if field.name in found.column_names
        else pa.nulls(len(found), field.type)
        for field in schema
    ]
    return pa.table(columns, schema=schema)


def _fitted_column(column: Any, kind: Any) -> Any:
    """Values as those of another type, null where they would be others: no number is cut off."""
    with extra("data"):
        import pyarrow as pa
        import pyarrow.compute as pc

    own = column.type
    if own == kind:
        return column
    if pa.types.is_integer(kind) and (pa.types.is_integer(own) or pa.types.is_floating(own)):
        least, most = _bounds(kind)
        if pa.types.is_integer(own):
            low, high = _bounds(own)
            first, last = pa.scalar(max(least, low), own), pa.scalar(min(most, high), own)
            fits = pc.and_(pc.greater_equal(column, first), pc.less_equal(column, last))
        else:
            column = column.cast(pa.float64())
            fits = pc.and_(pc.greater_equal(column, float(least)), pc.less(column, float(most + 1)))
            fits = pc.and_(fits, pc.equal(column, pc.trunc(column)))
        return pc.if_else(fits, column, pa.scalar(None, column.type)).cast(kind)
    if pa.types.is_floating(kind) and (pa.types.is_integer(own) or pa.types.is_floating(own)):
        return column.cast(kind, safe=False)  # the closest that there is
    return pa.nulls(len(column), kind)


def _bounds(kind: Any) -> tuple[int, int]:
    """The smallest and the largest integer of a type."""
    with extra("data"):
        import pyarrow as pa

    if pa.types.is_unsigned_integer(kind):
        return 0, 2**kind.bit_width - 1
    return -(2 ** (kind.bit_width - 1)), 2 ** (kind.bit_width - 1) - 1
