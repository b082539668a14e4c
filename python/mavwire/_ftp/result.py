"""How an operation ended, and what a directory holds."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from enum import IntEnum

from . import log


class FtpError(IntEnum):
    """Why an operation failed: MAV_FTP_ERR up to 10, then what the client itself found."""

    Success = 0
    Fail = 1
    FailErrno = 2
    InvalidDataSize = 3
    InvalidSession = 4
    NoSessionsAvailable = 5
    EndOfFile = 6
    UnknownCommand = 7
    FileExists = 8
    FileProtected = 9
    FileNotFound = 10
    NoErrorCodeInPayload = 64
    NoErrorCodeInNack = 65
    NoFilesystemErrorInPayload = 66
    InvalidErrorCode = 67
    PayloadTooLarge = 68
    InvalidOpcode = 69
    InvalidArguments = 70
    PutAlreadyInProgress = 71
    FailToOpenLocalFile = 72
    RemoteReplyTimeout = 73


# The last error of the other end. The errors below are the client's own.
LAST_REMOTE_ERROR = FtpError.FileNotFound

_TEXTS = {
    FtpError.Fail: "generic error",
    FtpError.FailErrno: "system error {system_error}",
    FtpError.InvalidDataSize: "invalid data size",
    FtpError.InvalidSession: "session is not currently open",
    FtpError.NoSessionsAvailable: "no sessions available",
    FtpError.EndOfFile: "offset past end of file",
    FtpError.UnknownCommand: "unknown command",
    FtpError.FileExists: "file/directory already exists",
    FtpError.FileProtected: "file/directory is protected",
    FtpError.FileNotFound: "file/directory not found",
    FtpError.NoErrorCodeInPayload: "payload contains no error code",
    FtpError.NoErrorCodeInNack: "no error code",
    FtpError.NoFilesystemErrorInPayload: "file-system error missing in payload",
    FtpError.InvalidErrorCode: "invalid error code {invalid_error_code}",
    FtpError.PayloadTooLarge: "payload is too long {invalid_payload_size}",
    FtpError.InvalidOpcode: "invalid opcode {invalid_opcode}",
    FtpError.InvalidArguments: "invalid arguments",
    FtpError.PutAlreadyInProgress: "put already in progress",
    FtpError.FailToOpenLocalFile: "failed to open local file",
    FtpError.RemoteReplyTimeout: "remote reply timeout",
}
_WARNINGS = frozenset((FtpError.FileExists, FtpError.FileProtected, FtpError.FileNotFound))


@dataclass
class DirectoryEntry:
    """A file or a directory; `size_b` is in bytes."""

    name: str
    is_dir: bool
    size_b: int


@dataclass(eq=False, repr=False)
class MAVFTPReturn:
    """How an operation ended: `error_code` is an FtpError, 0 when all went well."""

    operation_name: str
    error_code: int
    system_error: int = 0
    invalid_error_code: int = 0
    invalid_opcode: int = 0
    invalid_payload_size: int = 0
    directory_listing: list[DirectoryEntry] | None = None

    def __repr__(self) -> str:
        return f"MAVFTPReturn({self.operation_name!r}, {self.error_code!r})"

    @property
    def return_code(self) -> int:
        """The error code."""
        return self.error_code

    def display_message(self) -> None:
        """Log how the operation ended, and what of a directory was listed, be it before an error."""
        name, code = self.operation_name, self.error_code
        if code == FtpError.Success:
            log.info("%s succeeded", name)
        elif code in _TEXTS:
            level = logging.WARNING if code in _WARNINGS else logging.ERROR
            log.log(level, "%s failed, %s", name, _TEXTS[FtpError(code)].format_map(vars(self)))
        else:
            log.error("%s failed, unknown error %u in display_message()", name, code)
        if self.directory_listing:
            self._display_listing(self.directory_listing)

    def _display_listing(self, entries: list[DirectoryEntry]) -> None:
        for entry in entries:
            if entry.is_dir:
                log.info("   %s/", entry.name)
            else:
                log.info("   %s\t%u", entry.name, entry.size_b)
        total = sum(entry.size_b for entry in entries)
        log.info("Total size %.2f kByte", total / 1024)
