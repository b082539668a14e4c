"""Record types of dataflash logs, as Python sees them: `DFFormat`, and what format characters mean."""

from __future__ import annotations

import math
import struct
from array import array

from mavwire import _native

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

# Format character -> (struct code, factor, Python type).
FORMAT_TO_STRUCT: dict[str, tuple[str, float | None, type]] = {
    "a": ("64s", None, str),
    "b": ("b", None, int),
    "B": ("B", None, int),
    "g": ("e", None, float),
    "h": ("h", None, int),
    "H": ("H", None, int),
    "i": ("i", None, int),
    "I": ("I", None, int),
    "f": ("f", None, float),
    "n": ("4s", None, str),
    "N": ("16s", None, str),
    "Z": ("64s", None, str),
    "c": ("h", 0.01, float),
    "C": ("H", 0.01, float),
    "e": ("i", 0.01, float),
    "E": ("I", 0.01, float),
    "L": ("i", 1.0e-7, float),
    "d": ("d", None, float),
    "M": ("b", None, int),
    "q": ("q", None, int),
    "Q": ("Q", None, int),
}

# Factor -> SI prefix; other factors are written out in front of the unit.
MULT_TO_PREFIX: dict[float, str] = {
    0: "", 1: "", 1.0e-1: "d", 1.0e-2: "c", 1.0e-3: "m", 1.0e-6: "µ", 1.0e-9: "n",
}  # fmt: skip

INSTANCE_ID = "#"
_PLAIN_NAN = struct.pack(">d", math.nan)


def is_quiet_nan(val: Any) -> bool:
    """Whether `val` is a NaN that some arithmetic left behind, and not the plain one."""
    if not isinstance(val, float) or not math.isnan(val):
        return False
    return struct.pack(">d", val) != _PLAIN_NAN


def to_string(s: Any) -> str:
    """Text of bytes; what is no UTF-8 is shown as `\\xff`. A string stays what it is."""
    if isinstance(s, str):
        return s
    text: str = s.decode("utf-8", "backslashreplace")
    return text


def null_term(string: Any) -> str:
    """The text in front of the first NUL."""
    text = to_string(string)
    end = text.find("\0")
    return text if end < 0 else text[:end]


class DFFormat:
    """A record type: its name, length and columns, and what these are measured in.

    `Exception` for a format character without a meaning, `ValueError` for more than a record holds.
    """

    instance_ofs: int
    instance_len: int

    def __init__(
        self,
        type: int,
        name: str | bytes,
        flen: int,
        format: str | bytes,
        columns: str | bytes,
        oldfmt: DFFormat | None = None,
    ) -> None:
        self.type = type
        self.name = null_term(name)
        self.len = flen
        self.format = null_term(format)
        self.columns = null_term(columns).split(",") if columns else []
        self.instance_field: str | None = None
        self.units: list[str] | None = None
        known = [c for c in self.format if c in FORMAT_TO_STRUCT]
        self.msg_struct = "<" + "".join(FORMAT_TO_STRUCT[c][0] for c in known)
        # The table says str for arrays, as pymavlink's does. The types of their values are here.
        self.msg_types = [array if c == "a" else FORMAT_TO_STRUCT[c][2] for c in known]
        self.msg_mults = [FORMAT_TO_STRUCT[c][1] for c in known]
        self.msg_fmts = list(self.format)
        self.colhash = {column: index for index, column in enumerate(self.columns)}
        self.a_indexes = [n for n, c in enumerate(self.msg_fmts) if c == "a"]
        self._shape = self._make_shape()
        if oldfmt is not None:
            self._take_over(oldfmt)

    def _make_shape(self) -> _native.DataflashShape:
        try:
            return _native.DataflashShape(self.type & 255, self.name, self.format, self.columns)
        except Exception as error:
            if type(error) is Exception:
                print(f"DFFormat: {error}")
            raise

    def _take_over(self, old: DFFormat) -> None:
        self.units = old.units
        if old.instance_field in self.colhash:
            self.set_instance_field(self.colhash[old.instance_field])

    def set_instance_field(self, instance_idx: int) -> None:
        """Let the column of this index tell instances apart."""
        self.instance_field = self.columns[instance_idx]
        before = "".join(FORMAT_TO_STRUCT[c][0] for c in self.msg_fmts[:instance_idx])
        self.instance_ofs = struct.calcsize("<" + before)
        self.instance_len = struct.calcsize("<" + FORMAT_TO_STRUCT[self.msg_fmts[instance_idx]][0])

    def set_unit_ids(self, unit_ids: str | None, unit_lookup: Mapping[str, str]) -> None:
        """Set `units` by a character for each column; `#` marks the one that tells instances."""
        if unit_ids is None:
            return
        self.units = [""] * len(self.columns)
        for index, unit_id in enumerate(unit_ids[: len(self.columns)]):
            self.units[index] = unit_lookup.get(unit_id, "")
        index = unit_ids.find(INSTANCE_ID)
        if 0 <= index < min(len(self.columns), len(self.msg_fmts)):
            self.set_instance_field(index)

    def set_mult_ids(self, mult_ids: str, mult_lookup: Mapping[str, float]) -> None:
        """Put a prefix or a factor in front of the units, by a character for each column.

        Not where the column's values are scaled when they are read.
        """
        if self.units is None:
            raise TypeError("set_unit_ids must be called first")
        for index, (unit, mult_id) in enumerate(zip(self.units, mult_ids, strict=False)):
            factor = mult_lookup.get(mult_id)
            if not unit or factor is None or self._is_scaled(index):
                continue
            prefix = MULT_TO_PREFIX.get(factor)
            self.units[index] = f"{factor:.4g} {unit}" if prefix is None else prefix + unit

    def _is_scaled(self, index: int) -> bool:
        return index < len(self.msg_mults) and self.msg_mults[index] is not None

    def get_unit(self, col: str) -> str:
        """The unit of a column, empty if it has none. KeyError for no column."""
        index = self.colhash[col]
        return "" if self.units is None else self.units[index]

    def __str__(self) -> str:
        return f"DFFormat({self.type},{self.name},{self.format},{self.columns})"
