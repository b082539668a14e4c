"""The file behind a telemetry log that is read, and the log as a port, for programs that look at both."""

from __future__ import annotations

import os

from mavwire._native import LogLink

from .mavfile import MARKERS
from .recognise import LENGTH_HEAD, STAMP_LEN, frame_length

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .tlog import mavlogfile

# Bytes of a record that say how long it is.
RECORD_HEAD = STAMP_LEN + LENGTH_HEAD
# The longest record, and as much of the next one as shows that there is one.
RECORD_SPAN = STAMP_LEN + 280 + STAMP_LEN + 1
# How far bytes that are no record are looked through for the next one, in one step.
JUNK_STEP = 4096


class LogPort:
    """A log as a port that has received all of it: MAVProxy reads `--master=flight.tlog` so."""

    def __init__(self, link: mavlogfile) -> None:
        self._link = link

    def inWaiting(self) -> int:
        """Bytes that are left to read; 0 for a log that is written, or closed."""
        file = self._link.f
        return file.waiting() if isinstance(file, LogFile) and not file.closed else 0


class LogFile:
    """The file behind a log that is read: its position is where the next record is looked for."""

    def __init__(self, link: mavlogfile, file: Any) -> None:
        self._link = link
        self._file = file
        # The place of the frame that `read_frame` began to read.
        self._frame = range(0)
        # The place of bytes that belong to no record, as far as they were looked through.
        self._junk = range(0)
        # They go to the end of the file, where a record may begin whose rest is still to be written.
        self._is_last = False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)

    def tell(self) -> int:
        """Position in the file."""
        return self._link._tell()

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Continue reading at `offset`. The rest of a begun frame is dropped."""
        if whence == os.SEEK_CUR:
            offset += self.tell()
        elif whence == os.SEEK_END:
            offset += self._file.seek(0, os.SEEK_END)
        self._link._seek(offset)
        return offset

    def read(self, size: int = -1) -> bytes:
        """Bytes from the position on, which moves behind them."""
        offset = self.tell()
        data = self._peek(offset, size)
        self._link._seek(offset + len(data))
        return data

    def waiting(self) -> int:
        """Bytes that are left; 0 if these are but the beginning of a record."""
        here, link = self.tell(), self._link
        left: int = max(link.filesize - here, 0)
        whole = left >= RECORD_HEAD or not link._stamped or here in self._frame
        return left if whole else 0

    def read_frame(self, size: int | None = None) -> bytes:
        """Up to `size` bytes of the frame in the record at the position, or of its rest.

        Where no record begins, of the bytes up to the next one. Empty at the end of the
        file.
        """
        here = self.tell()
        if here in self._junk and not self._is_overtaken():
            return self._read_junk(here, size)
        frame = self._frame
        if here not in frame:
            head = self._peek(here, RECORD_HEAD)
            if len(head) < RECORD_HEAD:
                return b""
            length = frame_length(head[STAMP_LEN:])
            if not length:
                self._junk = range(here, here + self._junk_at(here))
                return self._read_junk(here, size)
            self._link._seek(here)  # another record, whether or not the last one was taken in
            LogLink.pre_message(self._link)
            frame = self._frame = range(here + STAMP_LEN, here + STAMP_LEN + length)
        left = frame.stop - self.tell()
        if left < 1:  # another thread has read messages meanwhile
            return self.read_frame(size)
        return LogLink.recv(self._link, left if size is None else min(size, left))

    def _is_overtaken(self) -> bool:
        """Whether the file has grown behind what was looked through to its end."""
        return self._is_last and bool(self._peek(self._junk.stop, 1))

    def _read_junk(self, here: int, size: int | None) -> bytes:
        left = self._junk.stop - here
        return self.read(left if size is None else min(size, left))

    def _junk_at(self, offset: int) -> int:
        """Bytes from `offset`, where no record begins, to the next one: one or more.

        A frame whose time stamp is not whole belongs to them.
        """
        ahead = self._peek(offset, JUNK_STEP)
        ended = len(ahead) < JUNK_STEP
        self._is_last = False
        looked = len(ahead) - (LENGTH_HEAD if ended else RECORD_SPAN)
        for start in range(looked):
            if ahead[start] in MARKERS and 0 < (end := frame_end(ahead, start)) <= len(ahead):
                return start - STAMP_LEN if start > STAMP_LEN else end
        self._is_last = ended
        return len(ahead) if ended else looked

    def _peek(self, offset: int, size: int) -> bytes:
        self._file.seek(offset)
        data: bytes = self._file.read(size)
        return data


def frame_end(data: bytes, start: int) -> int:
    """Where the frame at `start` ends, 0 if none begins there or something else than a record
    follows it. Bytes that are not there any more count as a record.
    """
    length = frame_length(data[start:])
    following = start + length + STAMP_LEN
    is_frame = length and (following >= len(data) or data[following] in MARKERS)
    return start + length if is_frame else 0
