"""`scan_polars`: a message type of many logs as a polars LazyFrame.

polars says which columns it needs and which rows, and only those columns are gathered; bounds on
`timestamp` and a `sysid` that stand in a filter limit what is decoded.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mavwire._native import DataflashTables

from .extras import extra
from .pushdown import narrow
from .query import Query
from .reading import BATCH_ROWS, batches_of, check_readable, empty_of, native_dialect, paths_of
from .table import Table

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Iterator
    from datetime import datetime
    from types import ModuleType


def scan_polars(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    message: str,
    *,
    systems: int | Iterable[int] | None = None,
    start: float | datetime | None = None,
    end: float | datetime | None = None,
    units: str | None = None,
    enums: str | None = None,
    dialect: str | ModuleType = "all",
) -> Any:
    """The messages of one type of one or many logs as a `polars.LazyFrame`.

    Needs polars. Columns are those of the dialect, or of the first dataflash log that describes the
    type. The arguments are those of `mavwire.scan`. Nothing is read before the frame is
    collected; a text column is always followed by `<name>_raw`.
    """
    with extra("data"):
        import polars as pl
        from polars.io.plugins import register_io_source

    if not isinstance(message, str):
        raise ValueError(f"a scan is of one message type, not of {message!r}")
    every = paths_of(paths)
    module, native = native_dialect(dialect)
    query = Query.of(module, message, systems, None, start, end, units, enums)
    empty = empty_of(every, module, native, query)
    schema = pl.DataFrame(Table(message, empty)).schema

    def source(
        with_columns: list[str] | None,
        predicate: Any,
        n_rows: int | None,
        batch_size: int | None,
    ) -> Iterator[Any]:
        wanted = Query(**vars(query))
        # polars filters what it gets here, so the filter's columns are needed too.
        needed = set(with_columns or schema)
        if predicate is not None:
            needed.update(predicate.meta.root_names())
            narrow(wanted, predicate)
            # Of rows without times the filter keeps what it keeps.
            wanted.untimed = query.start is None and query.end is None
        wanted.columns = [name for name in schema if name in needed]
        wanted.batch_rows = batch_size or BATCH_ROWS
        left = n_rows
        for table in _tables(every, native, wanted, query):
            frame = _fitted(pl.DataFrame(table), {one: schema[one] for one in wanted.columns})
            if predicate is not None:
                frame = frame.filter(predicate)
            if with_columns is not None:
                frame = frame.select(with_columns)
            if left is not None:
                frame = frame.head(left)
                left -= len(frame)
            yield frame
            if left is not None and left <= 0:
                return

    return register_io_source(source, schema=schema, is_pure=True)


def _tables(paths: list[str], native: Any, wanted: Query, query: Query) -> Iterator[Table]:
    """Batches of all logs. What was `wanted` of systems beyond `query` is about telemetry alone."""
    for path in paths:
        check_readable(path)
        dataflash = DataflashTables.open(path)
        those = wanted if dataflash is None else replace(wanted, systems=query.systems)
        yield from batches_of(dataflash, path, native, those)


def _fitted(frame: Any, schema: dict[str, Any]) -> Any:
    """A frame with the columns of the scan: another dataflash log may describe a type otherwise."""
    with extra("data"):
        import polars as pl

    found = frame.schema
    if dict(found) == schema:
        return frame
    fit = {
        name: pl.col(name).cast(kind, strict=False) if name in found else pl.lit(None, kind)
        for name, kind in schema.items()
    }
    return frame.select(**fit)
