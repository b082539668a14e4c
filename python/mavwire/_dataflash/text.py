"""`DFReader_text`: dataflash logs as text, a line for each record."""

from __future__ import annotations

import os
from codecs import BOM_UTF8

from mavwire import _native
from mavwire._text import OTHER_TEXT

from .reader import DFReader

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

PROBE = 8000
KEY_LEN = 4


def DFReader_is_text_log(filename: str) -> bool:
    """Whether the head of a file has a FMT line."""
    with open(filename, "rb") as file:
        return b"FMT," in file.read(PROBE)


class DFReader_text(DFReader):
    """A text log. The arguments are those of `DFReader_binary`."""

    def __init__(
        self,
        filename: str,
        zero_time_base: bool = False,
        progress_callback: Callable[[int], Any] | None = None,
    ) -> None:
        super().__init__()
        self._zero_time_base = zero_time_base
        if _native.identify(os.fsdecode(filename)) is _native.LogKind.OTHER_TEXT:
            is_what = "a text log in UTF-16 or with carriage returns alone"
            raise ValueError(f"{is_what}; {OTHER_TEXT}: {filename!r}")
        self._open_log(filename, text=True)
        self.delimiter = self._delimiter()
        self.init_arrays(progress_callback)
        self.init_clock()

    def init_arrays(self, progress_callback: Callable[[int], Any] | None = None) -> None:
        """Go through the log: `formats`, `counts`, and the names of the types.

        `counts` has the first four characters of a line up to the comma as keys.
        """
        self._init_contents(progress_callback)
        self.formats = {fmt.name: fmt for fmt in self._layouts}
        counts, self._count = self._lines()
        self.counts = dict(counts)

    @property
    def offsets(self) -> dict[str, list[int]]:
        """Offsets of the lines, by the keys of `counts`."""
        offsets: dict[str, list[int]] = {key: [] for key in self.counts}
        of_bytes = {
            key.encode(encoding, "replace"): found
            for encoding in ("latin-1", "utf-8")
            for key, found in offsets.items()
        }
        start = 0
        self.data_map.seek(0)
        while line := self.data_map.readline():
            key = line.removeprefix(BOM_UTF8)[:KEY_LEN]
            found = of_bytes.get(key.partition(b",")[0].rstrip(b"\n"))
            if found is not None and line.strip():
                found.append(start)
            start += len(line)
        return offsets

    @property
    def type_list(self) -> list[str] | None:
        """Types that a filtered read visits, None before the first after a rewind."""
        latched = self._latched()
        return None if latched is None else [self._layouts[index].name for index in latched]
