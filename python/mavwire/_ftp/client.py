"""The client: one method for each command, and one that waits for a transfer to end."""

from __future__ import annotations

import contextlib
import functools
import struct
import time
from collections.abc import Callable, Iterator
from typing import IO, Any, ParamSpec

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
    OP_TerminateSession,
)

from . import log
from .channel import MAX_PAYLOAD, OPERATIONS, Channel, Pending, answers, decode_result
from .download import Download
from .listing import MAX_ENTRIES, InvalidEntry, parse_entries, split_entries, writable
from .local import Destination, LocalFile, Memory, local_name
from .params import extract_params, ftp_param_decode, missionplanner_sort, save_params
from .result import DirectoryEntry, FtpError, MAVFTPReturn
from .settings import DEFAULTS, MAVFTPSettings
from .upload import Upload

POLL_SECONDS = 0.1
CLOSE_SECONDS = 1.5
# The content of a download is kept in `get_result` up to this size; a download into memory ends there.
MAX_IN_MEMORY = 1 << 26

Args = list[str]
Callback = Callable[[Any], Any] | None
_COMMANDS = "list set get getparams put rm rmdir rename mkdir status cancel crc".split()
_PARAMETER_FILE = "@PARAM/param.pck"


P = ParamSpec("P")


class PathError(ValueError):
    """No request can carry this path."""


