"""`Table`: the messages of one type as columns.

A table speaks the Arrow PyCapsule protocol, so pyarrow, polars, pandas and DuckDB take it without a
copy, and mavwire needs none of them.
"""

from __future__ import annotations

import builtins
import os
from collections.abc import Iterable, Iterator
from typing import Any, overload

from mavwire._extras import extra
from mavwire._native import RecordBatches, write_table

from .arrow_types import conformed, foreign
from .common_clock import Span
from .formats import COMPRESSIONS, FORMATS, TABLE_FORMATS, TEXT_SUFFIXES, TEXTS
from .targets import file_to_write

INTEGERS = frozenset(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64))


class Table:
    """Rows of one message type, in the order of the log.

    The columns are `timestamp` (microseconds, UTC), `sysid`, `compid`, `seq`, then the fields in
    XML order with their own widths; arrays are lists of fixed size, `char[n]` is text.
    """

    def __init__(self, name: str, batches: RecordBatches, path: str | None = None) -> None:
        self.name = name
        """The message type."""
        self.path = path
        """The log it came from."""
        self._batches = batches

    @classmethod
    def from_arrow(cls, table: Any, name: str) -> Table:
        """A table of anything that has `__arrow_c_stream__` (of pyarrow, polars, DuckDB), over the
        same memory, for `write`, `align` and the rest; `name` is its message type.

        Columns of kinds that tables of logs have not are copied, which needs pyarrow: times become
        microseconds, texts and categories those of this package. Columns of others (booleans,
        dates, lists of any length) can be written and are no arrays. ValueError for a time beyond what
        microseconds hold, and for lists of a fixed size in which values are missing; TypeError for
        what is no table.
        """
        if not hasattr(table, "__arrow_c_stream__"):
            raise TypeError(f"a table of Arrow is wanted, not {type(table).__name__}")
        batches = RecordBatches.from_stream(table)
        if any(map(foreign, batches.types().values())):
            batches = RecordBatches.from_stream(conformed(batches))
        return cls(name, batches)

    # -- shape

    def __len__(self) -> int:
        return self._batches.num_rows

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return self._batches.names

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self), len(self.columns)

    @property
    def nbytes(self) -> int:
        """Bytes of the values."""
        return self._batches.nbytes

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """`{column: {...}}`: `field` (name in the definition), and where the definition has them
        `unit`, `enum`, `bitmask`, `multiplier` and `invalid`."""
        return self._batches.metadata()

    @property
    def dtypes(self) -> dict[str, str]:
        """`{column: Arrow's name of its type}`."""
        return self._batches.types()

    def __repr__(self) -> str:
        return f"<Table {self.name}: {len(self):,} rows, {len(self.columns)} columns>"

    # -- parts

    @overload
    def __getitem__(self, what: builtins.slice[Any, Any, Any]) -> Table: ...

    @overload
    def __getitem__(self, what: list[str]) -> Table: ...

    @overload
    def __getitem__(self, what: str) -> Any: ...

    def __getitem__(self, what: str | list[str] | builtins.slice[Any, Any, Any]) -> Any:
        """A column as a NumPy array, KeyError if there is none of that name; the rows of a slice, or
        the columns of a list, as a table.

        Numbers are views of the table's memory and read-only; lists have a second dimension; times
        are datetime64[us]; texts are an array of objects.
        """
        with extra("data"):
            import numpy as np

        if isinstance(what, slice):
            start, stop, step = what.indices(len(self))
            if step != 1:
                raise ValueError("rows of a table are sliced in steps of 1: use to_numpy()")
            return self.slice(start, max(0, stop - start))
        if isinstance(what, list):
            return self.select(what)
        if not isinstance(what, str):
            remedy = "a column by its name, columns by a list of names, or rows by a slice"
            raise TypeError(f"a table gives {remedy}, not by {what!r}")
        view = self._batches.column(what)
        if view.dtype is None:
            array = np.empty(len(view), dtype=object)
            array[:] = view.to_list()
        else:
            array = np.frombuffer(memoryview(view), view.dtype)
            if (valid := view.valid()) is not None:
                array = array.astype("float64" if array.dtype.kind in "iu" else array.dtype)
                array[~np.frombuffer(valid, bool)] = "NaT" if array.dtype.kind == "M" else "nan"
        return array if view.elements is None else array.reshape(-1, view.elements)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __contains__(self, column: object) -> bool:
        return column in self.columns

    def select(self, columns: str | Iterable[str]) -> Table:
        """Some of the columns; KeyError if there is none of a name."""
        names = [columns] if isinstance(columns, str) else list(columns)
        return Table(self.name, self._batches.select(names), self.path)

    def slice(self, start: int, rows: int) -> Table:
        """Some of the rows, without a copy; a negative start counts from the end."""
        if rows < 0:
            raise ValueError(f"rows must be at least 0, not {rows}")
        if start < 0:
            start = max(0, start + len(self))
        start, rows = min(start, len(self)), min(rows, len(self))  # as of Python's slices
        return Table(self.name, self._batches.slice(start, rows), self.path)

    def sender(self, sysid: int, compid: int | None = None) -> Table:
        """The rows of one system, or of one of its components. ValueError for a table that does not
        tell who sent its rows.
        """
        rows = self._batches
        for column, wanted in (("sysid", sysid), ("compid", compid)):
            if wanted is not None:
                if column not in rows.names:
                    raise ValueError(
                        f"{self.name} has no column {column!r}: a dataflash log is of one system,"
                        " and in tables of other logs it was left out"
                    )
                rows = dict(rows.split(column)).get(str(wanted), rows.slice(0, 0))
        return Table(self.name, rows, self.path)

    # -- instances

    @property
    def instance_field(self) -> str | None:
        """The column that tells instances apart, such as the number of a battery or an IMU."""
        # Aligned tables have the columns of several, each beside its instance.
        plain = (one for one in self.metadata.items() if one[0] == one[1].get("field"))
        return next((name for name, told in plain if "instance" in told), None)

    def instances(self) -> dict[str, Table]:
        """A table for each instance, `{"IMU[0]": ..., "IMU[1]": ...}`; the table itself by its name
        where it has no instances.
        """
        field = self.instance_field
        if field is None:
            return {self.name: self}
        parts = sorted(self._batches.split(field), key=lambda part: (len(part[0]), part[0]))
        named = ((f"{self.name}[{text}]", part) for text, part in parts)
        return {name: Table(name, part, self.path) for name, part in named}

    def wide(self, *, method: str = "ffill", tolerance: Span = 0) -> Table:
        """One row for each time, with the fields of each instance as `IMU[0].AccX`.

        Where an instance has no row at that time there are nulls; `tolerance` and `method` are
        those of `mavwire.logs.align` and reach further. A table without instances comes as it is.
        ValueError where several systems or components sent the rows: choose one.
        """
        from .common_clock import align_batches

        if self.instance_field is None:
            return self
        check_sender(self, "take rows of one, as table.sender{1}.wide()")
        tables = {name: table._batches for name, table in by_instance(self).items()}
        found = align_batches(tables, self._batches, method=method, tolerance=tolerance)
        return Table(self.name, found, self.path)

    # -- other libraries

    def to_numpy(self) -> dict[str, Any]:
        """`{column: array}`; see `table[column]`."""
        return {column: self[column] for column in self.columns}

    def to_arrow(self) -> Any:
        """A `pyarrow.Table` over the same memory."""
        with extra("data"):
            import pyarrow as pa

        return pa.table(self)

    def to_polars(self) -> Any:
        """A `polars.DataFrame` over the same memory where polars can."""
        with extra("data"):
            import polars as pl

        return pl.DataFrame(self)

    def to_pandas(self, *, copy: bool = True, nullable: bool = False) -> Any:
        """A `pandas.DataFrame`: numbers and times without pyarrow, lists as one array in each row,
        names of enums as a category.

        `copy=False` shows the table's own memory, which is read-only. Integers of which some rows
        have none are float64; `nullable=True` makes pandas' nullable integers of all of them.
        """
        with extra("data"):
            import pandas as pd

        kinds = self.dtypes
        texts = pd.Series([""]).dtype  # where there is no text pandas takes them for objects
        columns: dict[str, Any] = {}
        for column in self.columns:
            if kinds[column].startswith("Dictionary"):
                columns[column] = pd.Categorical(self[column])
            elif nullable and kinds[column] in INTEGERS:
                columns[column] = self._nullable(column)
            else:
                values = self[column]
                if values.ndim > 1:
                    values = pd.Series(list(values), dtype=object)
                elif kinds[column] == "Utf8":
                    values = pd.Series(values, dtype=texts)
                columns[column] = values
        frame = pd.DataFrame(columns, index=pd.RangeIndex(len(self)), copy=copy)
        if "timestamp" in frame:
            frame["timestamp"] = frame["timestamp"].dt.tz_localize("UTC")
        return frame

    def _nullable(self, column: str) -> Any:
        """A column of integers as pandas' nullable ones, which keep all 64 bits."""
        with extra("data"):
            import numpy as np
            import pandas as pd

        view = self._batches.column(column)
        values, valid = np.frombuffer(memoryview(view), view.dtype).copy(), view.valid()
        missing = np.zeros(len(values), bool) if valid is None else ~np.frombuffer(valid, bool)
        return pd.arrays.IntegerArray(values, missing)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        """A structured array with a field for each column."""
        with extra("data"):
            import numpy as np

        columns = self.to_numpy()
        kinds = [(name, one.dtype, one.shape[1:]) for name, one in columns.items()]
        array = np.empty(len(self), dtype=kinds)
        for name, values in columns.items():
            array[name] = values
        return array if dtype is None else array.astype(dtype)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._batches.__arrow_c_stream__(requested_schema)

    def __arrow_c_schema__(self) -> object:
        return self._batches.__arrow_c_schema__()

    def __reduce__(self) -> tuple[Any, ...]:
        return Table, (self.name, self._batches, self.path)

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        format: str | None = None,
        compression: str | None = None,
        csv_safe: bool = True,
    ) -> None:
        """Write a file: Parquet, CSV, JSON lines or Arrow, by the suffix of `path` or `format`.

        It appears when it is complete, in a folder that is there. `compression`: for Parquet "zstd"
        (the default), "snappy" or "none", for text "none", "gzip" or "zstd" (by the suffix, as of
        `gps.csv.gz`, or "none"), for Arrow "none". `csv_safe` puts an apostrophe in front of texts
        in CSV that a spreadsheet would take for formulas.
        """
        path = os.fsdecode(path)
        stem, suffix = os.path.splitext(path)
        packed = next((one for one, end in TEXT_SUFFIXES.items() if end == suffix.lower()), None)
        if packed is not None:
            suffix = os.path.splitext(stem)[1]
        by_suffix = (one for one in TABLE_FORMATS if FORMATS[one] == suffix.lower())
        kind = format or next(by_suffix, None)
        if kind is None or (packed is not None and kind not in TEXTS):
            raise ValueError(f"no format is known by the suffix of {path!r}: give format=")
        compression = compression or packed or COMPRESSIONS.get(kind, ("none",))[0]
        target = file_to_write(path)
        write_table(self._batches, target, kind, compression, csv_safe)


def tidy(name: str, batches: RecordBatches, path: str | None = None) -> Table:
    """A whole table: the raw bytes of texts only where some text is not UTF-8."""
    return Table(name, batches.without_empty_raw(), path)


def by_instance(table: Table) -> dict[str, Table]:
    """A table for each instance, as `IMU[0]`, without the column that tells them apart."""
    kept = [column for column in table.columns if column != table.instance_field]
    return {name: part.select(kept) for name, part in table.instances().items()}


def check_sender(table: Table, advice: str) -> None:
    """ValueError where there are several: their rows side by side make values that nobody sent.
    `advice` is what else to do, of the name and a sender.
    """
    senders = sorted(table._batches.senders())
    if len(senders) > 1:
        which = ", ".join(f"{sysid}/{compid}" for sysid, compid in senders[:5])
        more = ", ..." if len(senders) > 5 else ""
        raise ValueError(
            f"{table.name} comes from several senders ({which}{more}): choose one by systems=, or "
            + advice.format(table.name, senders[0])
        )
