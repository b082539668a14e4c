"""The client: one method for each command, and one that waits for a transfer to end."""

from __future__ import annotations

from typing import IO

from mavwire.mavftp_op import FTP_OP

from . import log
from .channel import decode_result
from .commands import Args, usage
from .params import extract_params, ftp_param_decode, missionplanner_sort, save_params
from .result import FtpError, MAVFTPReturn
from .transfers import Callback, Transfers

_COMMANDS = "list set get getparams put rm rmdir rename mkdir status cancel crc".split()
_PARAMETER_FILE = "@PARAM/param.pck"


class MAVFTP(Transfers):
    """File operations on a vehicle over the link `master`.

    `cmd_get`, `cmd_getparams` and `cmd_put` only begin a transfer; `process_ftp_reply` drives it to
    its end. The other commands return when they are done. Paths are text; bytes of the vehicle that
    are no UTF-8 are kept (surrogateescape).
    """

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
            return usage("GetParams", "getparams [PARAMVALUESFILE] <PARAMDEFAULTSFILE>")

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
                save_params(extract_params(found, sort_type), name, sort_type, *comments)
            return None

        query = "?withdefaults=1" if len(args) > 1 else ""
        return self.cmd_get([_PARAMETER_FILE + query], save, progress_callback)

    # -- names that programs use without a client

    ftp_param_decode = staticmethod(ftp_param_decode)
    missionplanner_sort = staticmethod(missionplanner_sort)
    extract_params = staticmethod(extract_params)
    save_params = staticmethod(save_params)

    def __decode_ftp_ack_and_nack(self, op: FTP_OP, operation_name: str = "") -> MAVFTPReturn:
        """Tests of programs call it by this name."""
        return decode_result(op, operation_name)
