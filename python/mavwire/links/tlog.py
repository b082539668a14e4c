"""Telemetry logs read and written record by record: `mavlogfile`.

A record is an 8-byte big-endian time in microseconds since 1970, whose low two bits are a link
number, and one frame. What is broken, cut off or not a log at all comes out as BAD_DATA or not at
all; a file that is still growing is followed without losing the record that was half written.
"""

from __future__ import annotations

import os
import time

from mavwire._native import LogLink

from .mavfile import link_dict, mavfile
from .recording import open_recording

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# A record header of the planner format, which no program writes any more.
PLANNER_TIME_LEN = 21


class mavlogfile(LogLink, mavfile):
    """A log file as a link. Opened to be written (`write`), it takes whole records.

    `notimestamps`: a raw stream without record headers; messages are stamped with `uptime`.
    `robust_parsing` is accepted and has no effect: damage is always BAD_DATA.
    """

    __dict__ = link_dict
    _own_attributes: tuple[str, ...] = ("percent", "_last_message", "_last_timestamp", "_link")

    # A log that is read ignores what is sent to it, so that programs can replay through it.
    discarded_writes = 0
    discarded_bytes = 0
    # The class whose methods the native quick paths stand for; a subclass that replaces one of
    # them is read through mavfile's own loop.
    _quick_class: type

    def __init__(
        self,
        filename: str,
        planner_format: bool | None = None,
        write: bool = False,
        append: bool = False,
        robust_parsing: bool = True,
        notimestamps: bool = False,
        source_system: int = 255,
        source_component: int = 0,
        use_native: bool = False,
    ) -> None:
        self.filename = filename
        self.writeable = write
        self.robust_parsing = robust_parsing
        self.planner_format = planner_format
        self.f: Any = (
            open_recording(filename, "ab" if append else "wb") if write else open(filename, "rb")
        )
        self.filesize = os.path.getsize(filename)
        super().__init__(
            None, filename, source_system=source_system, source_component=source_component,
            notimestamps=notimestamps, use_native=use_native,
        )  # fmt: skip
        self.stop_on_EOF = True
        self._timestamp = 0 if notimestamps else time.time()
        if not write and not planner_format:
            self._open_reader(filename, not notimestamps, time.time())
            self.f = LogFile(self, self.f)

    _recv_msg_slowly = mavfile.recv_msg
    _recv_match_slowly = mavfile.recv_match

    def _condition_holds(self, condition: str, msg: Any) -> Any:
        return self._matches(msg, None, condition)

    @property
    def port(self) -> LogPort:
        """What programs ask that look after links without a descriptor in turn."""
        return LogPort(self)

    def close(self) -> None:
        """Close the file."""
        self._close_reader()
        self.f.close()
        self._flush_logs_now()

    def write(self, buf: bytes) -> None:
        """Append a record, timestamp included; a log opened to be read discards and counts it."""
        if self.writeable:
            self.f.write(buf)
        else:
            self.discarded_writes += 1
            self.discarded_bytes += len(buf)

    def pre_message(self) -> None:
        """Read the timestamp of the record that begins at the file's position."""
        if self.planner_format:
            raise RuntimeError(f"bad planner timestamp {self.f.read(PLANNER_TIME_LEN)!r}")
        LogLink.pre_message(self)


class LogPort:
    """A log as a port that has received all of it: MAVProxy reads `--master=flight.tlog` so."""

    def __init__(self, link: mavlogfile) -> None:
        self._link = link

    def inWaiting(self) -> int:
        """Bytes that are left to read; 0 for a log that is written, or closed."""
        link = self._link
        return 0 if link.writeable or link.f.closed else max(link.filesize - link.f.tell(), 0)


class LogFile:
    """The file behind a log that is read: its position is where the next record is looked for."""

    def __init__(self, link: mavlogfile, file: Any) -> None:
        self._link = link
        self._file = file

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)

    def tell(self) -> int:
        """Position in the file."""
        return self._link._tell()

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Continue reading at `offset`; whatever was begun is dropped."""
        if whence == os.SEEK_CUR:
            offset += self.tell()
        elif whence == os.SEEK_END:
            offset += self._file.seek(0, os.SEEK_END)
        self._link._seek(offset)
        return offset

    def read(self, size: int = -1) -> bytes:
        """Bytes from the position on, which moves behind them."""
        offset = self.tell()
        self._file.seek(offset)
        data: bytes = self._file.read(size)
        self._link._seek(offset + len(data))
        return data


mavlogfile._quick_class = mavlogfile
