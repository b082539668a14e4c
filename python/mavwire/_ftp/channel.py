"""Requests and answers: one FILE_TRANSFER_PROTOCOL message each way, matched by their numbers."""

from __future__ import annotations

import random
import time
from typing import Any

from mavwire.mavftp_op import FTP_OP, OP_Ack, OP_Nack

from . import HEADER, MAX_PAYLOAD, log
from .result import LAST_REMOTE_ERROR, FtpError, MAVFTPReturn
from .settings import MAVFTPSettings

# Opcode of a request -> how results name it.
OPERATIONS = dict(
    enumerate(
        """None TerminateSession ResetSessions ListDirectory OpenFileRO ReadFile CreateFile WriteFile
        RemoveFile CreateDirectory RemoveDirectory OpenFileWO TruncateFile Rename CalcFileCRC32
        BurstReadFile""".split()
    )
)


class Channel:
    """The way to one vehicle. `seq` is the number of the next request, `session` the open file's."""

    def __init__(self, master: Any, system: int, component: int, settings: MAVFTPSettings) -> None:
        self.master = master
        self.target = system, component
        self.settings = settings
        self.network = 0
        self.seq = 0
        self.session = 0

    def request(
        self, opcode: int, data: bytes = b"", size: int | None = None, offset: int = 0
    ) -> FTP_OP:
        """Send a new request; `size` is that of the data, or what is asked for."""
        size = len(data) if size is None else size
        op = FTP_OP(self.seq, self.session, opcode, size, 0, 0, offset, data)
        self.send(op)
        return op

    def send(self, op: FTP_OP) -> None:
        """Send a request, the first time or again: the same number gets the same answer."""
        self.seq = (op.seq + 1) & 0xFFFF
        if self.settings.debug > 0:
            log.info("FTP: > %s", op)
        if random.randrange(100) < self.settings.pkt_loss_tx:
            return
        self.master.mav.file_transfer_protocol_send(self.network, *self.target, padded(op))

    def receive(self, timeout: float) -> FTP_OP | None:
        """The next packet of the vehicle, waiting at most `timeout` seconds."""
        msg = self.master.recv_match(
            type=["FILE_TRANSFER_PROTOCOL"], blocking=True, timeout=max(timeout, 0.0)
        )
        if msg is None or not self.is_for_us(msg):
            return None
        op = parse(msg)
        if op is None or random.randrange(100) < self.settings.pkt_loss_rx:
            return None
        if self.settings.debug > 0:
            log.info("FTP: < %s", op)
        return op

    def is_for_us(self, msg: Any) -> bool:
        """Whether the vehicle sent it, and not to another station."""
        system, component = self.target
        if msg.get_srcSystem() != system or component not in (0, msg.get_srcComponent()):
            return False
        own = getattr(self.master, "source_system", 0)
        return own == 0 or msg.target_system in (0, own)


def padded(op: FTP_OP) -> bytes:
    """A packet as FILE_TRANSFER_PROTOCOL carries it."""
    return bytes(op.pack()).ljust(HEADER.size + MAX_PAYLOAD, b"\0")


def unpacked(payload: bytes) -> FTP_OP:
    """The packet in the payload of a message, without its padding."""
    seq, session, opcode, size, request, complete, _, offset = HEADER.unpack_from(payload)
    data = payload[HEADER.size : HEADER.size + size]
    return FTP_OP(seq, session, opcode, size, request, complete, offset, data)


def parse(msg: Any) -> FTP_OP | None:
    """The packet in a message; None for a payload that is too short, or a size that is too large."""
    payload = bytes(msg.payload)
    op = unpacked(payload) if len(payload) >= HEADER.size else None
    return op if op is not None and op.size <= MAX_PAYLOAD else None


def answers(op: FTP_OP, request: FTP_OP) -> bool:
    """Whether a packet is the answer to a request."""
    return (
        op.opcode in (OP_Ack, OP_Nack)
        and op.req_opcode == request.opcode
        and op.seq == (request.seq + 1) & 0xFFFF
    )


def decode_result(op: FTP_OP, operation_name: str = "") -> MAVFTPReturn:
    """The result of an operation by its answer."""
    name = operation_name or OPERATIONS.get(op.req_opcode, "Unknown")
    payload = bytes(op.payload) if op.payload else b""
    details: dict[str, Any] = {
        "invalid_opcode": op.opcode, "invalid_payload_size": len(payload)
    }  # fmt: skip
    if op.opcode == OP_Ack:
        return MAVFTPReturn(name, FtpError.Success, **details)
    if op.opcode != OP_Nack:
        return MAVFTPReturn(name, FtpError.InvalidOpcode, **details)
    error = _nack_error(payload)
    if error == FtpError.FailErrno:
        details["system_error"] = payload[1]
    elif error == FtpError.InvalidErrorCode:
        details["invalid_error_code"] = payload[0]
    return MAVFTPReturn(name, error, **details)


def _nack_error(payload: bytes) -> FtpError:
    if not payload:
        return FtpError.NoErrorCodeInPayload
    code = payload[0]
    if len(payload) > (2 if code == FtpError.FailErrno else 1):
        return FtpError.PayloadTooLarge
    if code == FtpError.Success:
        return FtpError.NoErrorCodeInNack
    if code == FtpError.FailErrno and len(payload) == 1:
        return FtpError.NoFilesystemErrorInPayload
    if code > LAST_REMOTE_ERROR:
        return FtpError.InvalidErrorCode
    return FtpError(code)


class Pending:
    """A request that waits for its answer, and is sent again when that takes long."""

    def __init__(self, channel: Channel, op: FTP_OP) -> None:
        self.channel = channel
        self.op = op
        self.sent = time.monotonic()
        self.retries = 0

    def resend_after(self, seconds: float) -> bool:
        """Send it again if `seconds` have passed since the last time; whether that was done."""
        now = time.monotonic()
        if now - self.sent < seconds:
            return False
        # The number of a new request stays behind the others that are on their way.
        following = self.channel.seq
        self.channel.send(self.op)
        self.channel.seq = following
        self.sent = now
        self.retries += 1
        return True
