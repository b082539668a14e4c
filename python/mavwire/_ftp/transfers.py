"""Files on their way: what begins a transfer, drives it to its end, and clears up after it."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import IO, Any

from mavwire.mavftp_op import OP_TerminateSession

from . import log
from .commands import POLL_SECONDS, Args, Commands, PathError, encode, refusing, usage
from .download import Download
from .local import Destination, LocalFile, Memory, last_name, local_name, open_source
from .result import FtpError, MAVFTPReturn
from .upload import Upload

CLOSE_SECONDS = 1.5
# The content of a download is kept in `get_result` up to this size; a download into memory ends there.
MAX_IN_MEMORY = 1 << 26

Callback = Callable[[Any], Any] | None


class Transfers(Commands):
    """One transfer at a time, in either direction."""

    _transfer: Download | Upload | None = None
    _destination: Destination | None = None
    _source: IO[bytes] | None = None
    _callback: Callback = None
    _progress: Callback = None
    _path = ""
    get_result: bytes | None = None
    remote_file_size = 0
    done = False

    @refusing("OpenFileRO")
    def cmd_get(
        self, args: Args, callback: Callback = None, progress_callback: Callback = None
    ) -> MAVFTPReturn:
        """Begin to read a remote file to a local one, "-" for standard output.

        With a `callback` there is no local file: it gets a file in memory, or None after a failure.
        `progress_callback` gets the fraction that is there, and None at the end.
        """
        if not 1 <= len(args) <= 2:
            return usage("OpenFileRO", "get [FILENAME <LOCALNAME>]")
        path = args[0]
        remote = encode(path)
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

    @refusing("CreateFile")
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
            return usage("CreateFile", "put [FILENAME <REMOTENAME>]")
        local = args[0]
        try:
            remote = args[1] if len(args) > 1 else last_name(local)
            encoded = encode(remote)
            source = open_source(local) if fh is None else fh
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

    def read(self, path: str, size: int, offset: int = 0) -> bytes | None:
        """`size` bytes of a remote file from `offset`, fewer at its end; None after a failure."""
        log.info("Getting %s starting at %u reading %u bytes", path, offset, size)
        try:
            remote = encode(path)
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
        """An error leaves neither half a local file nor an open session."""
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
