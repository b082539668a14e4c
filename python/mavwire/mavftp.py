"""The file transfer protocol, client side: pymavlink's `mavftp`.

```python
ftp = mavftp.MAVFTP(link, link.target_system, link.target_component)
ftp.cmd_get(["/APM/LOGS/00000001.BIN", "flight.bin"])
ftp.process_ftp_reply("get").display_message()
```

`python -m mavwire.mavftp --device DEVICE {get,put,list,...}` does it from a shell.
"""

from __future__ import annotations

import sys

from ._ftp import HEADER, MAX_PAYLOAD
from ._ftp.cli import (
    auto_connect,
    auto_detect_serial,
    create_argument_parser,
    main,
    wait_heartbeat,
)
from ._ftp.client import MAVFTP
from ._ftp.download import BURST_REPLY_SEQUENCE_WINDOW, MAX_READ_GAPS
from ._ftp.params import ParamData
from ._ftp.result import DirectoryEntry, FtpError, MAVFTPReturn
from ._ftp.settings import MAVFTPSetting, MAVFTPSettings
from ._hooks import IN_STANDARD_MODULE, ReplaceableModule, make_replaceable
from .mavftp_op import *


class _Mavftp(ReplaceableModule):
    _users = ("mavwire._ftp",)
    _not_called = {  # noqa: RUF012
        **dict.fromkeys(
            "datetime logging math os random struct sys tempfile time".split(), IN_STANDARD_MODULE
        ),
        "mavutil": "replace the function in mavwire.mavutil itself",
    }


make_replaceable(sys.modules[__name__], _Mavftp)

HDR_Len = HEADER.size
MAX_Payload = MAX_PAYLOAD

__all__ = [
    "BURST_REPLY_SEQUENCE_WINDOW",
    "FTP_OP",
    "MAVFTP",
    "MAX_READ_GAPS",
    "DirectoryEntry",
    "FtpError",
    "HDR_Len",
    "MAVFTPReturn",
    "MAVFTPSetting",
    "MAVFTPSettings",
    "MAX_Payload",
    "OP_Ack",
    "OP_BurstReadFile",
    "OP_CalcFileCRC32",
    "OP_CreateDirectory",
    "OP_CreateFile",
    "OP_ListDirectory",
    "OP_Nack",
    "OP_None",
    "OP_OpenFileRO",
    "OP_OpenFileWO",
    "OP_ReadFile",
    "OP_RemoveDirectory",
    "OP_RemoveFile",
    "OP_Rename",
    "OP_ResetSessions",
    "OP_TerminateSession",
    "OP_TruncateFile",
    "OP_WriteFile",
    "ParamData",
    "WriteQueue",
    "auto_connect",
    "auto_detect_serial",
    "create_argument_parser",
    "main",
    "wait_heartbeat",
]


class WriteQueue:
    """A block of a file that is being written: where it is, and when it was sent last."""

    def __init__(self, ofs: int, size: int) -> None:
        self.ofs = ofs
        self.size = size
        self.last_send: float = 0


if __name__ == "__main__":
    main()
