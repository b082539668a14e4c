"""pymavlink's log readers without some of their faults, so that damaged logs can be compared.

docs/compatibility.md lists them. A seek leaves the rest of a cut frame in the parser, which
spoils the record behind it. The index stores whatever comes out of a type's first record under the
name of that type. The switch to MAVLink 2 comes with the first message that the dialect knows, and
forgets the counters and what the parser holds. Behind a MAVLink 2 frame at least 12 bytes are read,
which is too much for a short MAVLink 1 frame. A log whose last record is cut off and the first of
its type raises. Nothing else is changed, and everything else has to
be equal.
"""

from __future__ import annotations

from typing import Any

from differential.frames import x25

SHORTEST_V2 = 12
KEPT = (
    "total_packets_received", "total_bytes_received", "total_receive_errors", "expected_length",
    "have_prefix_error", "seq", "signing",
)  # fmt: skip


class Nothing:
    """Stands for the message before the first one behind a seek."""

    @staticmethod
    def get_type() -> str:
        return ""


class CutRecord:
    """Stands for the message of a record that the end of the log cuts off."""

    _instance_field = None

    @staticmethod
    def get_type() -> str:
        return "CUT"


class LogFile:
    """A log's file that empties the parser of its link on every seek, and does not read past a
    short MAVLink 1 frame.
    """

    def __init__(self, file: Any, link: Any, mavutil: Any) -> None:
        self._file = file
        self._mavutil = mavutil
        self._link = link

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)

    def seek(self, *position: int) -> int:
        mav = self._link.mav
        if mav.buf_len():
            mav.total_bytes_received -= mav.buf_len()
            mav.buf = bytearray()
            mav.buf_index = 0
            mav.expected_length = 8
        self._link._last_message = Nothing
        return int(self._file.seek(*position))

    def read(self, size: int) -> bytes:
        data = bytes(self._file.read(size))
        mav = self._link.mav
        whole = self._whole_v1(data) if size == SHORTEST_V2 and not mav.buf_len() else None
        if whole is None:
            return data
        self._file.seek(whole - len(data), 1)
        return data[:whole]

    def _whole_v1(self, data: bytes) -> int | None:
        """Length of the good frame at the front of `data`, if that is one of MAVLink 1."""
        size = 8 + data[1] if data[:1] == b"\xfe" and len(data) > 1 else len(data) + 1
        if size > len(data):
            return None
        known = self._mavutil.mavlink.mavlink_map.get(data[5])
        extra = bytes([known.crc_extra]) if known else b""
        checksum = x25(data[1 : size - 2] + extra).to_bytes(2, "little")
        return size if known is None or data[size - 2 : size] == checksum else None


def mend(mavutil: Any) -> None:
    """Let logs that are opened from now on empty their parser when they seek, and keep it when they
    switch to MAVLink 2.
    """
    if hasattr(mavutil.mavlogfile, "mended"):
        return
    original = mavutil.mavlogfile.__init__

    def __init__(self: Any, *args: Any, **kwargs: Any) -> None:
        original(self, *args, **kwargs)
        self.f = LogFile(self.f, self, mavutil)
        if type(self) is mavutil.mavmmaplog:
            show_first_marker(self)

    def auto_mavlink_version(self: Any, buf: bytes) -> None:
        old = self.mav
        switch(self, buf)
        if self.mav is not old:
            self.mav.buf = old.buf[old.buf_index :]
            for name in KEPT:
                setattr(self.mav, name, getattr(old, name))

    def recv_msg(self: Any) -> Any:
        msg = receive(self)
        is_indexing = "_flightmodes" not in vars(self) and type(self) is mavutil.mavmmaplog
        return CutRecord() if msg is None and is_indexing else msg

    receive = mavutil.mavlogfile.recv_msg
    mavutil.mavlogfile.recv_msg = recv_msg
    switch = mavutil.mavlogfile.auto_mavlink_version
    mavutil.mavlogfile.auto_mavlink_version = auto_mavlink_version
    mavutil.mavlogfile.__init__ = __init__
    mavutil.mavlogfile.mended = True


def show_first_marker(log: Any) -> None:
    """Let a log see the version of its first record before its index is made."""
    with open(log.filename, "rb") as file:
        data = file.read()
    for at in range(8, len(data) - 6):
        if data[at] in b"\xfe\xfd":
            log.auto_mavlink_version(data[at : at + 1])
            return


def forget_misnamed(log: Any) -> None:
    """Take messages out of the tables that stand there under another type's name, and a record that
    is cut off out of the index.
    """
    for system in log.sysid_state.values():
        for name, msg in list(system.messages.items()):
            if name in ("MAV", "HOME") or name.split("[")[0] == msg.get_type():
                continue
            del system.messages[name]
            if isinstance(msg, CutRecord):
                msgid = log.name_to_id.pop(name)
                log._count -= log.counts.pop(msgid)
                del log.offsets[msgid], log.id_to_name[msgid]
