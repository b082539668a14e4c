"""`DataflashLog`: ArduPilot's logs, binary and text, behind the face of `TelemetryLog`.

Messages come from `DFReader`, tables from the native reader of tables; both say the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from math import isfinite
from typing import Any, Unpack

from mavwire._native import DataflashTables, LogKind, identify

from .base import Log
from .checks import no_record_type
from .format_error import no_record
from .query import Query, Records, Types, takes
from .selection import Selection, separate_fields
from .sources import Opened, file_status, is_compressed, open_dataflash, read_dataflash
from .summary import LogInfo
from .table import Table


class DataflashLog(Log):
    """A dataflash log. Iterating gives its messages (`DFMessage`) in the order of the file.

    Each pass opens the file anew. The log's description of itself is read when it is first needed, and
    again when the file has changed. Raises FileNotFoundError and its kin, LogFormatError for a file
    that holds something else.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = os.fsdecode(path)
        self._surveyed: tuple[tuple[int, int], DataflashTables] | None = None
        kind = identify(self.path, unpack=True)
        if not kind.is_dataflash:
            raise no_record("dataflash", self.path)
        if kind is LogKind.HEADERLESS:
            self._tables()  # which says so if there is no description further on either

    def __reduce__(self) -> tuple[Any, ...]:
        """Unpickling opens the log by its path."""
        return DataflashLog, (self.path,), {"closed": self.closed}

    def _tables(self) -> DataflashTables:
        """The native reader, renewed when the file has changed."""
        return self._opened(None)[0]

    def _opened(self, selection: Selection | None) -> Opened:
        """The native reader. A new one gives the tables of a selection in the same pass."""
        self._check_open()
        status = file_status(self.path)
        if self._surveyed is not None and self._surveyed[0] == status:
            return self._surveyed[1], None
        if selection is not None:
            opened = read_dataflash(self.path, self.path, selection)
        else:
            tables = open_dataflash(self.path, self.path)
            opened = None if tables is None else (tables, None)
        if opened is None:
            raise no_record("dataflash", self.path)
        self._surveyed = status, opened[0]
        return opened

    @property
    def types(self) -> dict[str, list[str]]:
        """The record types that the log describes, and the columns of their tables."""
        return self._tables().types()

    # -- messages

    @takes(Records, "systems", "start", "end")
    def messages(
        self, types: Types = None, *positional: Any, **query: Unpack[Records]
    ) -> Iterator[Any]:
        """The messages of some types with `start <= time < end`, as DFReader gives them.

        `types`: names of record types. Times are seconds since 1970 or datetimes; `_timestamp` of a
        message is such a time where the log has a GPS fix, else seconds since the autopilot's start;
        where a text log has no finite number for it, it is that of the message before.
        `systems` is there for `TelemetryLog`; ValueError for anything but None.
        """
        selection = Selection.of_dataflash(types, **query)
        selection.check_dataflash()
        self._tables()
        return self._messages(selection)

    def _messages(self, selection: Selection) -> Iterator[Any]:
        from mavwire.DFReader import DFReader_binary, DFReader_text

        if is_compressed(self.path):
            raise ValueError(f"messages of a compressed log are read as tables only: {self.path!r}")
        start = float("-inf") if selection.start is None else selection.start
        end = float("inf") if selection.end is None else selection.end
        reader_class = DFReader_binary if self._tables().is_binary else DFReader_text
        with reader_class(self.path) as reader:
            first = reader.clock.timestamp
            newest = first if isfinite(first) else reader.clock.timebase
            while (msg := reader.recv_match(type=selection.names, strict=True)) is not None:
                if isfinite(msg._timestamp):
                    newest = msg._timestamp
                else:
                    msg._timestamp = newest
                if start <= newest < end:
                    yield msg

    def __len__(self) -> int:
        """How many records the log has."""
        return self.info().messages

    # -- tables

    def __getitem__(self, name: str) -> Table:
        """The records of a type as a table; KeyError if the log describes none of that name."""
        selection = Selection(names=[name])
        opened = self._opened(selection) if isinstance(name, str) else None
        if opened is None or name not in opened[0].names:
            raise KeyError(no_record_type(name, opened[0].names if opened else ()))
        from .reading import read_described

        return read_described(*opened, self.path, selection, None, False)[name]

    def __contains__(self, what: object) -> bool:
        """Whether the log has records of the type of that name. It is read up to the first one."""
        if not isinstance(what, str):
            return any(one == what for one in self)
        tables = self._tables()
        if what not in tables.names:
            return False
        run = tables.columns(Selection(names=[what], batch_rows=0))  # those of a block
        return any(found for found in run)

    def _read(self, types: Types, wide: bool, query: Query) -> dict[str, Table]:
        from .reading import read_described

        fields = separate_fields(query, wide)
        selection = Selection.of_dataflash(types, **query)
        return read_described(*self._opened(selection), self.path, selection, fields, wide)

    def info(self, pulse: Callable[[int], object] | None = None) -> LogInfo:
        """The content of the log: types, rates, gaps, damage. Senders are not listed: it has one.

        `pulse`, if given, is told now and then how many bytes are read.
        """
        from .summary import GAP_SECONDS, info_of

        return info_of(self.path, self._tables().summary(int(GAP_SECONDS * 1e6), pulse))
