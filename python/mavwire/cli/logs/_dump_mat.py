"""`mavwire dump --format mat`: a MATLAB file (level 5) with a structure for each message type.

Its fields are columns: numbers as rows, texts as lines of a character array, arrays as lines of a
matrix, and what has different lengths as a cell array.
"""

from __future__ import annotations

import re
import struct
import sys
import zlib
from argparse import Namespace
from array import array
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import chain
from typing import Any

from mavwire.cli._errors import CommandError
from mavwire.cli._output import writing
from mavwire.links.recording import shown

_INT8, _UINT8, _UINT16, _INT32, _UINT32, _DOUBLE, _INT64, _UINT64 = 1, 2, 4, 5, 6, 9, 12, 13
_MATRIX, _COMPRESSED = 14, 15
_CELL_CLASS, _STRUCT_CLASS, _CHAR_CLASS, _DOUBLE_CLASS = 1, 2, 4, 6
_UINT8_CLASS, _INT64_CLASS, _UINT64_CLASS = 9, 14, 15
# Classes of numbers: their elements, and the type code of `array`.
_NUMBERS = {
    _DOUBLE_CLASS: (_DOUBLE, "d"), _UINT8_CLASS: (_UINT8, "B"),
    _INT64_CLASS: (_INT64, "q"), _UINT64_CLASS: (_UINT64, "Q"),
}  # fmt: skip
_MAX_NAME = 63
_BEYOND_16_BITS = re.compile("[\U00010000-\U0010ffff]")


class Tables:
    """The values of all messages, by type and field."""

    def __init__(self) -> None:
        self._columns: dict[tuple[str, tuple[str, ...]], list[list[Any]]] = {}

    def add(self, msg: Any) -> None:
        """Append a message to the table of its type; other fields make another table."""
        values = msg.to_dict()
        kind = values.pop("mavpackettype")
        if kind == "FMT":  # of dataflash logs: not what was measured
            return
        key = kind, tuple(values)
        columns = self._columns.get(key)
        if columns is None:
            columns = self._columns[key] = [[] for _ in values]
        for column, (field, value) in zip(columns, values.items(), strict=True):
            column.append(shown(field, value))

    def encoded(self, compress: bool) -> Iterator[bytes]:
        """The parts of the file."""
        yield b"MATLAB 5.0 MAT-file, written by mavwire".ljust(124) + struct.pack(
            "<HH", 256, 0x4D49
        )
        taken: set[str] = set()
        for (kind, fields), columns in self._columns.items():
            data = _structure(_identifier(kind, taken), fields, columns)
            if compress:
                packed = zlib.compress(data)
                data = struct.pack("<II", _COMPRESSED, len(packed)) + packed
            yield data


@contextmanager
def mat_file(args: Namespace) -> Iterator[Tables]:
    """Tables that are written at the end; what was there before stays when something fails."""
    if args.mat_file is None:
        raise CommandError("--format mat needs --mat_file FILE", exit_code=2)
    tables = Tables()
    try:
        with writing(args.mat_file, [args.log], "--mat_file") as file:
            yield tables
            for part in tables.encoded(args.compress):
                file.write(part)
    except struct.error as error:
        raise CommandError("--format mat: one type fills more than 4 GB; use --types") from error


def _identifier(name: str, taken: set[str]) -> str:
    """A name that MATLAB can use, other than those that are taken."""
    usable = re.sub(r"[^A-Za-z0-9_]", "_", name)
    if not usable[:1].isalpha():
        usable = f"x{usable}"
    usable = usable[:_MAX_NAME]
    number, unique = 1, usable
    while unique in taken:
        number += 1
        unique = f"{usable[: _MAX_NAME - 6]}_{number}"
    taken.add(unique)
    return unique


def _element(kind: int, data: bytes) -> bytes:
    if 0 < len(data) <= 4:
        return struct.pack("<HH", kind, len(data)) + data.ljust(4, b"\0")
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def _matrix(kind: int, shape: tuple[int, int], content: bytes, name: str = "") -> bytes:
    """An array of a class, with the elements of its content."""
    flags = _element(_UINT32, struct.pack("<II", kind, 0))
    sizes = _element(_INT32, struct.pack("<ii", *shape))
    return _element(_MATRIX, flags + sizes + _element(_INT8, name.encode()) + content)


def _structure(name: str, fields: Sequence[str], columns: list[list[Any]]) -> bytes:
    taken: set[str] = set()
    names = b"".join(
        _identifier(field, taken).encode().ljust(_MAX_NAME + 1, b"\0") for field in fields
    )
    width = _element(_INT32, struct.pack("<i", _MAX_NAME + 1))
    content = width + _element(_INT8, names) + b"".join(map(_column, columns))
    return _matrix(_STRUCT_CLASS, (1, 1), content, name)


def _column(values: list[Any]) -> bytes:
    if all(isinstance(value, str) for value in values):
        return _texts(values)
    if all(isinstance(value, (int, float)) for value in values):
        return _numbers(values, (1, len(values)))
    if all(_is_row(value) for value in values):
        width = len(values[0])
        if width and all(len(value) == width for value in values):
            bytewise = all(isinstance(value, (bytes, bytearray)) for value in values)
            flat = list(chain.from_iterable(zip(*values, strict=True)))
            return _numbers(flat, (len(values), width), _UINT8_CLASS if bytewise else None)
    return _matrix(_CELL_CLASS, (len(values), 1), b"".join(map(_cell, values)))


def _is_row(value: Any) -> bool:
    return not isinstance(value, (str, int, float)) and all(
        isinstance(one, (int, float)) for one in value
    )


def _cell(value: Any) -> bytes:
    if isinstance(value, (str, int, float)):
        return _column([value])
    return _column(list(value)) if len(value) else _numbers([], (0, 0))


def _numbers(values: list[Any], shape: tuple[int, int], kind: int | None = None) -> bytes:
    """Numbers, one column after the other."""
    if kind is None:
        kind = _class_of(values)
    element, code = _NUMBERS[kind]
    data = array(code, map(float, values) if code == "d" else values)
    if sys.byteorder == "big":
        data.byteswap()
    return _matrix(kind, shape, _element(element, data.tobytes()))


def _class_of(values: list[Any]) -> int:
    """Whole numbers stay so where 64 bits can hold all of them."""
    if values and all(isinstance(value, int) for value in values):
        if min(values) >= -(1 << 63) and max(values) < 1 << 63:
            return _INT64_CLASS
        if min(values) >= 0 and max(values) < 1 << 64:
            return _UINT64_CLASS
    return _DOUBLE_CLASS


def _texts(values: list[str]) -> bytes:
    """Lines of one width; letters beyond 16 bits have no place there."""
    lines = [_BEYOND_16_BITS.sub("\ufffd", value) for value in values]
    width = max(1, *map(len, lines))
    letters = "".join(chain.from_iterable(zip(*(line.ljust(width) for line in lines), strict=True)))
    data = letters.encode("utf-16-le", "surrogatepass")
    return _matrix(_CHAR_CLASS, (len(values), width), _element(_UINT16, data))