def _refusing(
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


class MAVFTP:
    """File operations on a vehicle over the link `master`.

    `cmd_get`, `cmd_getparams` and `cmd_put` only begin a transfer; `process_ftp_reply` drives it to
    its end. The other commands return when they are done. Paths are text; bytes of the vehicle that
    are no UTF-8 are kept (surrogateescape).
    """

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
        self._transfer: Download | Upload | None = None
        self._destination: Destination | None = None
        self._source: IO[bytes] | None = None
        self._callback: Callback = None
        self._progress: Callback = None
        self._path = ""
        self.list_result: list[DirectoryEntry] = []
        self.get_result: bytes | None = None
        self.crc_result: int | None = None
        self.remote_file_size = 0
        self.done = False
        self._channel.request(OP_ResetSessions)

    @property
    def seq(self) -> int:
        """The number of the next request."""
        return self._channel.seq

    @property
    def session(self) -> int:
        """The session of the file that is open, or of the next."""
        return self._channel.session

    # -- commands

    def cmd_ftp(self, args: Args) -> MAVFTPReturn:
        """A command and its arguments, as from a prompt."""
        if not args or args[0] not in _COMMANDS:
            log.error("Usage: ftp <%s>", "|".join(_COMMANDS))
            return MAVFTPReturn("FTP command", FtpError.InvalidArguments)
        command = getattr(self, f"cmd_{args[0]}")
        result: MAVFTPReturn = (
            command() if args[0] in ("status", "cancel") else command(list(args[1:]))
        )
        return result

    @_refusing("ListDirectory")
    def cmd_list(self, args: Args) -> MAVFTPReturn:
        """List a directory, "/" by default, into `list_result`: directories first."""
        self.list_result = []
        if len(args) > 1:
            return _usage("ListDirectory", "list [directory]")
        path = args[0] if args else "/"
        log.info("Listing %s", path)
        found: list[DirectoryEntry] = []
        count = 0
        while count < MAX_ENTRIES:
            op = self._ask(OP_ListDirectory, _encode(path), count)
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
            return _usage("Set", "set PARAMETERNAME PARAMETERVALUE")
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

    @_refusing("RemoveFile")
    def cmd_rm(self, args: Args) -> MAVFTPReturn:
        """Remove a file."""
        if len(args) != 1:
            return _usage("RemoveFile", "rm [FILENAME]")
        log.info("Removing file %s", args[0])
        return self._do(OP_RemoveFile, _encode(args[0]))

    @_refusing("RemoveDirectory")
    def cmd_rmdir(self, args: Args) -> MAVFTPReturn:
        """Remove a directory."""
        if len(args) != 1:
            return _usage("RemoveDirectory", "rmdir [DIRECTORYNAME]")
        log.info("Removing directory %s", args[0])
        return self._do(OP_RemoveDirectory, _encode(args[0]))

    @_refusing("CreateDirectory")
    def cmd_mkdir(self, args: Args) -> MAVFTPReturn:
        """Create a directory."""
        if len(args) != 1:
            return _usage("CreateDirectory", "mkdir NAME")
        log.info("Creating directory %s", args[0])
        return self._do(OP_CreateDirectory, _encode(args[0]))

    @_refusing("Rename")
    def cmd_rename(self, args: Args) -> MAVFTPReturn:
        """Rename a file or a directory: its old and its new path."""
        if len(args) < 2:
            return _usage("Rename", "rename [OLDNAME NEWNAME]")
        old, new = args[:2]
        log.info("Renaming %s to %s", old, new)
        return self._do(OP_Rename, _encode(f"{old}\0{new}"))

    @_refusing("CalcFileCRC32")
    def cmd_crc(self, args: Args) -> MAVFTPReturn:
        """Have the vehicle compute the CRC-32 of a file; it is logged and kept in `crc_result`."""
        self.crc_result = None
        if len(args) != 1:
            return _usage("CalcFileCRC32", "crc [NAME]")
        log.info("Getting CRC for %s", args[0])
        begun = time.monotonic()
        op = self._ask(OP_CalcFileCRC32, _encode(args[0]))
        if op is None:
            return MAVFTPReturn("CalcFileCRC32", FtpError.RemoteReplyTimeout)
        if op.opcode == OP_Ack:
            if len(op.payload or b"") != 4:
                return MAVFTPReturn("CalcFileCRC32", FtpError.InvalidDataSize)
            (self.crc_result,) = struct.unpack("<I", bytes(op.payload or b""))
            seconds = time.monotonic() - begun
            log.info("crc: %s 0x%08x in %.1fs", args[0], self.crc_result, seconds)
        return decode_result(op)

    def cmd_status(self) -> MAVFTPReturn:
        """Log how far the transfer is."""
        if self._transfer is None:
            log.info("No transfer in progress")
        else:
            text = "Transfer at offset %u with %u gaps %u retries %.1f kByte/sec"
            log.info(text, *self._transfer.status())
        return MAVFTPReturn("Status", FtpError.Success)

    def cmd_cancel(self) -> MAVFTPReturn:
        """Give the transfer up and close its session."""
        self._discard()
        self._channel.request(OP_TerminateSession)
        self._next_session()
        return MAVFTPReturn("TerminateSession", FtpError.Success)

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

    def _do(self, opcode: int, data: bytes) -> MAVFTPReturn:
        """A request whose answer is only how it ended."""
        op = self._ask(opcode, data)
        if op is None:
            return MAVFTPReturn(OPERATIONS[opcode], FtpError.RemoteReplyTimeout)
        return decode_result(op)

    def _next_session(self) -> None:
        self._channel.session = (self._channel.session + 1) % 256

    # -- transfers

    @_refusing("OpenFileRO")
    def cmd_get(
        self, args: Args, callback: Callback = None, progress_callback: Callback = None
    ) -> MAVFTPReturn:
        """Begin to read a remote file to a local one, "-" for standard output.

        With a `callback` there is no local file: it gets a file in memory, or None after a failure.
        `progress_callback` gets the fraction that is there, and None at the end.
        """
        if not 1 <= len(args) <= 2:
            return _usage("OpenFileRO", "get [FILENAME <LOCALNAME>]")
        path = args[0]
        remote = _encode(path)
        try:
            local = args[1] if len(args) > 1 else local_name(path)
            memory = callback is not None or local == "-"
            destination = Memory(callback is None) if memory else LocalFile(local, path)
        except OSError as error:
            log.error("FTP: Failed to open %s: %s", local, error)
            return MAVFTPReturn("OpenFileRO", FtpError.FailToOpenLocalFile)
        except ValueError as error:
            log.error("FTP: %s", error)
            return MAVFTPReturn("OpenFileRO", FtpError.InvalidArguments)
        if callback is None:
            log.info("Getting %s to %s", path, local)
        self._begin(path, callback, progress_callback)
        self._destination = destination
        self.remote_file_size = 0
        limit = MAX_IN_MEMORY if memory else None
        with self._given_up_on_error():
            self._transfer = Download(self._channel, remote, destination.file, limit=limit)
        return MAVFTPReturn("OpenFileRO", FtpError.Success)

    @_refusing("CreateFile")
    def cmd_put(
        self,
        args: Args,
        fh: IO[bytes] | None = None,
        callback: Callback = None,
        progress_callback: Callback = None,
    ) -> MAVFTPReturn:
        """Begin to write a local file, or the content of `fh`, to a remote one.

        `callback` gets the number of bytes, or None after a failure; `progress_callback` gets the
        fraction that is there.
        """
        if isinstance(self._transfer, Upload):
            log.error("FTP: put already in progress")
            return MAVFTPReturn("CreateFile", FtpError.PutAlreadyInProgress)
        if not 1 <= len(args) <= 2:
            return _usage("CreateFile", "put [FILENAME <REMOTENAME>]")
        local = args[0]
        try:
            remote = args[1] if len(args) > 1 else local_name(local)
            encoded = _encode(remote)
            source = open(local, "rb") if fh is None else fh
        except PathError:
            raise
        except (OSError, ValueError) as error:
            log.error("FTP: Failed to open %s: %s", local, error)
            return MAVFTPReturn("CreateFile", FtpError.FailToOpenLocalFile)
        if callback is None:
            log.info("Putting %s to %s", local, remote)
        self._begin(remote, callback, progress_callback)
        self._source = source if fh is None else None
        with self._given_up_on_error():
            self._transfer = Upload(self._channel, encoded, source)
        return MAVFTPReturn("CreateFile", FtpError.Success)

    def cmd_getparams(
        self,
        args: Args,
        progress_callback: Callback = None,
        sort_type: str = "missionplanner",
        add_datatype_comments: bool = False,
        add_timestamp_comment: bool = False,
    ) -> MAVFTPReturn:
        """Begin to read all parameters into a file, and their defaults into a second one."""
        if not args:
            return _usage("GetParams", "getparams [PARAMVALUESFILE] <PARAMDEFAULTSFILE>")

        def save(content: IO[bytes] | None) -> MAVFTPReturn | None:
            if content is None:
                log.error("FTP: no parameter file handler")
                return None
            data = ftp_param_decode(content.read())
            if data is None:
                log.error("FTP: Failed to decode parameter file param.pck")
                return MAVFTPReturn("GetParams", FtpError.Fail)
            comments = add_datatype_comments, add_timestamp_comment
            for found, name in zip((data.params, data.defaults), args, strict=False):
                save_params(extract_params(found or [], sort_type), name, sort_type, *comments)
            return None

        query = "?withdefaults=1" if len(args) > 1 else ""
        return self.cmd_get([_PARAMETER_FILE + query], save, progress_callback)

    def read(self, path: str, size: int, offset: int = 0) -> bytes | None:
        """`size` bytes of a remote file from `offset`, fewer at its end; None after a failure."""
        log.info("Getting %s starting at %u reading %u bytes", path, offset, size)
        try:
            remote = _encode(path)
        except PathError as error:
            log.error("FTP: %s", error)
            return None
        self._begin(path, None, None)
        memory = self._destination = Memory()
        transfer = self._transfer = Download(self._channel, remote, memory.file, offset, size)
        result = self.process_ftp_reply("read")
        if result.error_code != FtpError.Success:
            result.display_message()
            return None
        if transfer.received < size:
            log.warning("expected %u, got %u", size, transfer.received)
        return self.get_result

    def read_sector(self, path: str, offset: int, size: int) -> bytes | None:
        """`read` with its arguments in the order of a file system."""
        log.info("reading sector %s, offset=%u, size=%u", path, offset, size)
        return self.read(path, size, offset)

    def process_ftp_reply(self, operation_name: str, timeout: float = 5) -> MAVFTPReturn:
        """Drive a transfer to its end and return how that was.

        `timeout` is how long nothing may arrive, 0 for ever; a transfer that goes on never times out.
        An interruption, or an error of the link, gives the transfer up.
        """
        transfer = self._transfer
        if transfer is None:
            return MAVFTPReturn(operation_name, FtpError.Fail)
        with self._given_up_on_error():
            return self._drive(transfer, operation_name, timeout)

    def _drive(
        self, transfer: Download | Upload, operation_name: str, timeout: float
    ) -> MAVFTPReturn:
        last = time.monotonic()
        while True:
            was_open, moved = transfer.opened, transfer.moved
            op = self._channel.receive(POLL_SECONDS)
            result = transfer.on_reply(op) if op is not None else None
            if (transfer.opened, transfer.moved) != (was_open, moved):
                last = time.monotonic()
            if transfer.moved != moved and self._progress is not None:
                self._progress(transfer.fraction)
            result = transfer.step() if result is None else result
            silence = time.monotonic() - last
            if result is None and timeout and silence > timeout:
                log.error("FTP: timed out after %f seconds", silence)
                result = MAVFTPReturn(operation_name, FtpError.RemoteReplyTimeout)
            if result is not None:
                return self._end(transfer, result)

    def _begin(self, path: str, callback: Callback, progress: Callback) -> None:
        """Make room for a transfer; another one that is under way is given up."""
        if self._transfer is not None:
            self.cmd_cancel()
        self._path, self._callback, self._progress = path, callback, progress
        self.get_result, self.done = None, False

    def _end(self, transfer: Download | Upload, result: MAVFTPReturn) -> MAVFTPReturn:
        """Close the session, hand over what has arrived, and tell who wants to know."""
        good = result.error_code == FtpError.Success
        callback, progress = self._callback, self._progress
        self._close_session(transfer)
        if isinstance(transfer, Download):
            self.remote_file_size = transfer.remote_size
            result = self._finish_download(transfer, result)
            if progress is not None:
                progress(None)
        else:
            self._finish_upload(transfer, good)
            if callback is not None:
                callback(transfer.size if good else None)
        self._discard()
        self.done = True
        return result

    def _close_session(self, transfer: Download | Upload) -> None:
        """Terminate the session; a file that was written is complete only then."""
        limit = CLOSE_SECONDS if transfer.opened else 0.0
        if self._ask(OP_TerminateSession, limit=limit) is None and transfer.opened:
            log.warning("FTP: closing %s was not confirmed", self._path)
        self._next_session()

    def _finish_download(self, transfer: Download, result: MAVFTPReturn) -> MAVFTPReturn:
        destination = self._destination
        assert destination is not None
        if result.error_code != FtpError.Success:
            self._call_back(None)
            return result
        if transfer.received <= MAX_IN_MEMORY:
            destination.file.seek(0)
            self.get_result = destination.file.read()
        if isinstance(destination, LocalFile):
            seconds = max(time.monotonic() - transfer.begun, 1e-6)
            numbers = transfer.received, transfer.remote_size, destination.path, seconds
            speed = transfer.received / seconds / 1024
            log.info("Wrote %u/%u bytes to %s in %.2fs %.1fkByte/s", *numbers, speed)
        try:
            destination.finish()
        except OSError as error:
            log.error("FTP: Failed to write %s: %s", destination.path, error)
            return MAVFTPReturn("Get", FtpError.FailToOpenLocalFile)
        self._destination = None
        log.info("read %u bytes", transfer.received)
        return self._call_back(destination.file) or result

    def _call_back(self, content: IO[bytes] | None) -> MAVFTPReturn | None:
        """Give a download to its callback; a result when that finds something wrong."""
        if self._callback is None:
            return None
        try:
            result = self._callback(content)
        except Exception as error:
            log.error("FTP: download callback failed: %s", error)
            return MAVFTPReturn("Get", FtpError.Fail)
        return result if isinstance(result, MAVFTPReturn) else None

    def _finish_upload(self, transfer: Upload, good: bool) -> None:
        if not good:
            return
        if self._progress is not None:
            self._progress(1.0)
        if self._callback is None:
            seconds = max(time.monotonic() - transfer.begun, 1e-6)
            speed = transfer.size / seconds / 1024
            text = "Put %u bytes to %s file in %.2fs %.1fkByte/s"
            log.info(text, transfer.size, self._path, seconds, speed)

    @contextlib.contextmanager
    def _given_up_on_error(self) -> Iterator[None]:
        """Leave neither half a local file nor an open session, whatever ends a transfer."""
        try:
            yield
        except BaseException:
            self._discard()
            with contextlib.suppress(Exception):  # the link may be what failed
                self._channel.request(OP_TerminateSession)
            self._next_session()
            raise

    def _discard(self) -> None:
        """Forget the transfer and what there is of its local file."""
        if self._destination is not None:
            with contextlib.suppress(OSError):
                self._destination.discard()
        if self._source is not None:
            self._source.close()
        self._transfer = self._destination = self._source = None
        self._callback = self._progress = None

    # -- names that programs use without a client

    ftp_param_decode = staticmethod(ftp_param_decode)
    missionplanner_sort = staticmethod(missionplanner_sort)
    extract_params = staticmethod(extract_params)
    save_params = staticmethod(save_params)

    def __decode_ftp_ack_and_nack(self, op: FTP_OP, operation_name: str = "") -> MAVFTPReturn:
        """Tests of programs call it by this name."""
        return decode_result(op, operation_name)


def _encode(path: str) -> bytes:
    """A remote path as a request carries it; PathError for one that is too long."""
    data = path.encode("utf-8", "surrogateescape")
    if len(data) > MAX_PAYLOAD:
        raise PathError(f"a path of {len(data)} bytes; a request carries {MAX_PAYLOAD}")
    return data


def _usage(name: str, text: str) -> MAVFTPReturn:
    log.error("Usage: %s", text)
    return MAVFTPReturn(name, FtpError.InvalidArguments)
