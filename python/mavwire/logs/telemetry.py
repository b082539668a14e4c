"""`open_log` and `TelemetryLog`: a telemetry log as a sequence of messages.

Every pass over the log opens the file again. So passes do not disturb each other, and a new pass sees
records that were written meanwhile. Records are found and filtered in
Rust without holding the interpreter; an object is made only of what was asked for.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from itertools import islice
from typing import Any, Unpack

from mavwire._native import LogKind, LogScan, identify
from mavwire._text import naming
from mavwire.dialects import UPSTREAM

from .base import Log
from .dataflash import DataflashLog
from .dialect import Dialects, dialect_module, portable, restored
from .format_error import COMPRESSED, not_telemetry
from .query import Query, Records, Types, takes
from .selection import Selection, id_of, no_message
from .sources import check_has_records, file_status
from .summary import LogInfo
from .table import Table

# A file without a single record is called foreign if it is no longer than this.
FOREIGN_PROBE = 16 * 1024 * 1024


def open_log(
    path: str | os.PathLike[str],
    *,
    dialect: Dialects = UPSTREAM,
    resync: str = "rescan",
) -> TelemetryLog | DataflashLog:
    """Open a telemetry log (.tlog) or a dataflash log (.BIN, .log) for its messages and tables.

    `dialect` is the name of a built-in dialect, the path of an XML file, or a dialect module; the
    messages are objects of its classes. `resync="rescan"` finds every good record of a damaged log;
    `"skip"` gives the messages that pymavlink gives. Neither matters to a dataflash log.

    Raises FileNotFoundError, IsADirectoryError or PermissionError, LogFormatError (a ValueError)
    for a file that holds something else, ValueError for an argument. A log that is empty or cut
    off is no error.
    """
    from .sources import is_dataflash

    if is_dataflash(os.fsdecode(path)):
        from .dataflash import DataflashLog

        return DataflashLog(path)
    return TelemetryLog(path, dialect=dialect, resync=resync)


class TelemetryLog(Log):
    """A telemetry log. Iterating gives its messages in the order of the file.

    A message has its time in `_timestamp` (seconds since 1970) and the number of the link it came
    from in `_link`. Ids that the dialect does not know come out as UNKNOWN objects; bytes that
    belong to no record are passed over.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        dialect: Dialects = UPSTREAM,
        resync: str = "rescan",
    ) -> None:
        if resync not in ("skip", "rescan"):
            raise ValueError(f"resync must be 'skip' or 'rescan', not {resync!r}")
        self.path = os.fsdecode(path)
        self.resync = resync
        self._dialect = dialect
        self.dialect = dialect_module(dialect)
        self._native = self.dialect.MAVLink(None)._dialect
        self.compressed = False
        self._counted: tuple[tuple[int, int], int] | None = None
        self._typed: tuple[tuple[int, int], dict[str, list[str]]] | None = None
        self._check()

    def __reduce__(self) -> tuple[Any, ...]:
        """Unpickling opens the log by its path and arguments."""
        arguments = self.path, portable(self._dialect), self.resync
        return _reopened, arguments, {"closed": self.closed}

    # -- messages

    @takes(Records, "systems", "start", "end")
    def messages(
        self, types: Types = None, *positional: Any, **query: Unpack[Records]
    ) -> Iterator[Any]:
        """The messages of some types and systems with `start <= time < end`.

        `types`: names or message classes, one or several; "UNKNOWN" is every unknown id and
        "UNKNOWN_<id>" one of them. `systems`: system ids. Times are seconds since 1970 or
        datetimes. None means all. ValueError names a type that the dialect does not have.
        """
        selection = Selection.of(self.dialect, types, **query)
        selection.check_telemetry()
        return self._scan(selection)

    def __len__(self) -> int:
        """How many messages the log has; counted when first asked for, and when it has changed."""
        status = file_status(self.path)
        if self._counted is None or self._counted[0] != status:
            self._counted = (status, self._scan(Selection()).count())
        return self._counted[1]

    def _scan(self, selection: Selection) -> LogScan:
        self._check_open()
        if self.compressed:
            raise ValueError(f"messages of a compressed log are read as tables only: {self.path!r}")
        return LogScan(self.path, self._native, self.resync == "rescan", selection)

    # -- tables

    def __getitem__(self, name: str) -> Table:
        """The messages of a type as a table; KeyError if the dialect has none of that name.

        A type that is not in the log gives an empty table. For several types, `read` needs one
        pass.
        """
        if id_of(self.dialect, name) is None:
            raise KeyError(no_message(self.dialect, name))
        return self.read(name)[name]

    def __contains__(self, what: object) -> bool:
        """Whether the log has messages of the type of that name. It is read up to the first one."""
        if not isinstance(what, str):
            return any(one == what for one in self)
        if id_of(self.dialect, what) is None:
            return False
        from .reading import batches_of

        self._check_open()
        selection = Selection.of(self.dialect, what)
        selection.batch_rows = 0  # those of a block: nothing is cut into batches to look at one
        return next(batches_of(None, self.path, self._native, selection), None) is not None

    @property
    def types(self) -> dict[str, list[str]]:
        """The message types that are in the log, and the columns of their tables. They are counted
        when first asked for, and when the file has changed: one pass.
        """
        from .checks import no_rows

        status = file_status(self.path)
        if self._typed is None or self._typed[0] != status:
            ids = {cls.msgname: msgid for msgid, cls in self.dialect.mavlink_map.items()}
            found = {
                name: no_rows(self._native, ids[name], Selection()).names
                for name in self.info().types
                if name in ids
            }
            self._typed = (status, found)
        return dict(self._typed[1])

    def _read(self, types: Types, wide: bool, query: Query) -> dict[str, Table]:
        from .reading import read

        return read(self.path, types, wide=wide, dialect=self.dialect, **query)

    def info(self, pulse: Callable[[int], object] | None = None) -> LogInfo:
        """The content of the log: types, rates, senders, losses, gaps, damage.

        `pulse`, if given, is told now and then how many bytes are read.
        """
        from .summary import summarise

        self._check_open()
        return summarise(self.path, self._native, pulse)

    # -- opening

    def _check(self) -> None:
        """Raise what tells why the file is no telemetry log."""
        from .reading import check_readable

        check_readable(self.path)
        with naming(self.path):
            kind = identify(self.path)
        self.compressed = kind in COMPRESSED
        if self.compressed:
            found, damage = self._records(2)  # the second block sees where a short log ends
            if not found:
                check_has_records(self.path, self.path, damage)
        elif not (kind.is_telemetry or kind is LogKind.CUT or self._may_have_records(kind)):
            raise not_telemetry(self.path, kind)

    def _may_have_records(self, kind: LogKind) -> bool:
        """Whether there are records in a file that does not begin as a log, or it is too long to say.
        Other formats have one now and then by chance.
        """
        if kind not in (LogKind.UNKNOWN, LogKind.PCAP):
            return False
        return file_status(self.path)[0] > FOREIGN_PROBE or self._records(None)[0]

    def _records(self, blocks: int | None) -> tuple[bool, str | None]:
        """Whether there is a record in the first blocks, and the damage of a compressed file."""
        from mavwire._native import LogColumns

        run = LogColumns(self.path, self._native, Selection(batch_rows=0))
        return any(map(any, islice(run, blocks))), run.progress()[2]


def _reopened(path: str, dialect: tuple[str, bool], resync: str) -> TelemetryLog:
    return TelemetryLog(path, dialect=restored(*dialect), resync=resync)
