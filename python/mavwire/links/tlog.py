"""Telemetry logs read and written record by record: `mavlogfile`.

A record is an 8-byte big-endian time in microseconds since 1970, whose low two bits are a link
number, and one frame. Damaged bytes, cut records or no log at all come out as BAD_DATA or not at
all; a file that is still growing is followed without losing the record that was half written.
"""

from __future__ import annotations

import os
import time

from mavwire._hooks import quick_methods, warn_not_called
from mavwire._native import LogLink

from . import Any
from .log_file import LogFile, LogPort
from .mavfile import link_dict, mavfile

# A record header of the planner format, which no program writes any more.
PLANNER_TIME_LEN = 21


class mavlogfile(LogLink, mavfile):
    """A log file as a link. Opened to be written (`write`), it takes whole records.

    `notimestamps`: a raw stream without record headers; messages are stamped with `uptime`. Set to
    False later, they have the times of the stream's clock; see `mavlink_connection`.
    `robust_parsing` is accepted and has no effect: damage is always BAD_DATA.
    """

    __dict__ = link_dict
    _own_attributes: tuple[str, ...] = ("percent", "_last_message", "_last_timestamp", "_link")

    # A log that is read ignores what is sent to it, so that programs can replay through it.
    discarded_writes = 0
    discarded_bytes = 0
    # Methods that native code skips, with their originals.
    _quick_methods: list[tuple[type | None, str, Any]]

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
        self.f: Any = open(filename, "ab" if append else "wb") if write else open(filename, "rb")
        self.filesize = os.path.getsize(filename)
        super().__init__(
            None, filename, source_system=source_system, source_component=source_component,
            notimestamps=notimestamps, use_native=use_native,
        )  # fmt: skip
        self.stop_on_EOF = True
        self._timestamp = 0 if notimestamps else time.time()
        if type(self).scan_timestamp is not LogLink.scan_timestamp:
            warn_not_called("mavlogfile.scan_timestamp", "change the `_timestamp` of messages")
        if not write and not planner_format:
            self._open_reader(filename, not notimestamps, time.time())
            self.f = LogFile(self, self.f)

    def _delivered(self, msg: Any) -> None:
        self._end_record()
        super()._delivered(msg)

    @property
    def port(self) -> LogPort:
        """The log as a port, for programs that poll links without a descriptor."""
        return LogPort(self)

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes of the log; empty at its end.

        A program that parses by itself gets one record at a time and no time stamp: so this is no
        noise between the frames, and a message has the time of its own record. A read by `recv_msg`, of
        just as much as the parser waits for, gives the bytes of the file unchanged.
        """
        file = self.f
        if n == self.mav.bytes_needed() or not self._stamped or not isinstance(file, LogFile):
            return LogLink.recv(self, n)
        return b"" if file.closed else file.read_frame(n)

    def close(self) -> None:
        """Close the file."""
        self._close_reader()
        self.f.close()

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


mavlogfile._quick_methods = quick_methods(mavlogfile, mavfile)
