"""Reading a file: bursts, and single reads for the pieces that a burst lost.

A burst sends block after block without being asked again. Gaps between blocks are kept as a list of
gaps of at most one block, and asked for on their own; a tail that is missing is asked for with
the next burst. The size that the vehicle names may be a guess: the end is where a read on its own
finds it.
"""

from __future__ import annotations

import struct
import time
from typing import IO, Any

from mavwire.mavftp_op import FTP_OP, OP_Ack, OP_BurstReadFile, OP_OpenFileRO, OP_ReadFile

from . import MAX_PAYLOAD
from .channel import Channel, Pending, answers, decode_result
from .result import FtpError, MAVFTPReturn

MAX_READ_GAPS = 4096
BURST_REPLY_SEQUENCE_WINDOW = 4096
MAX_RETRIES = 10
_SIZE = struct.Struct("<I")


class Download:
    """The bytes of one remote file, or `wanted` of them from `start`, go to `sink`.

    More than `limit` bytes are an error.

    `step` and `on_reply` return None while it goes on, and the result once it has ended.
    """

    def __init__(
        self,
        channel: Channel,
        path: bytes,
        sink: IO[bytes],
        start: int = 0,
        wanted: int | None = None,
        limit: int | None = None,
    ) -> None:
        self.channel = channel
        self.sink = sink
        self.limit = limit
        self.start = start
        self.stop = None if wanted is None else start + wanted
        self.block = min(max(channel.settings.burst_read_size, 1), MAX_PAYLOAD)
        self.remote_size = 0
        self.offset = start  # the end of what has arrived; what is missing before it are gaps
        self.gaps: dict[int, int] = {}
        self.reads: dict[int, Pending] = {}
        self.at_end = False
        self.retries = 0
        self.received = 0
        self.begun = time.monotonic()
        self.open: Pending | None = Pending(channel, channel.request(OP_OpenFileRO, path))
        self.burst: Pending | None = None
        self._burst_seq = 0

    @property
    def opened(self) -> bool:
        """Whether there is a session to close."""
        return self.open is None

    @property
    def moved(self) -> int:
        """Changes whenever the transfer comes nearer to its end."""
        return self.received

    # -- time

    def step(self) -> MAVFTPReturn | None:
        """Send again what was not answered in time."""
        settings = self.channel.settings
        if self.open is not None:
            if self.open.resend_after(settings.read_retry_time):
                self.retries += 1
            return None
        if self.burst is not None and time.monotonic() - self.burst.sent >= settings.retry_time:
            if self.burst.retries >= MAX_RETRIES:
                return MAVFTPReturn("BurstReadFile", FtpError.RemoteReplyTimeout)
            self._request_burst(self.burst.retries + 1)
        for read in self.reads.values():
            if read.retries >= MAX_RETRIES:
                return MAVFTPReturn("ReadFile", FtpError.RemoteReplyTimeout)
            if read.resend_after(settings.retry_time):
                self.retries += 1
        self._request_gaps()
        return None

    def _request_burst(self, retries: int = 0) -> None:
        """Ask for everything from the end of what has arrived."""
        op = self.channel.request(OP_BurstReadFile, b"", self.block, self.offset)
        self.burst = Pending(self.channel, op)
        self.burst.retries = retries
        self.retries += bool(retries)
        self._burst_seq = op.seq

    def _request_gaps(self) -> None:
        """Ask for pieces that are missing, so many at once as the settings allow."""
        free = max(self.channel.settings.max_backlog, 1) - len(self.reads)
        if free <= 0 or len(self.gaps) == len(self.reads):
            return
        for offset, size in self.gaps.items():
            if free <= 0:
                break
            if offset not in self.reads:
                op = self.channel.request(OP_ReadFile, b"", size, offset)
                self.reads[offset] = Pending(self.channel, op)
                free -= 1

    # -- answers

    def on_reply(self, op: FTP_OP) -> MAVFTPReturn | None:
        """Take in a packet; what belongs to something else is ignored."""
        if self.open is not None:
            return self._on_open(op) if answers(op, self.open.op) else None
        if op.session != self.channel.session:
            return None
        if op.req_opcode == OP_BurstReadFile:
            return self._on_burst(op)
        if op.req_opcode == OP_ReadFile:
            return self._on_read(op)
        return None

    def _on_open(self, op: FTP_OP) -> MAVFTPReturn | None:
        if op.opcode != OP_Ack:
            return decode_result(op)
        self.open = None
        self.channel.session = op.session  # the vehicle may have chosen another
        payload = bytes(op.payload or b"")
        if len(payload) >= _SIZE.size:
            (self.remote_size,) = _SIZE.unpack_from(payload)
        self._request_burst()
        return None

    def _on_burst(self, op: FTP_OP) -> MAVFTPReturn | None:
        ahead = (op.seq - self._burst_seq) & 0xFFFF
        if self.burst is None or not 0 < ahead < BURST_REPLY_SEQUENCE_WINDOW:
            return None
        if op.opcode != OP_Ack:
            return self._on_burst_end(op)
        data = bytes(op.payload or b"")
        if not data:
            return None
        if self.limit is not None and op.offset + len(data) - self.start > self.limit:
            return MAVFTPReturn("BurstReadFile", FtpError.InvalidDataSize)
        if not self._take(op.offset, data):
            return None
        self._burst_seq = op.seq
        self.channel.seq = (op.seq + 1) & 0xFFFF
        self.burst.sent, self.burst.retries = time.monotonic(), 0
        if op.burst_complete:
            self.burst = None
        return self._go_on("BurstReadFile")

    def _on_burst_end(self, op: FTP_OP) -> MAVFTPReturn | None:
        """A burst that was refused, or has come to the end of the file."""
        result = decode_result(op)
        if result.error_code != FtpError.EndOfFile:
            return result
        lost = (op.seq - self._burst_seq) & 0xFFFF != 1
        self._burst_seq = op.seq
        self.channel.seq = (op.seq + 1) & 0xFFFF
        self.burst = None
        if self.offset >= self.remote_size and not lost:
            self.at_end = True
        elif len(self.gaps) >= MAX_READ_GAPS:  # it only ever says that there is more
            return result
        else:  # the last blocks were lost, or the size was a guess: one read tells
            self.gaps[self.offset] = self.block
            self.offset += self.block
        return self._go_on("BurstReadFile")

    def _on_read(self, op: FTP_OP) -> MAVFTPReturn | None:
        found = next((at for at, read in self.reads.items() if answers(op, read.op)), None)
        if found is None:
            return None
        del self.reads[found]
        if op.opcode == OP_Ack and op.offset == found and op.payload:
            self._take(found, bytes(op.payload))
        elif op.opcode != OP_Ack:
            result = decode_result(op)
            if result.error_code != FtpError.EndOfFile:
                return result
            self._end_at(found)
        return self._go_on("ReadFile")

    def _end_at(self, offset: int) -> None:
        """The file ends here: nothing behind it is missing."""
        self.at_end = True
        self.gaps = {at: size for at, size in self.gaps.items() if at < offset}
        self.reads = {at: read for at, read in self.reads.items() if at < offset}

    # -- data

    def _take(self, offset: int, data: bytes) -> bool:
        """Keep a block; False when too much would be missing before it."""
        if offset < self.offset:
            self._fill(offset, data)
            return True
        end = offset if self.stop is None else min(offset, self.stop)
        missing = range(self.offset, end, self.block)
        if len(self.gaps) + len(missing) > MAX_READ_GAPS:
            return False
        for at in missing:
            self.gaps[at] = min(self.block, end - at)
        self._write(offset, data)
        self.offset = offset + len(data)
        return True

    def _fill(self, offset: int, data: bytes) -> None:
        """Put a block into its gap; what is no gap was there before."""
        size = self.gaps.pop(offset, 0)
        self.reads.pop(offset, None)
        if size:
            self._write(offset, data[:size])
            if len(data) < size:
                self.gaps[offset + len(data)] = size - len(data)

    def _write(self, offset: int, data: bytes) -> None:
        if self.stop is not None:
            data = data[: max(self.stop - offset, 0)]
        self.sink.seek(offset - self.start)
        self.sink.write(data)
        self.received += len(data)

    def _complete(self) -> bool:
        if self.stop is not None and self.offset >= self.stop:
            return True
        return self.at_end or 0 < self.remote_size <= self.offset

    def _go_on(self, name: str) -> MAVFTPReturn | None:
        """The result once all is there; else ask for what is missing."""
        if self._complete():
            self.burst = None
            if not self.gaps:
                return MAVFTPReturn(name, FtpError.Success)
        elif self.burst is None:
            self._request_burst()
        self._request_gaps()
        return None

    @property
    def fraction(self) -> float:
        """How much of the file is there, from 0 to 1."""
        total = self.remote_size if self.stop is None else self.stop - self.start
        return min(self.received / total, 1.0) if total else 1.0

    def status(self) -> tuple[Any, ...]:
        """Offset, gaps, retries and speed in kByte/s, for a line of text."""
        seconds = max(time.monotonic() - self.begun, 1e-6)
        return self.offset, len(self.gaps), self.retries, self.received / seconds / 1024
