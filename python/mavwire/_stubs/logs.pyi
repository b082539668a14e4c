"""Telemetry logs, as `mavwire._native` has them."""

from collections.abc import Callable, Iterable
from os import PathLike
from typing import Any, Self, final

from mavwire._native import Dialect, Message
from mavwire._stubs.links import Link
from mavwire.logs.selection import Selection
from typing_extensions import disjoint_base

@disjoint_base
class LogLink(Link):
    """A telemetry log as a link: `mavutil.mavlogfile` derives from it."""

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Self: ...
    percent: float
    """How much of the log is read, 0 to 100."""

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes of the log; empty at its end."""

    @property
    def _stamped(self) -> bool:
        """Records have time stamps, whether or not messages are stamped with them."""

    def pre_message(self) -> None:
        """Reads the time stamp of the next record, unless the frame of the last one is still incomplete."""

    def scan_timestamp(self, tbuf: bytes) -> float:
        """The time stamp `tbuf`, or the first believable one behind it, to which the log moves.

        Believable is what is within three days of the last good message. ValueError unless `tbuf`
        has 8 bytes.
        """

    def skip_to_type(self, type: str | Iterable[str]) -> None:
        """Seeks to the next record of the types in `type`, heartbeats or parameters.

        The types of the first call stay in force until the log is rewound. Behind the last such
        record reading goes on record by record.
        """

    def _open_reader(self, path: str | PathLike[str], stamped: bool, now: float) -> None:
        """Opens the file for reading; `stamped` says that its records have time stamps. OSError."""

    def _close_reader(self) -> None:
        """Closes the file; from then on the log is at its end."""

    def _end_record(self) -> None:
        """Makes the next time stamp due, whether or not `post_message` hears of the message."""

    def _tell(self) -> int:
        """Position in the file."""

    def _seek(self, offset: int) -> None:
        """Continues at the record that begins at `offset`, whatever was read before."""

    def _restart(self) -> None:
        """Reads from the start again, of any types."""

    def _build_index(self, progress_callback: Callable[[int], object] | None = None) -> None:
        """Indexes the log; `progress_callback` gets each new whole percent."""

    def _index_counts(self) -> list[tuple[int, str, int]]:
        """`[(message id, name, count), ...]` in the order in which the types first appear."""

    def _index_offsets(self) -> list[tuple[int, list[int]]]:
        """`[(message id, offsets of its records), ...]` in the order in which the types first appear."""

    def _wanted_ids(self) -> list[int] | None:
        """Message ids that a filtered read visits; None before the first one."""

    def _visited_offset(self) -> int:
        """Where the record begins that a filtered read visited last, 0 before the first one."""

@final
class LogScan:
    """One pass over a telemetry log, an iterator of messages."""

    def __new__(
        cls,
        path: str | PathLike[str],
        dialect: Dialect,
        rescan: bool,
        query: Selection | None = None,
    ) -> LogScan: ...
    def __iter__(self) -> LogScan: ...
    def __next__(self) -> Message:
        """The next message; OSError where reading fails, after what was read before."""

    def count(self) -> int:
        """Runs to the end and counts the messages instead of making them."""

    def close(self) -> None:
        """Closes the file; the pass is at its end."""

def dump_log(log: LogLink, options: Any) -> None:
    """Dumps a log from its position to its end, as `options` (of `mavwire dump`) say.

    RuntimeError if the log is not open or cannot be read natively. Where reading or a callback
    fails, what was read before is written first.
    """
