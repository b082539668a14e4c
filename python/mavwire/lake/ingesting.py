"""`ingest`: plan what is to do, do it, commit it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Unpack

from mavwire.dialects import UPSTREAM
from mavwire.fleet.grouping import check_at_least_1
from mavwire.fleet.places import expand, is_url, statuses
from mavwire.logs.conversion import asked, prepare
from mavwire.logs.manifest import Converted
from mavwire.logs.query import Query, Types, takes
from mavwire.logs.reading import allow_described

from . import delta
from .committing import Lake
from .doing import Made, Recipe
from .planning import PART_BYTES, Plan, Shard, of_shard, plan
from .runners import run_dask, run_here, run_pool


@takes(Query)
def ingest(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    lake: str | os.PathLike[str],
    client: Any = None,
    *,
    partition: Iterable[str] = ("day", "vehicle"),
    workers: int | None = None,
    shard: Shard | None = None,
    types: Types = None,
    dialect: str | os.PathLike[str] = UPSTREAM,
    part_bytes: int = PART_BYTES,
    storage_options: Mapping[str, Any] | None = None,
    progress: Callable[[int, int], object] | None = None,
    **query: Unpack[Query],
) -> list[Converted]:
    """Add logs of any kind to a lake: a Delta Lake table `lake/MESSAGE` for each message type.

    `paths` and `query` are those of `mavwire.fleet.convert`. Rows have two columns more: `log`, the path,
    and `digest`, the SHA-256 of the log. Logs that the lake has with the same size and time are left
    alone. One that changed replaces its rows. `partition` names some of "day", "month" and "year" (of the
    start of a log, in UTC) and "vehicle" (the system id of the sender).

    About `part_bytes` of logs become visible together, in each table in one commit. A run that is killed
    at any moment leaves each log in all tables or in none, or is carried through by the next run;
    `mavwire.lake.tables` has versions in which that is so at all times. `workers` are processes of this
    machine, `client` is a `distributed.Client` or the address of a scheduler, and `shard=(3, 16)` does the
    logs of the third of 16 jobs, which may run at the same time.

    Returns a row for each log, in the order given. `progress` is told how many logs are done, of how
    many. ValueError for an argument that makes no sense, and for a lake that was made with other options;
    a log that cannot be read is a row with an `error`.
    """
    root = os.fsdecode(lake)
    if is_url(root):
        raise ValueError(f"{root}: a lake is a folder, not a URL")
    check_at_least_1(workers=workers, part_bytes=part_bytes)
    columns = _partition(partition)
    logs = of_shard(expand(paths, storage_options), shard)
    selection = prepare("parquet", None, types, dialect, logs=logs, **query)[2]
    allow_described(logs, selection)
    options = json.loads(json.dumps({**asked(selection), "partition": columns}))
    store = Lake(root, options)
    found = statuses(logs, storage_options)
    todo = plan(found, store.ledger(), workers or 1, part_bytes)
    rows = dict(todo.rows)
    with store.staging() as folder:
        recipe = Recipe(folder, selection, dialect, columns, dict(storage_options or {}))
        for made in _run(todo, recipe, workers, client):
            store.add(made)
            rows |= {row.path: row for row in made.rows}
            if progress is not None:
                progress(len(rows), len(found))
    return [rows[path] for path in found]


def _run(todo: Plan, recipe: Recipe, workers: int | None, client: Any) -> Iterator[Made]:
    if not todo.parts:
        return iter(())
    if client is not None:
        return run_dask(todo.parts, recipe, client)
    if workers is not None and workers > 1:
        return run_pool(todo.parts, recipe, workers)
    return run_here(todo.parts, recipe)


def _partition(names: Iterable[str]) -> tuple[str, ...]:
    columns = tuple(dict.fromkeys([names] if isinstance(names, str) else names))
    for name in columns:
        if name not in delta.PARTITION_TYPES:
            choices = ", ".join(delta.PARTITION_TYPES)
            raise ValueError(f"a partition is one of {choices}, not {name!r}")
    return columns
