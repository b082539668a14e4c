"""`scan_polars`: a message type of many logs as a polars LazyFrame.

polars says which columns it needs and which rows, and only those columns are gathered; bounds on
`timestamp` that stand in a filter limit what is decoded.
"""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

from mavwire._native import DataflashTables, RecordBatches, empty_table

from .query import Query
from .reading import BATCH_ROWS, _batches, native_dialect
from .selection import record_seconds
from .sources import is_dataflash
from .table import Table

if TYPE_CHECKING:
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
    import polars as pl
    from polars.io.plugins import register_io_source

    one = isinstance(paths, str | os.PathLike)
    every = [os.fspath(paths)] if one else [os.fspath(path) for path in paths]  # type: ignore[union-attr, arg-type]
    module, native = native_dialect(dialect)
    query = Query.of(module, message, systems, None, start, end, units, enums)
    empty = _empty(every, message, module, native, query)
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
            _narrow(wanted, predicate)
            # Of rows without times the filter keeps what it keeps.
            wanted.untimed = query.start is None and query.end is None
        wanted.columns = [name for name in schema if name in needed]
        wanted.batch_rows = batch_size or BATCH_ROWS
        left = n_rows
        for table in _batches(every, native, wanted):
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


def _empty(paths: list[str], message: str, module: Any, native: Any, query: Query) -> RecordBatches:
    """A table without rows of a type, as the dialect has it or the first of the dataflash logs that
    describes it. ValueError where none does.
    """
    for path in filter(is_dataflash, paths):
        tables = DataflashTables.open(path)
        if tables is not None and message in tables.types():
            query.check_dataflash()
            return tables.empty(message, query)
    query.check_telemetry()
    return empty_table(native, getattr(module, f"MAVLINK_MSG_ID_{message}"), query)


def _fitted(frame: Any, schema: dict[str, Any]) -> Any:
    """A frame with the columns of the scan: another dataflash log may describe a type otherwise."""
    import polars as pl

    found = frame.schema
    if dict(found) == schema:
        return frame
    fit = {
        name: pl.col(name).cast(kind, strict=False) if name in found else pl.lit(None, kind)
        for name, kind in schema.items()
    }
    return frame.select(**fit)


def _narrow(query: Query, predicate: Any) -> None:
    """Take over what a filter says of the time. What is not understood is left to the filter."""
    for operator, seconds in _time_bounds(predicate):
        if operator in ("Gt", "GtEq", "Eq"):
            query.start = seconds if query.start is None else max(query.start, seconds)
        if operator in ("Lt", "LtEq", "Eq"):
            # The end itself does not belong to what is read, and the filter may include it.
            after = seconds + 1e-3
            query.end = after if query.end is None else min(query.end, after)


def _time_bounds(predicate: Any) -> Iterator[tuple[str, float]]:
    """Comparisons of `timestamp` with a literal time that all must hold."""
    import warnings

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = json.loads(predicate.meta.serialize(format="json"))
    except Exception:  # a form that this polars cannot write; the filter holds all the same
        return
    stack = [tree]
    while stack:
        node = stack.pop()
        inner = node.get("BinaryExpr") if isinstance(node, dict) else None
        if not isinstance(inner, dict):
            continue
        operator = inner.get("op")
        if operator in ("And", "LogicalAnd"):
            stack += [inner.get("left"), inner.get("right")]
        elif inner.get("left") == {"Column": "timestamp"}:
            seconds = _seconds(inner.get("right"))
            if seconds is not None:
                yield str(operator), seconds


def _seconds(node: Any) -> float | None:
    """The time of a literal of type datetime."""
    text = json.dumps(node)
    if '"DateTime"' not in text and '"Datetime"' not in text:
        return None
    nanos = {"Nanoseconds": 1, "Microseconds": 1_000, "Milliseconds": 1_000_000}
    numbers = _integers(node)
    units = [factor for name, factor in nanos.items() if name in text]
    if len(numbers) != 1 or len(units) != 1 or '"Cast"' in text:
        return None
    return record_seconds(numbers[0] * units[0] // 1_000)


def _integers(node: Any) -> list[int]:
    if isinstance(node, bool):
        return []
    if isinstance(node, int):
        return [node]
    values = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return [number for value in values for number in _integers(value)]
