"""Files of a lake made of other files: without some logs, joined, or with other columns. Needs pyarrow."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from typing import Any

from mavwire._extras import extra
from mavwire._native import LakeFile, RecordBatches

from . import delta
from .doing import FILE_BYTES, GROUP_ROWS, Written, finished

NUMBERS = ("byte", "short", "integer", "long", "float", "double")


class Reader:
    """The rows of some files, in order, with the columns of all of them."""

    def __init__(
        self,
        paths: list[str],
        without: set[str] = frozenset(),  # type: ignore[assignment]
        names: dict[str, tuple[str, bool]] | None = None,
    ) -> None:
        with extra("lake"):
            import pyarrow as pa
            import pyarrow.parquet as pq

        self._pa = pa
        self._paths = paths
        self._without = without
        self._names = names or {}
        """The name of each column here, and whether it becomes floats."""
        self.schema = pa.unify_schemas([pq.read_schema(path) for path in paths])

    def has_removed(self) -> bool:
        """Whether there are rows of the logs that are left out."""
        import pyarrow.parquet as pq

        logs = (pq.read_table(path, columns=["log"])["log"].unique() for path in self._paths)
        return any(not self._without.isdisjoint(some.to_pylist()) for some in logs)

    def __iter__(self) -> Iterator[Any]:
        """Tables of about a row group each."""
        waiting: list[Any] = []
        for table in self._tables():
            waiting.append(table)
            if sum(map(len, waiting)) >= GROUP_ROWS:
                yield self._pa.concat_tables(waiting)
                waiting = []
        if waiting:
            yield self._pa.concat_tables(waiting)

    def _tables(self) -> Iterator[Any]:
        import pyarrow.compute as pc
        import pyarrow.parquet as pq

        for path in self._paths:
            with pq.ParquetFile(path) as file:
                for batch in file.iter_batches(GROUP_ROWS):
                    table = self._pa.table(batch)
                    if self._without:
                        out = pc.is_in(table["log"], self._pa.array(sorted(self._without)))
                        table = table.filter(pc.invert(out))
                    if len(table):
                        yield self._fitted(table)

    def _fitted(self, table: Any) -> Any:
        columns = {}
        for field in self.schema:
            name, is_float = self._names.get(field.name, (field.name, False))
            if field.name not in table.column_names:
                values = self._pa.nulls(len(table), field.type)
            else:
                values = table[field.name]
            columns[name] = values.cast(self._pa.float64()) if is_float else values
        return self._pa.table(columns)


def rewritten(
    reader: Reader, folder: str, table: str, partition: dict[str, str | None]
) -> list[Written]:
    """The rows as new files."""
    done: list[Written] = []
    file: LakeFile | None = None
    name = ""

    for rows in reader:
        if file is None:
            name = f"{secrets.token_hex(8)}.parquet"
            file = LakeFile(os.path.join(folder, name))
        if file.write([(RecordBatches.from_stream(rows), None)]) >= FILE_BYTES:
            done.append(finished(file, folder, name, table, partition, {}))
            file = None
    if file is not None:
        done.append(finished(file, folder, name, table, partition, {}))
    return done


def kinds_differ(written: Written, known: dict[str, Any]) -> bool:
    """Whether a column of a file has another type than that of its name in the table."""
    return any(_differs(one, known) for one in delta.columns_of(written))


def _differs(column: dict[str, Any], known: dict[str, Any]) -> bool:
    other = known.get(column["name"])
    return other is not None and other["type"] != column["type"]


def fitted(folder: str, written: Written, known: dict[str, Any]) -> Written:
    """A file with columns that fit those of the table: a number becomes a float where the table has
    floats; any other column whose type differs gets an underscore.
    """
    names: dict[str, tuple[str, bool]] = {}
    for column in delta.columns_of(written):
        name = column["name"]
        if not _differs(column, known):
            continue
        if column["type"] in NUMBERS and known[name]["type"] == "double":
            names[name] = (name, True)
            continue
        while _differs({**column, "name": name}, known):
            name += "_"
        names[column["name"]] = (name, False)
    place = os.path.join(folder, written.name)
    reader = Reader([place], names=names)
    (made,) = rewritten(reader, folder, written.table, written.partition)
    made.metadata = {names.get(one, (one,))[0]: told for one, told in written.metadata.items()}
    os.remove(place)
    return made
