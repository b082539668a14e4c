"""The tables of a lake, in the format of Delta Lake: what `deltalake` is asked to do."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from typing import Any

from mavwire._extras import extra

from .doing import Written

APP = "mavwire"
"""The application whose transactions are the batches of a lake."""
PARTITION_TYPES = {"day": "date", "month": "date", "year": "integer", "vehicle": "short"}
NULL = "__HIVE_DEFAULT_PARTITION__"

Column = dict[str, Any]
"""A field of a schema as Delta Lake writes it."""


def check_installed() -> None:
    """ImportError without `deltalake`: a run says so before it reads any log."""
    with extra("lake"):
        import deltalake  # noqa: F401


def opened(folder: str) -> Any:
    """Open the table in a folder; None for a folder without one."""
    from deltalake import DeltaTable

    is_there = os.path.isdir(os.path.join(folder, "_delta_log"))  # which costs less to know
    return DeltaTable(folder) if is_there and DeltaTable.is_deltatable(folder) else None


def columns_of(written: Written) -> list[Column]:
    """The columns of a file, and its partition."""
    told = written.metadata
    columns = [_column(name, kind, told.get(name, {})) for name, kind in written.columns]
    return columns + [_column(name, PARTITION_TYPES[name], {}) for name in written.partition]


def _column(name: str, kind: str, metadata: dict[str, str]) -> Column:
    element = kind.removeprefix("array<").removesuffix(">")
    array = {"type": "array", "elementType": element, "containsNull": True}
    told = {"name": name, "nullable": True, "metadata": metadata}
    return {**told, "type": kind if element == kind else array}


def schema_of(table: Any) -> dict[str, Column]:
    """The columns of a table by name."""
    fields = json.loads(table.schema().to_json())["fields"]
    return {one["name"]: one for one in fields}


def add_of(written: Written) -> dict[str, Any]:
    """How a commit names a new file."""
    shown = {name: _shown(name, pair) for name, pair, _ in written.ranges if pair is not None}
    stats = {
        "numRecords": written.rows,
        "minValues": {name: least for name, (least, _) in shown.items()},
        "maxValues": {name: largest for name, (_, largest) in shown.items()},
        "nullCount": {name: nulls for name, _, nulls in written.ranges},
    }
    folders = [f"{name}={NULL if one is None else one}" for name, one in written.partition.items()]
    return {
        "path": "/".join([*folders, written.name]),
        "size": written.size,
        "partition_values": written.partition,
        "modification_time": int(time.time() * 1000),
        "stats": json.dumps(stats),
    }


def _shown(name: str, pair: tuple[Any, Any]) -> tuple[Any, Any]:
    """A range as statistics have it: times in milliseconds, which must not cut off the largest."""
    if name != "timestamp":
        return pair
    least, largest = pair
    epoch = datetime(1970, 1, 1, tzinfo=UTC)
    try:
        ends = [epoch + timedelta(milliseconds=ms) for ms in (least // 1000, -(-largest // 1000))]
    except OverflowError:  # beyond the year 9999
        ends = [datetime.min.replace(tzinfo=UTC), datetime.max.replace(tzinfo=UTC)]
    first, last = (one.isoformat(timespec="milliseconds").replace("+00:00", "Z") for one in ends)
    return first, last


def apply(table: Any, folder: str, batch: int, change: dict[str, Any]) -> int:
    """Commit the change of a table, which is None if it is new, unless it is there already; its version.

    `change` has `columns`, `partition`, `add` and `remove` (adds without statistics), and `data`,
    whether rows come or go.
    """
    from deltalake import CommitProperties, Schema, Transaction
    from deltalake.transaction import AddAction, RemoveAction, create_table_with_add_actions

    if table is not None and (table.transaction_version(APP) or 0) >= batch:
        return int(table.version())
    properties = CommitProperties(app_transactions=[Transaction(APP, batch)])
    actions: list[Any] = [AddAction(**one, data_change=change["data"]) for one in change["add"]]
    partition = change["partition"]
    if table is None:
        schema = Schema.from_json(json.dumps({"type": "struct", "fields": change["columns"]}))
        create_table_with_add_actions(
            folder, schema, actions, mode="error", partition_by=partition,
            name=os.path.basename(folder), commit_properties=properties,
        )  # fmt: skip
        return 0
    table = _with_columns(table, folder, change["columns"])
    now = int(time.time() * 1000)
    actions += [
        RemoveAction(one["path"], change["data"], now, one["size"], one["partition_values"])
        for one in change["remove"]
    ]
    table.create_write_transaction(
        actions, "append", table.schema(), partition, commit_properties=properties
    )
    table.update_incremental()
    return int(table.version())


def _with_columns(table: Any, folder: str, columns: Iterable[Column]) -> Any:
    """The table with columns that it lacks. Of a commit that is done again they are there already."""
    from deltalake import Field

    known = schema_of(table)
    new = [Field.from_json(json.dumps(one)) for one in columns if one["name"] not in known]
    if not new:
        return table
    table.alter.add_columns(new)
    return opened(folder)


def files_of(table: Any) -> list[dict[str, Any]]:
    """The files of a table as commits name them, with the least and largest `log` and `timestamp`."""
    partition = table.metadata().partition_columns
    found = table.get_add_actions(flatten=True)
    told = {name: found[name].to_pylist() for name in found.schema.names}
    rows = [dict(zip(told, values, strict=True)) for values in zip(*told.values(), strict=True)]
    return [
        {
            "path": row["path"],
            "size": row["size_bytes"],
            "partition_values": {one: _text(row[f"partition.{one}"]) for one in partition},
            "logs": (row.get("min.log"), row.get("max.log")),
            "time": row.get("min.timestamp"),
        }
        for row in rows
    ]


def _text(value: Any) -> str | None:
    return None if value is None else str(value)
