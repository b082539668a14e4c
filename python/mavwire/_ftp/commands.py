"""The base of all commands of the client, and the commands that are one request and its answer."""

from __future__ import annotations

import functools
import struct
import time
from collections.abc import Callable
from typing import Any, ParamSpec

from mavwire.mavftp_op import (
    FTP_OP,
    OP_Ack,
    OP_CalcFileCRC32,
    OP_CreateDirectory,
    OP_ListDirectory,
    OP_RemoveDirectory,
    OP_RemoveFile,
    OP_Rename,
    OP_ResetSessions,
)

from . import MAX_PAYLOAD, log
from .channel import OPERATIONS, Channel, Pending, answers, decode_result
from .listing import MAX_ENTRIES, InvalidEntry, parse_entries, split_entries, writable
from .result import DirectoryEntry, FtpError, MAVFTPReturn
from .settings import DEFAULTS, MAVFTPSettings

POLL_SECONDS = 0.1

Args = list[str]

P = ParamSpec("P")


class PathError(ValueError):
    """No request can carry this path."""


def refusing(
    operation: str,
) -> Callable[[Callable[P, MAVFTPReturn]], Callable[P, MAVFTPReturn]]:
    """A command that answers InvalidArguments to paths that are too long."""

    def wrap(command: Callable[P, MAVFTPReturn]) -> Callable[P, MAVFTPReturn]:
        @functools.wraps(command)
        def run(*args: P.args, **kwargs: P.kwargs) -> MAVFTPReturn:
            try:
                return command(*args, **kwargs)
            except PathError as error:
                log.error("FTP: %s: %s", operation, error)
                return MAVFTPReturn(operation, FtpError.InvalidArguments)

        return run

    return wrap


def encode(path: str) -> bytes:
    """A remote path as a request carries it; PathError for one that is too long."""
    data = path.encode("utf-8", "surrogateescape")
    if len(data) > MAX_PAYLOAD:
        raise PathError(f"a path of {len(data)} bytes; a request carries {MAX_PAYLOAD}")
    return data


def usage(name: str, text: str) -> MAVFTPReturn:
    log.error("Usage: %s", text)
    return MAVFTPReturn(name, FtpError.InvalidArguments)


