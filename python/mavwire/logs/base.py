"""What logs of all kinds have in common."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from datetime import datetime
    from typing import Self

    from .common_clock import Span
    from .table import Table


class Log:
    """A log that is open: its passes open the file anew, so closing it only forbids new ones."""

    path: str
    closed = False

    def read(
        self,
        types: str | type | Iterable[str | type] | None = None,
        systems: int | Iterable[int] | None = None,
        fields: str | Iterable[str] | None = None,
        start: float | str | datetime | None = None,
        end: float | str | datetime | None = None,
        *,
        units: str | None = None,
        enums: str | None = None,
        invalid: str | None = None,
        wide: bool = False,
    ) -> dict[str, Table]:
        """`{type: table}` in one pass."""
        raise NotImplementedError

    def align(
        self,
        types: str | Iterable[str],
        *,
        on: str | None = None,
        rate: Span | None = None,
        method: str = "ffill",
        tolerance: Span | None = None,
        systems: int | Iterable[int] | None = None,
        fields: str | Iterable[str] | None = None,
        start: float | str | datetime | None = None,
        end: float | str | datetime | None = None,
        units: str | None = None,
        enums: str | None = None,
        invalid: str | None = None,
    ) -> Table:
        """One wide table of several types on a common clock; see `mavwire.logs.align`.

        `invalid` is that of `read`, but "null" by default with `method="linear"`: a line to 65535
        is no course of values.
        """
        from .align import align, check_clock, of_fields, possible_columns
        from .checks import check_fields
        from .selection import names_of

        check_clock(on)
        invalid = invalid or ("null" if method == "linear" else None)
        names = names_of(types)
        fields = None if fields is None else names_of(fields)
        wanted = {*names, on} if on is not None else set(names)
        # All columns: the one that tells instances apart is needed whatever is wanted.
        every = self.read(
            sorted(wanted), systems, None, start, end, units=units, enums=enums, invalid=invalid
        )
        if fields is not None:
            check_fields(set().union(*map(possible_columns, every.values())), fields)
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
