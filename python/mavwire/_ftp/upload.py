"""Writing a file: several blocks on their way at once, each sent until it is acknowledged."""

from __future__ import annotations

import time
from typing import IO, Any

from mavwire.mavftp_op import FTP_OP, OP_Ack, OP_CreateFile, OP_WriteFile

from . import MAX_PAYLOAD
from .channel import Channel, Pending, answers, decode_result
from .result import FtpError, MAVFTPReturn

MAX_RETRIES = 20


class Upload:
    """The bytes of `source` go to one remote file.

    `step` and `on_reply` return None while it goes on, and the result once it has ended.
    """

    def __init__(self, channel: Channel, path: bytes, source: IO[bytes]) -> None:
        self.channel = channel
        self.source = source
        self.size = source.seek(0, 2)
        self.block = min(max(channel.settings.write_size, 1), MAX_PAYLOAD)
        self.offset = 0
        self.acknowledged = 0
        self.moved = 0  # changes whenever the transfer comes nearer to its end
        self.retries = 0
        self.begun = time.monotonic()
        self.writes: dict[int, Pending] = {}
        self.create: Pending | None = Pending(channel, channel.request(OP_CreateFile, path))

    @property
    def opened(self) -> bool:
        """Whether there is a session to close."""
        return self.create is None

    def step(self) -> MAVFTPReturn | None:
        """Send again what was not answered in time."""
        settings = self.channel.settings
        if self.create is not None:
            if self.create.resend_after(settings.read_retry_time):
                self.retries += 1
            return None
        for write in self.writes.values():
            if write.retries >= MAX_RETRIES:
                return MAVFTPReturn("WriteFile", FtpError.RemoteReplyTimeout)
            if write.resend_after(settings.retry_time):
                self.retries += 1
        return None

    def on_reply(self, op: FTP_OP) -> MAVFTPReturn | None:
        """Take in a packet; what belongs to something else is ignored."""
        if self.create is not None:
            return self._on_create(op) if answers(op, self.create.op) else None
        write = self.writes.get((op.seq - 1) & 0xFFFF)
        if write is None or not answers(op, write.op):
            return None
        if op.opcode != OP_Ack:
            return decode_result(op)
        del self.writes[write.op.seq]
        self.acknowledged += write.op.size
        self.moved += 1
        return self._go_on("WriteFile")

    def _on_create(self, op: FTP_OP) -> MAVFTPReturn | None:
        if op.opcode != OP_Ack:
            return decode_result(op)
        self.create = None
        self.channel.session = op.session  # the vehicle may have chosen another
        return self._go_on("CreateFile")

    def _go_on(self, name: str) -> MAVFTPReturn | None:
        """The result once all is acknowledged; else send more."""
        while self.offset < self.size and len(self.writes) < max(
            self.channel.settings.write_qsize, 1
        ):
            self.source.seek(self.offset)
            data = self.source.read(min(self.block, self.size - self.offset))
            if not data:  # the file has become shorter
                self.size = self.offset
                break
            op = self.channel.request(OP_WriteFile, data, offset=self.offset)
            self.writes[op.seq] = Pending(self.channel, op)
            self.offset += len(data)
        if self.writes or self.offset < self.size:
            return None
        return MAVFTPReturn(name, FtpError.Success)

    @property
    def fraction(self) -> float:
        """How many of the blocks are there, from 0 to 1."""
        blocks = -(-self.size // self.block)
        return self.moved / blocks if blocks else 1.0

    def status(self) -> tuple[Any, ...]:
        """Offset, gaps, retries and speed in kByte/s, for a line of text."""
        seconds = max(time.monotonic() - self.begun, 1e-6)
        speed = self.acknowledged / seconds / 1024
        return self.offset, 0, self.retries, speed
