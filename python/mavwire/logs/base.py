"""The base class of logs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, Self, Unpack

from .common_clock import Span
from .query import Query, Types, takes
from .table import Table


class Log:
    """A log that is open: its passes open the file anew, so closing it only forbids new ones."""

    path: str
    closed = False
    messages: Callable[..., Iterator[Any]]

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.path!r}{' (closed)' if self.closed else ''}>"

    def __iter__(self) -> Iterator[Any]:
        return self.messages()

    @takes(Query, "systems", "fields", "start", "end")
    def read(
        self,
        types: Types = None,
        *positional: Any,
        wide: bool = False,
        **query: Unpack[Query],
    ) -> dict[str, Table]:
        """Tables of several types in one pass: `mavwire.read` on this log.

        Those of a telemetry log always hold what `resync="rescan"` finds. A dataflash log is of one
        system: ValueError for `systems`. It has no enums and no invalid values.
        """
        self._check_open()
        return self._read(types, wide, query)

    def _read(self, types: Types, wide: bool, query: Query) -> dict[str, Table]:
        raise NotImplementedError

    @takes(Query)
    def align(
        self,
        types: str | Iterable[str],
        *,
        on: str | None = None,
        rate: Span | None = None,
        method: str = "ffill",
        tolerance: Span | None = None,
        **query: Unpack[Query],
    ) -> Table:
        """One wide table of several types on a common clock; see `mavwire.logs.align`.

        The other arguments are those of `read`, but `invalid` is "null" by default with
        `method="linear"`: a line to 65535 is no course of values.
        """
        from .align import align, check_clock, of_fields
        from .checks import check_fields
        from .selection import names_of, separate_fields

        check_clock(on)
        if method == "linear":
            query["invalid"] = query.get("invalid") or "null"
        names = names_of(types)
        fields = separate_fields(query, wide=True)  # all columns, also unwanted ones
        wanted = {*names, on} if on is not None else set(names)
        every = self.read(sorted(wanted), **query)
        if fields is not None:
            check_fields(set().union(*(table.columns for table in every.values())), fields)
        tables = of_fields(every, fields, several=True)
        return align(tables, names, on=on, rate=rate, method=method, tolerance=tolerance)

    def close(self) -> None:
        """No more passes can begin; those under way go on to their end."""
        self.closed = True

    def _check_open(self) -> None:
        if self.closed:
            raise ValueError(f"the log is closed: {self.path!r}")

    def __fspath__(self) -> str:
        """The path: an open log may stand wherever one is asked for."""
        return self.path

    def __bool__(self) -> bool:
        return True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
