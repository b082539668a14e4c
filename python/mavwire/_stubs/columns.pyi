"""Tables of `mavwire._native`: columns of logs, conversion, summaries."""

from collections.abc import Callable, Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Final, TypeAlias, final

from mavwire._native import Dialect
from mavwire.logs.selection import Selection
from typing_extensions import Buffer

__all__ = [
    "ColumnView",
    "Converter",
    "DataflashTables",
    "LakeFile",
    "LogColumns",
    "LogKind",
    "LogRewrite",
    "RecordBatches",
    "align_tables",
    "csv_safe",
    "date_text",
    "decompress",
    "draft_stem",
    "empty_table",
    "identify",
    "jump_text",
    "log_summary",
    "write_table",
]

_Log: TypeAlias = (
    str
    | PathLike[str]
    | tuple[str | PathLike[str], int, int]
    | tuple[str | PathLike[str], int, int, bool]
    | bytes
)
"""A file; the bytes of one from the first to one that is not meant any more; the same of a telemetry
log, and whether its records have time stamps; the bytes of a log."""

@final
class LogColumns:
    """One pass over a telemetry log or raw stream, an iterator of tables."""

    def __new__(cls, log: _Log, dialect: Dialect, query: Selection) -> LogColumns: ...
    def __iter__(self) -> LogColumns: ...
    def __next__(self) -> list[tuple[str, RecordBatches]]:
        """The tables that are ready after another block of the log, with message names; perhaps none."""

    def progress(self) -> tuple[int, int, str | None, dict[tuple[int, int] | None, int]]:
        """Bytes of the log, decompressed, that are dealt with; how many of them belong to no record; the
        damage of a compressed file; `{(message id, CRC_EXTRA): messages}` that the dialect does not
        define, under None those that are not listed.
        """

@final
class RecordBatches:
    """A table: a schema and batches of rows."""

    @staticmethod
    def from_stream(table: Any) -> RecordBatches:
        """A table of anything that has `__arrow_c_stream__`; the data is shared."""

    @staticmethod
    def joined(tables: list[RecordBatches]) -> RecordBatches:
        """Tables one behind the other; ValueError where their columns differ."""

    @staticmethod
    def from_ipc(bytes: bytes) -> RecordBatches:
        """The table in the bytes of an Arrow file."""

    @property
    def num_rows(self) -> int:
        """Rows of all batches."""

    @property
    def nbytes(self) -> int:
        """Bytes of the values."""

    @property
    def names(self) -> list[str]:
        """Names of the columns."""

    def metadata(self) -> dict[str, dict[str, str]]:
        """`{column: {key: value}}`."""

    def types(self) -> dict[str, str]:
        """`{column: Arrow's name of its type}`."""

    def column(self, name: str) -> ColumnView:
        """A column in one piece; KeyError if there is none of that name."""

    def without_empty_raw(self) -> RecordBatches:
        """The same without columns of raw bytes that hold nothing but nulls; itself if there is none."""

    def select(self, names: list[str]) -> RecordBatches:
        """Some of the columns, in the order given; KeyError if there is none of a name."""

    def split(self, name: str) -> list[tuple[str, RecordBatches]]:
        """The rows of each value of a column, by its text; ValueError for too many values."""

    def senders(self) -> set[tuple[int, int]]:
        """System and component ids of the rows, each pair once; none where the table lacks them."""

    def slice(self, start: int, rows: int) -> RecordBatches:
        """Some of the rows."""

    @staticmethod
    def common(tables: Iterator[tuple[str, RecordBatches]]) -> RecordBatches:
        """An empty table with the columns of all `tables`, pairs of `(path of the log, table)` of one type.
        ValueError if columns of one name in two logs have no common type.
        """

    def fitted(self, like: RecordBatches) -> RecordBatches:
        """The same rows with the columns of a table that `common` made. Values that do not fit are null."""

    def stream(self, tables: Iterator[RecordBatches]) -> object:
        """An Arrow stream of tables that an iterator gives, with the columns of this one."""

    def __arrow_c_stream__(self, requested_schema: object = None) -> object: ...
    def __arrow_c_schema__(self) -> object: ...
    def __len__(self) -> int: ...

@final
class ColumnView(Buffer):
    """One column: a read-only buffer of numbers, or a list of texts; the elements of lists one by one."""

    @property
    def dtype(self) -> str | None:
        """The type of its numbers or times as NumPy spells it; None for texts."""

    @property
    def elements(self) -> int | None:
        """How many elements its lists have; None if its values are no lists."""

    def valid(self) -> bytes | None:
        """A byte for each value, 0 for a null; None if there are no nulls."""

    def to_list(self) -> list[Any]:
        """The texts or bytes, None for nulls; BufferError for numbers."""

    def __len__(self) -> int: ...

@final
class Converter:
    """Writes the tables of a log to `folder/MESSAGE/file`, or all to `folder/file` of MCAP."""

    def __new__(
        cls,
        log: LogColumns,
        query: Selection,
        folder: str | PathLike[str],
        file: str,
        format: str,
        compression: str,
    ) -> Converter: ...
    def step(self) -> bool:
        """Converts another block of the log; false at its end."""

    def commit(self) -> list[tuple[Path, int]]:
        """Gives the files their names: paths and rows."""

    def abandon(self) -> None:
        """Removes what was written and not committed."""

