"""One packet of the file transfer protocol: pymavlink's `mavftp_op`."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

from ._ftp import HEADER as _HEADER

OP_None = 0
OP_TerminateSession = 1
OP_ResetSessions = 2
OP_ListDirectory = 3
OP_OpenFileRO = 4
OP_ReadFile = 5
OP_CreateFile = 6
OP_WriteFile = 7
OP_RemoveFile = 8
OP_CreateDirectory = 9
OP_RemoveDirectory = 10
OP_OpenFileWO = 11
OP_TruncateFile = 12
OP_Rename = 13
OP_CalcFileCRC32 = 14
OP_BurstReadFile = 15
OP_Ack = 128
OP_Nack = 129


@dataclass(eq=False, repr=False)
class FTP_OP:
    """A packet: its header and, in `payload`, the data behind it."""

    seq: int
    session: int
    opcode: int
    size: int
    req_opcode: int
    burst_complete: int
    offset: int
    payload: bytes | bytearray | None = None

    def pack(self) -> bytearray:
        """The packet as bytes, without padding."""
        packed = bytearray(
            _HEADER.pack(
                self.seq, self.session, self.opcode, self.size,
                self.req_opcode, self.burst_complete, 0, self.offset,
            )
        )  # fmt: skip
        return packed + self.payload if self.payload is not None else packed

    def __str__(self) -> str:
        plen = len(self.payload) if self.payload is not None else 0
        text = (
            f"OP seq:{self.seq} sess:{self.session} opcode:{self.opcode}"
            f" req_opcode:{self.req_opcode} size:{self.size}"
            f" bc:{self.burst_complete} ofs:{self.offset} plen={plen}"
        )
        return f"{text} [{self.payload[0]}]" if self.payload else text

    def items(self) -> Generator[tuple[str, Any], None, None]:
        """Names and values."""
        yield from vars(self).items()
