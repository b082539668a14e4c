"""`dask_frame`: a message type of many logs as a Dask data frame."""

from __future__ import annotations

import os
from functools import partial
from typing import TYPE_CHECKING, Any, Unpack

from mavwire._extras import extra
from mavwire.dialects import UPSTREAM
from mavwire.logs.common_columns import common_columns, description_of
from mavwire.logs.query import Values, takes
from mavwire.logs.selection import id_of, names_of
from mavwire.logs.sources import open_dataflash
from mavwire.logs.table import Table

from .cuts import find_cuts
from .decoding import decoded, selection_of
from .grouping import TASK_BYTES, check_at_least_1, grouped, may_be_cut
from .places import Part, begins_as_dataflash, expand, located, status

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavwire.logs.common_columns import Described

DATAFLASH_NAME_LEN = 4
"""Length of a type's name in a FMT record."""
Source = tuple[str, Part | None]


@takes(Values)
def dask_frame(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    type: str,
    columns: str | Iterable[str] | None = None,
    *,
    dialect: str | os.PathLike[str] = UPSTREAM,
    task_bytes: int = TASK_BYTES,
    storage_options: Mapping[str, Any] | None = None,
    **query: Unpack[Values],
) -> Any:
    """The messages of one type of many logs as a `dask.dataframe.DataFrame`, in the order of the logs.

    Needs dask, pandas and pyarrow. A partition is some `task_bytes` of logs: several small ones, or
    a part of a large one. `columns` are the names of those that are wanted; the other arguments are
    those of `mavwire.read`. Integers of dataflash logs are pandas' nullable ones: another log may
    lack them. Only large logs and dataflash logs are read before the frame is computed. A log that is
    missing raises OSError here.
    """
    with extra("fleet"):
        import dask
        import dask.dataframe as dd

    if not isinstance(type, str):
        raise ValueError(f"type is the name of one message type, not {type!r}")
    check_at_least_1(task_bytes=task_bytes)
    wanted = None if columns is None else names_of(columns)
    how = {
        "types": type,
        "columns": wanted,
        "dialect": dialect,
        "storage_options": storage_options,
        **query,
    }
    sizes = {path: status(path, storage_options)[0] for path in expand(paths, storage_options)}
    large = [path for path, size in sizes.items() if may_be_cut(path, size, task_bytes)]
    found = dask.compute(*[dask.delayed(find_cuts)(path, task_bytes, dialect) for path in large])
    parts = dict(zip(large, found, strict=True))
    sources: list[tuple[Source, int]] = []
    for path, size in sizes.items():
        ranges = parts.get(path)
        if ranges:
            sources += [((path, one), one[1] - one[0]) for one in ranges]
        else:
            sources.append(((path, None), size))
    described = dask.compute(*[dask.delayed(_described)(path, how) for path in sizes])
    empty, nullable = _empty(dict(zip(sizes, described, strict=True)), how)
    load = partial(_load, how=how, empty=empty, nullable=nullable)
    meta = _frame(empty, nullable)
    with dask.config.set({"dataframe.convert-string": False}):  # lists are no texts
        return dd.from_map(load, grouped(sources, task_bytes) or [[]], meta=meta)


def _described(path: str, how: dict[str, Any]) -> Described | None:
    """The description of the wanted type in a dataflash log; None for a telemetry log.

    Dataflash logs have no types with names over four letters. So no log is read for such a type of the dialect.
    """
    name, options = how["types"], how["storage_options"]
    module, _, selection = selection_of(**how)
    if (
        len(name) > DATAFLASH_NAME_LEN and id_of(module, name) is not None
    ) or not begins_as_dataflash(path, options):
        return None
    with located(path, None, options) as source:
        tables = open_dataflash(source, path)
        return None if tables is None else description_of(tables, selection)


def _empty(described: Mapping[str, Described | None], how: dict[str, Any]) -> tuple[Table, bool]:
    """An empty table, and whether its columns may have nulls. ValueError for a type or column that no
    log has.
    """
    module, native, selection = selection_of(**how)
    empty = common_columns(described.items(), module, native, selection)
    names, wanted = empty.names, how["columns"]
    for name in wanted or ():
        if name not in names:
            raise ValueError(f"no log has a column {name!r} of {how['types']}")
    empty = empty if wanted is None else empty.select(wanted)
    return Table(how["types"], empty), selection.invalid == "null" or any(described.values())


def _load(sources: list[Source], how: dict[str, Any], empty: Table, nullable: bool) -> Any:
    """Some logs, one behind the other, as a pandas data frame with the columns of `empty`."""
    import pandas as pd

    wanted, options = selection_of(**how), how["storage_options"]
    found = [decoded(*source, *wanted, options, lenient=True) for source in sources]
    tables = [tables.get(how["types"]) for tables in found]
    # Another description of a type may have other columns.
    fitted = [
        empty if table is None else Table(table.name, table._batches.fitted(empty._batches))
        for table in tables
    ]
    frames = [_frame(table, nullable) for table in fitted or [empty]]
    if len(frames) == 1:
        return frames[0]
    return pd.concat(frames, ignore_index=True)


def _frame(table: Table, nullable: bool) -> Any:
    """A table as a pandas data frame, whose columns have the same types in each log.

    Each log would have categories of its own: texts instead.
    """
    frame = table.to_pandas(nullable=nullable)
    for column in frame.select_dtypes("category"):
        frame[column] = frame[column].astype(object)
    single = [column for column, kind in table.dtypes.items() if kind == "Float32"]
    return frame.astype(dict.fromkeys(single, "float32"))  # rows without values make it float64
