"""`DFReader_text`: dataflash logs as text, a line for each record."""

from __future__ import annotations

import os
from contextlib import ExitStack

from mavwire import _native

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
        return b"FMT," in _native.head_to_utf8(file.read(PROBE))


def _plain(filename: str, until: ExitStack) -> str:
    """The path of a text log, or that of a copy in UTF-8 with line feeds, which is removed by `until`."""
    with open(filename, "rb") as file:
        head = file.read(PROBE)
    if _native.head_to_utf8(head) == head:
        return filename
    import tempfile  # which takes time to load

    made = tempfile.TemporaryDirectory(prefix="mavwire-", ignore_cleanup_errors=True)
    copy = os.path.join(until.enter_context(made), "log")
    _native.decompress(os.fsdecode(filename), copy)
    return copy


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
        with ExitStack() as at_end:
            self._open_log(_plain(filename, at_end), text=True)
            self._at_end = at_end.pop_all()
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

    def close(self) -> None:
        """Close the file, and remove the copy of a log that is not in UTF-8 with line feeds."""
        super().close()
        self._at_end.close()

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
            found = of_bytes.get(line[:KEY_LEN].partition(b",")[0].rstrip(b"\n"))
            if found is not None and line.strip():
                found.append(start)
            start += len(line)
        return offsets

    @property
    def type_list(self) -> list[str] | None:
        """Types that a filtered read visits, None before the first after a rewind."""
        latched = self._latched()
        return None if latched is None else [self._layouts[index].name for index in latched]
