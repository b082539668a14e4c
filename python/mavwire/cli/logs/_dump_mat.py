"""`mavwire dump --format mat`: a MATLAB file (level 5) with a structure for each message type.

Its fields are columns: numbers as rows, texts as lines of a character array, arrays as lines of a
matrix, and values of different lengths as a cell array.
"""

from __future__ import annotations

import re
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

from mavwire._extras import extra
from mavwire.cli._errors import CommandError
from mavwire.cli._output import writing
from mavwire.links.signing import shown

_MAX_NAME = 63


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
        columns = self._columns.setdefault(key, [])
        columns.append([shown(field, value) for field, value in values.items()])

    def structures(self) -> dict[str, dict[str, Any]]:
        """The variables of the file. A type that another one's fields have too gets a number behind its name."""
        found: dict[str, dict[str, Any]] = {}
        for (kind, fields), rows in self._columns.items():
            structure: dict[str, Any] = {}
            for field, column in zip(fields, zip(*rows, strict=True), strict=True):
                structure[_identifier(field, structure)] = _array(column)
            found[_identifier(kind, found)] = structure
        return found


@contextmanager
def mat_file(args: Namespace) -> Iterator[Tables]:
    """Tables that are written at the end; what was there before stays when something fails."""
    if args.mat_file is None:
        raise CommandError("--format mat needs --mat_file FILE", exit_code=2)
    with extra("tools"):
        from scipy.io import savemat
        from scipy.io.matlab import MatWriteError
    tables = Tables()
    try:
        with writing(args.mat_file, [args.log], "--mat_file") as file:
            yield tables
            content = BytesIO()  # savemat seeks, and a pipe cannot
            savemat(
                content, tables.structures(), do_compression=args.compress, long_field_names=True
            )
            file.write(content.getvalue())
    except MatWriteError as error:  # more than 4 GB
        raise CommandError(f"--format mat: {error}; use --types") from error


def _identifier(name: str, taken: dict[str, Any]) -> str:
    """A name that MATLAB can use, other than those that are taken."""
    usable = re.sub(r"^(?![A-Za-z])", "x", re.sub(r"\W", "_", name, flags=re.ASCII))[:_MAX_NAME]
    number, unique = 1, usable
    while unique in taken:
        number += 1
        unique = f"{usable[: _MAX_NAME - 6]}_{number}"
    return unique


def _array(values: tuple[Any, ...]) -> Any:
    """An array of numbers, or of lines; one of objects, which becomes cells, where they are neither."""
    import numpy as np

    is_text = [isinstance(value, str) for value in values]
    if not all(is_text) and not any(is_text):
        values = tuple(list(v) if isinstance(v, (bytes, bytearray)) else v for v in values)
        try:
            array = np.array(values)
            return array.astype(float) if array.dtype == object else array  # beyond 64 bits
        except ValueError:  # arrays of different lengths
            pass
    elif all(is_text):
        return np.array([value.encode("utf-8", "replace").decode() for value in values])
    cells = np.empty(len(values), dtype=object)
    cells[:] = values
    return cells
