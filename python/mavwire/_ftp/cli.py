"""The commands of the client at a shell prompt, with pymavlink's options."""

from __future__ import annotations

import argparse
import logging
import sys
from typing import Any

from mavwire import mavutil
from mavwire._arguments import PlainParser
from mavwire._text import guarded_output

from .client import MAVFTP
from .result import FtpError, MAVFTPReturn
from .settings import DEFAULTS, MAVFTPSettings

# Silence after which a transfer is given up.
TRANSFER_SECONDS = 30.0
HEARTBEAT_SECONDS = 30.0
EXIT_INTERRUPTED = 130

_HELP = {
    "debug": "0 for silence, 1 to log every packet",
    "pkt_loss_tx": "percentage of requests to lose, for tests",
    "pkt_loss_rx": "percentage of answers to lose, for tests",
    "max_backlog": "how many lost blocks to ask for at once",
    "burst_read_size": "bytes of a block that is read",
    "write_size": "bytes of a block that is written",
    "write_qsize": "how many blocks to write at once",
    "idle_detection_time": "seconds to wait for an answer",
    "read_retry_time": "seconds after which a request is sent again",
    "retry_time": "seconds after which a block is sent or asked for again",
}
# Command -> help, and its arguments: (help, optional, type).
_COMMANDS: dict[str, tuple[str, tuple[tuple[str, bool, type], ...]]] = {
    "set": ("set a setting", (("name", False, str), ("value", False, float))),
    "get": ("read a file", (("remote path", False, str), ("local path", True, str))),
    "getparams": (
        "read all parameters",
        (("local path for values", False, str), ("local path for defaults", True, str)),
    ),
    "put": ("write a file", (("local path", False, str), ("remote path", True, str))),
    "list": ("list a directory", (("remote path", True, str),)),
    "mkdir": ("create a directory", (("remote path", False, str),)),
    "rmdir": ("remove a directory", (("remote path", False, str),)),
    "rm": ("remove a file", (("remote path", False, str),)),
    "rename": ("rename", (("remote path", False, str), ("new remote path", False, str))),
    "crc": ("show the CRC-32 of a file", (("remote path", False, str),)),
}


def create_argument_parser() -> argparse.ArgumentParser:
    """The parser of the options; the arguments of a command are arg1 and arg2."""
    parser = PlainParser(description="Files on a vehicle: the MAVLink file transfer.")
    add = parser.add_argument
    add("--baudrate", type=int, default=115200, help="of a serial port. Default is %(default)s")
    add("--device", type=str, default="", help="link or serial port; one is searched otherwise")
    add("--source-system", type=int, default=250, help="own system id. Default is %(default)s")
    add("--loglevel", default="INFO", help="log level. Default is %(default)s")
    for name, kind, default in DEFAULTS:
        choices = [0, 1, 2] if name == "debug" else None
        text = f"{_HELP[name]}. Default is %(default)s"
        add(f"--{name}", type=kind, default=default, choices=choices, help=text)
    commands = parser.add_subparsers(dest="command", required=True)
    for name, (text, arguments) in _COMMANDS.items():
        command = commands.add_parser(name, help=text)
        for number, (what, optional, kind) in enumerate(arguments, start=1):
            nargs = "?" if optional else None
            command.add_argument(f"arg{number}", type=kind, nargs=nargs, help=what, metavar=what)
        if name == "getparams":
            _add_file_options(command)
    return parser


def _add_file_options(command: argparse.ArgumentParser) -> None:
    kinds = ["none", "missionplanner", "mavproxy"]
    command.add_argument("-s", "--sort", choices=kinds, default="missionplanner", help="order")
    flags = (
        ("-dtc", "--add_datatype_comments", "name the type behind each value"),
        ("-t", "--add_timestamp_comment", "name the time at the top"),
    )
    for short, long, text in flags:
        command.add_argument(short, long, action="store_true", help=text)


def auto_detect_serial() -> list[Any]:
    """Serial ports on which an autopilot may be."""
    names = ("*FTDI*", "*3D*", "*USB_to_UART*", "*Ardu*", "*PX4*", "*Hex_*", "*Holybro_*", "*mRo*")
    ports = mavutil.auto_detect_serial(preferred_list=(*names, "*FMU*", "*Swift-Flyer*", "*"))
    return [port for port in ports if "CUAV" not in port.device]


def auto_connect(device: str | None) -> Any:
    """The port of this name, or the first one that may be an autopilot's; SystemExit without any."""
    if device:
        return mavutil.SerialPort(device=device, description=device)
    found = auto_detect_serial()
    if not found:
        raise SystemExit("mavftp: no serial port found; name one with --device")
    return found[0]


def wait_heartbeat(m: Any) -> None:
    """Wait for the first HEARTBEAT of the link, which names the vehicle."""
    if m.wait_heartbeat(timeout=HEARTBEAT_SECONDS) is None:
        raise SystemExit(f"mavftp: no HEARTBEAT within {HEARTBEAT_SECONDS:.0f} s")


@guarded_output()
def main() -> None:
    """Connect, do one command, show how it ended; the exit code is 1 after a failure."""
    parser = create_argument_parser()
    args = parser.parse_args()
    level = args.loglevel.upper()
    levels = logging.getLevelNamesMapping()
    if level not in levels:
        parser.error(f"--loglevel {args.loglevel}: one of {', '.join(levels)}")
    logging.basicConfig(level=level, format="%(levelname)s - %(message)s")
    try:
        result = _connect_and_run(args)
    except KeyboardInterrupt:
        sys.exit(EXIT_INTERRUPTED)
    if result.error_code != FtpError.Success:
        sys.exit(1)


def _connect_and_run(args: argparse.Namespace) -> MAVFTPReturn:
    settings = MAVFTPSettings([(n, kind, getattr(args, n)) for n, kind, _ in DEFAULTS])
    port = auto_connect(args.device)
    try:
        link = mavutil.mavlink_connection(
            port.device, baud=args.baudrate, source_system=args.source_system
        )
    except (OSError, ValueError, ImportError) as error:
        raise SystemExit(f"mavftp: {error}") from error
    try:
        wait_heartbeat(link)
        ftp = MAVFTP(link, link.target_system, link.target_component, settings)
        result = _run(ftp, args)
        result.display_message()
        return result
    finally:
        link.close()


def _run(ftp: MAVFTP, args: argparse.Namespace) -> MAVFTPReturn:
    given = [getattr(args, name, None) for name in ("arg1", "arg2")]
    words = [str(one) for one in given if one is not None]
    if args.command == "set":
        return ftp.cmd_set([words[0], f"{args.arg2:g}"])
    if args.command == "getparams":
        comments = args.add_datatype_comments, args.add_timestamp_comment
        result = ftp.cmd_getparams(words, None, args.sort, *comments)
    else:
        result = ftp.cmd_ftp([args.command, *words])
    if args.command in ("get", "getparams", "put") and result.error_code == FtpError.Success:
        return ftp.process_ftp_reply(args.command, timeout=TRANSFER_SECONDS)
    return result
