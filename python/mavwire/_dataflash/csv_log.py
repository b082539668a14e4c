"""CSV files as logs: a message for each row, its attributes named by the headings."""

from __future__ import annotations

import csv
import os
from contextlib import suppress

from mavwire.links.conditions import evaluate_condition, evaluate_expression

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any, TextIO


# Characters of a row, however many lines its quotes span. A longer one is damage.
MAX_ROW = 1 << 20


class _Lines:
    """The lines of a file for `csv.reader`, which raises csv.Error for a row beyond `MAX_ROW`."""

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self._left = MAX_ROW

    def begin_row(self) -> None:
        self._left = MAX_ROW

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = self._file.readline(self._left + 1)
        if not line:
            raise StopIteration
        self._left -= len(line)
        if self._left < 0:
            while line and line[-1] not in "\r\n":
                line = self._file.readline(MAX_ROW)
            raise csv.Error(f"a row of more than {MAX_ROW} characters")
        return line


class CSVFormat:
    """The headings of a file."""

    def __init__(
        self,
        headings: list[str],
        messages: dict[str, Any],
        timestamp_expression: str | None = None,
    ) -> None:
        self.headings = headings
        self.messages = messages
        self.timestamp_expression = timestamp_expression
        self.field_offset = {name: index for index, name in enumerate(headings)}


class CSVMessage:
    """A row. Cells that look like numbers are floats. KeyError for no such heading."""

    def __init__(self, message_type: str, fmt: CSVFormat, line: list[str]) -> None:
        self.message_type = message_type
        self.fmt = fmt
        self.line = [_cell(text) for text in line]

    def __getattr__(self, field: str) -> Any:
        if field == "_timestamp":
            return self._time()
        if field in ("fmt", "line") or (field.startswith("__") and field.endswith("__")):
            raise AttributeError(field)
        return self.line[self.fmt.field_offset[field]]

    def _time(self) -> Any:
        """By the expression over the newest messages, or the first column as an int."""
        expression = self.fmt.timestamp_expression
        if expression is None:
            return int(self.line[0])
        return evaluate_expression(expression, self.fmt.messages)

    def get_type(self) -> str:
        """The message type, which the reader was given for all rows."""
        return self.message_type

    def get_fieldnames(self) -> list[str]:
        """The headings."""
        return self.fmt.headings

    def to_dict(self) -> dict[str, Any]:
        """`mavpackettype` and the cells by their headings."""
        cells = zip(self.fmt.headings, self.line, strict=False)
        return {"mavpackettype": self.message_type, **dict(cells)}

    def __str__(self) -> str:
        cells = zip(self.fmt.headings, self.line, strict=False)
        return f"{self.message_type} {{{''.join(f'{name} : {cell}, ' for name, cell in cells)}}}"


def _cell(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _encoding_of(filename: str) -> str:
    """The encoding by the byte order mark. The mark does not become part of the first heading."""
    with open(filename, "rb") as file:
        head = file.read(2)
    return "utf-16" if head in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"


class CSVReader:
    """A CSV file. `CSV_SEPARATOR` in the environment goes before `separator`.

    `timestamp_expression` gives the messages' times, over the newest messages. ValueError where
    there are no headings.
    """

    def __init__(
        self,
        filename: str,
        zero_time_base: bool = False,
        progress_callback: Callable[[int], Any] | None = None,
        separator: str = ";",
        message_type: str = "CSV",
        timestamp_expression: str | None = None,
    ) -> None:
        self.filename = filename
        self.separator = os.environ.get("CSV_SEPARATOR", separator)
        self.message_type = message_type
        self.progress_callback = progress_callback
        self.timestamp_expression = timestamp_expression
        self.timestamp = 0
        self.verbose = False
        self.params: dict[str, Any] = {}
        self.percent = 0
        self.linecount: int | None = None
        self._flightmodes: list[tuple[str, float, float]] = []
        encoding = _encoding_of(filename)
        self.f = open(filename, newline="", encoding=encoding, errors="backslashreplace")
        self.messages: dict[str, Any] = {"MAV": self}
        self._look_ahead()

    def _look_ahead(self) -> None:
        """Keep the first row as the newest, so that there is one before any is read."""
        self._rewind()
        with suppress(ValueError, LookupError):  # of this row, and raised again when it is read
            first = self._parse_next()
            if first is not None:
                self._add_msg(first)
        self._rewind()

    def _rewind(self) -> None:
        self.f.seek(0)
        self._lines = _Lines(self.f)
        self.reader: Iterator[list[str]] = csv.reader(self._lines, delimiter=self.separator)
        try:
            headings = next(self.reader, None)
        except csv.Error as error:
            raise ValueError(f"no headings in {self.filename!r}: {error}") from None
        if headings is None:
            raise ValueError(f"no headings in {self.filename!r}")
        self.fmt = CSVFormat(headings, self.messages, self.timestamp_expression)

    def rewind(self) -> None:
        """Read from the first row again."""
        self._rewind()

    def close(self) -> None:
        """Close the file."""
        self.f.close()

    def __enter__(self) -> CSVReader:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def count_lines(self) -> int:
        """Count the rows, which rewinds."""
        self._rewind()
        count = sum(1 for _ in self._rows())
        self._look_ahead()
        return count

    @property
    def _count(self) -> int:
        if self.linecount is None:
            self.linecount = self.count_lines()
        return self.linecount

    def _rows(self) -> Iterator[list[str]]:
        """The rows from here on. Broken rows (a quote that is never closed, an endless row) are left out."""
        while True:
            self._lines.begin_row()
            try:
                yield next(self.reader)
            except StopIteration:
                return
            except csv.Error:
                continue

    def _parse_next(self) -> CSVMessage | None:
        row = next((row for row in self._rows() if row), None)
        return None if row is None else CSVMessage(self.message_type, self.fmt, row)

    def _add_msg(self, m: CSVMessage) -> None:
        self.messages[m.get_type()] = m

    def recv_msg(self) -> CSVMessage | None:
        """The next row, None at the end."""
        m = self._parse_next()
        if m is not None:
            self._add_msg(m)
        return m

    def recv_match(
        self, condition: str | None = None, type: Any = None, blocking: bool = False
    ) -> CSVMessage | None:
        """The next message of a type, a name or a collection of names, while `condition` holds."""
        types = {type} if isinstance(type, str) else type
        while (m := self.recv_msg()) is not None:
            if types is not None and m.get_type() not in types:
                continue
            if self.check_condition(condition):
                return m
        return None

    def check_condition(self, condition: str | None) -> Any:
        """Whether a condition holds for the newest message."""
        return evaluate_condition(condition, self.messages)

    def name_to_id(self, name: str) -> int:
        """There is one type: 1."""
        return 1

    def flightmode_list(self) -> list[tuple[str, float, float]]:
        """Empty: a CSV file has no flight modes."""
        return self._flightmodes