class Commands:
    """The channel to a vehicle, and the commands that return with the answer."""

    def __init__(
        self,
        master: Any,
        target_system: int,
        target_component: int,
        settings: MAVFTPSettings | None = None,
    ) -> None:
        self.ftp_settings = MAVFTPSettings(DEFAULTS) if settings is None else settings
        self.master = master
        self.target_system = target_system
        self.target_component = target_component
        self._channel = Channel(master, target_system, target_component, self.ftp_settings)
        self.list_result: list[DirectoryEntry] = []
        self.crc_result: int | None = None
        self._channel.request(OP_ResetSessions)

    @property
    def seq(self) -> int:
        """The number of the next request."""
        return self._channel.seq

    @property
    def session(self) -> int:
        """The session of the file that is open, or of the next."""
        return self._channel.session

    @refusing("ListDirectory")
    def cmd_list(self, args: Args) -> MAVFTPReturn:
        """List a directory, "/" by default, into `list_result`: directories first."""
        self.list_result = []
        if len(args) > 1:
            return usage("ListDirectory", "list [directory]")
        path = args[0] if args else "/"
        log.info("Listing %s", path)
        found: list[DirectoryEntry] = []
        count = 0
        while count < MAX_ENTRIES:
            op = self._ask(OP_ListDirectory, encode(path), count)
            if op is None:
                return MAVFTPReturn("ListDirectory", FtpError.RemoteReplyTimeout)
            raw = split_entries(bytes(op.payload or b"")) if op.opcode == OP_Ack else []
            result = decode_result(op)
            if not raw and result.error_code not in (FtpError.Success, FtpError.EndOfFile):
                return result
            if not raw:
                break
            try:
                found += parse_entries(raw)
            except InvalidEntry as error:
                log.error("Invalid file entry: F%s", writable(str(error)))
                return MAVFTPReturn("ListDirectory", FtpError.InvalidDataSize)
            count += len(raw)
        self.list_result = sorted(found, key=lambda entry: (not entry.is_dir, entry.name))
        return MAVFTPReturn("ListDirectory", FtpError.Success, directory_listing=self.list_result)

    def cmd_set(self, args: Args) -> MAVFTPReturn:
        """Set a setting: its name and its value."""
        if len(args) != 2:
            return usage("Set", "set PARAMETERNAME PARAMETERVALUE")
        name, value = args
        try:
            setattr(self.ftp_settings, name, value)
        except AttributeError:
            log.error("Invalid parameter name: %s", name)
            return MAVFTPReturn("Set", FtpError.InvalidArguments)
        except (TypeError, ValueError):
            log.error("Invalid parameter value: %s", value)
            return MAVFTPReturn("Set", FtpError.InvalidArguments)
        log.info("Set %s = %s", name, value)
        return MAVFTPReturn("Set", FtpError.Success)

    @refusing("RemoveFile")
    def cmd_rm(self, args: Args) -> MAVFTPReturn:
        """Remove a file."""
        return self._do_to_path(OP_RemoveFile, args, "rm [FILENAME]", "Removing file")

    @refusing("RemoveDirectory")
    def cmd_rmdir(self, args: Args) -> MAVFTPReturn:
        """Remove a directory."""
        text = "rmdir [DIRECTORYNAME]"
        return self._do_to_path(OP_RemoveDirectory, args, text, "Removing directory")

    @refusing("CreateDirectory")
    def cmd_mkdir(self, args: Args) -> MAVFTPReturn:
        """Create a directory."""
        return self._do_to_path(OP_CreateDirectory, args, "mkdir NAME", "Creating directory")

    @refusing("Rename")
    def cmd_rename(self, args: Args) -> MAVFTPReturn:
        """Rename a file or a directory: its old and its new path."""
        if len(args) < 2:
            return usage("Rename", "rename [OLDNAME NEWNAME]")
        old, new = args[:2]
        log.info("Renaming %s to %s", old, new)
        return self._do(OP_Rename, encode(f"{old}\0{new}"))

    @refusing("CalcFileCRC32")
    def cmd_crc(self, args: Args) -> MAVFTPReturn:
        """Have the vehicle compute the CRC-32 of a file; it is logged and kept in `crc_result`."""
        self.crc_result = None
        if len(args) != 1:
            return usage("CalcFileCRC32", "crc [NAME]")
        log.info("Getting CRC for %s", args[0])
        begun = time.monotonic()
        op = self._ask(OP_CalcFileCRC32, encode(args[0]))
        if op is None:
            return MAVFTPReturn("CalcFileCRC32", FtpError.RemoteReplyTimeout)
        if op.opcode == OP_Ack:
            if len(op.payload or b"") != 4:
                return MAVFTPReturn("CalcFileCRC32", FtpError.InvalidDataSize)
            (self.crc_result,) = struct.unpack("<I", bytes(op.payload or b""))
            seconds = time.monotonic() - begun
            log.info("crc: %s 0x%08x in %.1fs", args[0], self.crc_result, seconds)
        return decode_result(op)

    # -- requests with one answer

    def _ask(
        self, opcode: int, data: bytes = b"", offset: int = 0, limit: float | None = None
    ) -> FTP_OP | None:
        """Send a request, again and again, until it is answered; None when it is not."""
        pending = Pending(self._channel, self._channel.request(opcode, data, offset=offset))
        limit = self.ftp_settings.idle_detection_time if limit is None else limit
        deadline = time.monotonic() + limit
        while (left := deadline - time.monotonic()) > 0:
            op = self._channel.receive(min(left, POLL_SECONDS))
            if op is not None and answers(op, pending.op):
                return op
            pending.resend_after(self.ftp_settings.read_retry_time)
        return None

    def _do_to_path(self, opcode: int, args: Args, text: str, doing: str) -> MAVFTPReturn:
        """`_do` with one path; `text` is the usage."""
        if len(args) != 1:
            return usage(OPERATIONS[opcode], text)
        log.info("%s %s", doing, args[0])
        return self._do(opcode, encode(args[0]))

    def _do(self, opcode: int, data: bytes) -> MAVFTPReturn:
        """A request whose answer is only how it ended."""
        op = self._ask(opcode, data)
        if op is None:
            return MAVFTPReturn(OPERATIONS[opcode], FtpError.RemoteReplyTimeout)
        return decode_result(op)

    def _next_session(self) -> None:
        self._channel.session = (self._channel.session + 1) % 256