@final
class LakeFile:
    """A Parquet file of rows of many logs, with columns `log` and `digest`. It appears when it is complete."""

    def __new__(cls, path: str | PathLike[str]) -> LakeFile: ...
    def write(self, pieces: Sequence[tuple[RecordBatches, tuple[str, str] | None]]) -> int:
        """Appends a row group of tables with the same columns, each with its log and digest, or None if it
        has these columns. Bytes of the file so far. The first rows decide which columns the file has.
        """

    def finish(
        self,
    ) -> tuple[
        int,
        list[tuple[str, str]],
        list[tuple[str, tuple[int, int] | tuple[str, str] | None, int]],
    ]:
        """Gives the file its name: its rows, columns with their types as Delta Lake calls them, and
        `(column, (least, largest), nulls)` of some columns.
        """

@final
class DataflashTables:
    """A dataflash log, binary or text, that was gone through once for what it says about itself."""

    @staticmethod
    def read(
        log: _Log, query: Selection | None = None
    ) -> tuple[DataflashTables, list[tuple[str, RecordBatches]] | None] | None:
        """A log's description of itself, with the tables that `query` asks for. None if it is no
        dataflash log. The tables are None without a query, or if they need another pass over the log,
        by `columns`.
        """

    @property
    def is_binary(self) -> bool:
        """Whether it is a binary log; else it is text."""

    @property
    def names(self) -> list[str]:
        """The record types that the log describes."""

    def types(self) -> dict[str, list[str]]:
        """The record types that the log describes, and their columns."""

    def empty(self, name: str, query: Selection) -> RecordBatches:
        """A table without rows of a record type; KeyError for no such type."""

    def columns(self, query: Selection) -> LogColumns:
        """One run over the log, giving tables."""

    def summary(self, gap: int, pulse: Callable[[int], object] | None) -> dict[str, Any]:
        """The summary of the log; `gap` in microseconds. See `mavwire.logs.summary`."""

@final
class LogRewrite:
    """One run over telemetry logs that writes another, which appears when it is complete."""

    def __new__(
        cls,
        paths: list[str],
        dialect: Dialect,
        out: str | PathLike[str],
        query: Selection | None = None,
        shift: tuple[float, float] | None = None,
    ) -> LogRewrite:
        """The records that `query` asks for, or all in the order of time; anonymous where `shift`
        (degrees north, east) is given. ValueError for a raw stream where times are needed.
        """

    def step(self) -> bool:
        """Another block; false at the end."""

    def commit(self) -> None:
        """Gives the file its name."""

    def abandon(self) -> None:
        """Removes what was written and not committed."""

    def faults(self) -> list[tuple[bool, str | None]]:
        """Of each log, whether it holds something and no record as far as it was read, and the damage
        of a compressed file.
        """

    def outcome(self) -> dict[str, Any]:
        """The counts of all logs so far; see `mavwire.logs.rewriting.Rewritten`."""

def write_table(
    table: RecordBatches,
    path: str | PathLike[str],
    format: str,
    compression: str,
    csv_safe: bool,
) -> None:
    """Writes a table to a file, which appears when it is complete."""

def csv_safe(text: str) -> str:
    """A text as a cell of CSV of which no spreadsheet makes a formula; a number stays a number."""

def folder_of(name: str) -> str:
    """The folder of the table of a type, which names no other folder and no device."""

def draft_stem(name: str) -> str:
    """The start of a file's temporary name: its final name, or a hash of it where that name is
    long.
    """

def decompress(path: str | PathLike[str], out: str | PathLike[str]) -> str | None:
    """Writes what a file holds that is compressed with gzip or zstd; what is wrong with that file.

    `out` appears when it is complete, with everything in front of what is wrong.
    """

@final
class LogKind:
    """A kind of log, or of another file."""

    CUT: Final[LogKind]
    """Nothing, or less than the first record of a log."""
    TLOG: Final[LogKind]
    """Telemetry: records of time stamp and frame."""
    RAW: Final[LogKind]
    """Telemetry: frames alone."""
    DATAFLASH: Final[LogKind]
    DATAFLASH_TEXT: Final[LogKind]
    HEADERLESS: Final[LogKind]
    """Records of a binary dataflash log that are not described as far as was looked."""
    OTHER_TEXT: Final[LogKind]
    """A dataflash log as text in UTF-16, or with carriage returns alone."""
    GZIP: Final[LogKind]
    ZSTD: Final[LogKind]
    ZIP: Final[LogKind]
    PROGRAM: Final[LogKind]
    ULOG: Final[LogKind]
    PNG: Final[LogKind]
    PCAP: Final[LogKind]
    SQLITE: Final[LogKind]
    UNKNOWN: Final[LogKind]
    @property
    def is_telemetry(self) -> bool: ...
    @property
    def is_dataflash(self) -> bool: ...
    def __hash__(self) -> int: ...
    def __int__(self) -> int: ...

def identify(log: _Log, unpack: bool = False) -> LogKind:
    """The kind of a log; with `unpack`, the kind of a compressed log's content."""

def empty_table(dialect: Dialect, msgid: int, query: Selection) -> RecordBatches:
    """A table without rows of a message; ValueError if there is none of that id."""

def date_text(seconds: float) -> str:
    """A time in seconds since 1970 as date and time in UTC. Where calendars have none it is the year."""

def jump_text(before: float, after: float) -> str | None:
    """Says that times jump from one second to another; None if they may be those of one flight."""

def align_tables(
    tables: list[tuple[str, RecordBatches]],
    on: RecordBatches | None,
    step: int | None,
    method: str,
    tolerance: int | None,
) -> RecordBatches:
    """One table of several, on the times of `on` or every `step` microseconds."""

def log_summary(
    path: str | PathLike[str],
    dialect: Dialect,
    gap: int,
    pulse: Callable[[int], object] | None,
) -> dict[str, Any]:
    """The summary of a log; `gap` in microseconds. See `mavwire.logs.summary`."""
