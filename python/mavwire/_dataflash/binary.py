"""`DFReader_binary`: ArduPilot's .BIN logs."""

from __future__ import annotations

import struct

from .formats import DFFormat
from .messages import HEAD
from .reader import DFReader

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

TYPES = 256
FMT_TYPE = 0x80
HEAD_LEN = 3


class DFReader_binary(DFReader):
    """A binary log. `progress_callback` gets each new whole percent of the first run through it.

    `zero_time_base` leaves times as they are since the autopilot's start.
    """

    HEAD1 = HEAD[0]
    HEAD2 = HEAD[1]

    def __init__(
        self,
        filename: str,
        zero_time_base: bool = False,
        progress_callback: Callable[[int], Any] | None = None,
    ) -> None:
        super().__init__()
        self._zero_time_base = zero_time_base
        self._open_log(filename, text=False)
        self.init_arrays(progress_callback)
        self.init_clock()

    def init_arrays(self, progress_callback: Callable[[int], Any] | None = None) -> None:
        """Go through the log: `formats`, `counts`, and the names of the types."""
        self.init_arrays_fast(progress_callback)

    def init_arrays_fast(self, progress_callback: Callable[[int], Any] | None = None) -> None:
        """As `init_arrays`: pymavlink has two versions of it."""
        contents = self._init_contents(progress_callback)
        self.formats = {fmt.type: fmt for fmt in self._layouts}
        self.counts = [0] * TYPES
        for fmt, count in zip(self._layouts, contents["counts"], strict=True):
            self.counts[fmt.type] += count
        self._count = sum(self.counts)

    @property
    def offsets(self) -> list[list[int]]:
        """Offsets of the records of each of the 256 types."""
        offsets: list[list[int]] = [[] for _ in range(TYPES)]
        for fmt, found in zip(self._layouts, self._offsets(), strict=True):
            offsets[fmt.type] = sorted(offsets[fmt.type] + found)
        return offsets

    @property
    def type_nums(self) -> list[int] | None:
        """Types that a filtered read visits, None before the first after a rewind."""
        latched = self._latched()
        return None if latched is None else [self._layouts[index].type for index in latched]

    @property
    def unpackers(self) -> dict[int, Callable[[Any], tuple[Any, ...]]]:
        """Type -> what takes the body of such a record apart, for the types of which there are some."""
        used = (fmt for fmt in self._layouts if self.counts[fmt.type])
        return {fmt.type: struct.Struct(fmt.msg_struct).unpack for fmt in used}

    # -- making records

    def find_unused_format(self) -> int | None:
        """A type number that the log does not use."""
        unused = (number for number in range(TYPES - 2, 0, -1) if number not in self.formats)
        return next(unused, None)

    def add_format(self, fmt: DFFormat) -> DFFormat:
        """Give a new type an unused number. ValueError if there is none."""
        number = self.find_unused_format()
        if number is None:
            raise ValueError("the log uses all type numbers")
        fmt.type = number
        self.formats[number] = fmt
        return fmt

    def make_msgbuf(self, fmt: DFFormat, values: Sequence[Any]) -> bytes:
        """A record of a type, from its stored values; texts are bytes."""
        return HEAD + bytes([fmt.type]) + struct.pack(fmt.msg_struct, *values)

    def make_format_msgbuf(self, fmt: DFFormat) -> bytes:
        """The FMT record that describes a type."""
        length = struct.calcsize(fmt.msg_struct) + HEAD_LEN
        texts = (fmt.name.encode(), fmt.format.encode(), ",".join(fmt.columns).encode())
        described = (fmt.type, length, *texts)
        return self.make_msgbuf(self.formats[FMT_TYPE], described)
