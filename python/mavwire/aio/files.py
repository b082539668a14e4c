"""Files of a vehicle, read over MAVFTP."""

from __future__ import annotations

import asyncio
import io
from typing import TYPE_CHECKING, Any

from mavwire._ftp.channel import Channel, parse
from mavwire._ftp.commands import encode
from mavwire._ftp.download import Download
from mavwire._ftp.result import FtpError
from mavwire._ftp.settings import DEFAULTS, MAVFTPSettings
from mavwire.mavftp_op import OP_TerminateSession

from .deadline import deadline_after
from .filters import message_filter

if TYPE_CHECKING:
    from .vehicle import Vehicle

# Seconds between looks for requests without an answer.
STEP = 0.1


async def read_file(
    link: Vehicle, path: str, target: tuple[int, int], limit: int, timeout: float
) -> bytes:
    """The content of a remote file. TimeoutError where nothing comes for `timeout` seconds; OSError."""
    channel = Channel(link.sync, *target, MAVFTPSettings(DEFAULTS))
    reader = link._feed.reader(message_filter(link.sync, "FILE_TRANSFER_PROTOCOL", None, target[0]))
    content = io.BytesIO()
    transfer = Download(channel, encode(path), content, limit=limit)
    loop = asyncio.get_running_loop()
    moved: tuple[bool, int] | None = None
    last = loop.time()
    try:
        while True:
            message = await reader.next(deadline_after(loop, STEP))
            result = _hear(transfer, channel, message) or transfer.step()
            if result is not None:
                break
            if (transfer.opened, transfer.moved) != moved:
                moved, last = (transfer.opened, transfer.moved), loop.time()
            if loop.time() - last > timeout:
                raise TimeoutError(f"{path}: no answer of system {target[0]} within {timeout} s")
    finally:
        if transfer.opened:
            channel.request(OP_TerminateSession)
    if result.error_code != FtpError.Success:
        raise OSError(f"{path}: system {target[0]} answers {FtpError(result.error_code).name}")
    return content.getvalue()


def _hear(transfer: Download, channel: Channel, message: Any) -> Any:
    op = parse(message) if message is not None and channel.is_for_us(message) else None
    return None if op is None else transfer.on_reply(op)
