"""Parameters, missions and file transfer."""

from __future__ import annotations

from typing import Any, assert_type

from mavwire import mavftp, mavparm, mavutil, mavwp
from mavwire.mavftp_op import FTP_OP, OP_ListDirectory


def parameters(path: str) -> dict[str, float]:
    """A parameter file."""
    known = mavparm.MAVParmDict()
    assert_type(known.load(path), bool)
    known.save("copy.parm", "RC*")
    return {name: float(value) for name, value in known.items()}


def mission(path: str) -> int:
    """A mission file."""
    loader = mavwp.MAVWPLoader(target_system=1, target_component=1)
    assert_type(loader.load(path), int)
    loader.add_latlonalt(-35.36, 149.16, 20.0)
    assert_type(loader.count(), int)
    try:
        loader.save("copy.txt")
    except mavwp.MAVWPError as error:
        assert_type(error.message, str)
    return loader.count()


def files(link: mavutil.mavfile) -> list[mavftp.DirectoryEntry]:
    """The files of a vehicle."""
    ftp = mavftp.MAVFTP(link, link.target_system, link.target_component)
    answer = ftp.cmd_list(["/APM/LOGS"])
    assert_type(answer, mavftp.MAVFTPReturn)
    assert_type(answer.error_code, int)
    answer.display_message()
    return ftp.list_result


def packet() -> bytes:
    """A packet of the transfer protocol."""
    op = FTP_OP(1, 0, OP_ListDirectory, 1, 0, 0, 0, b"/")
    assert_type(op.pack(), bytearray)
    items: list[tuple[str, Any]] = list(op.items())
    return bytes(op.pack()) + str(items).encode()
