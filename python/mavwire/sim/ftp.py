"""The file transfer protocol: FTP packets inside FILE_TRANSFER_PROTOCOL messages.

A request is answered once; the very same request again gets the same answer again, since then the
answer was lost. A burst is sent over several ticks, so that it leaves room for telemetry.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from mavwire._ftp import MAX_PAYLOAD
from mavwire._ftp.channel import padded, unpacked
from mavwire.dialects.v20 import all as mavlink
from mavwire.mavftp_op import FTP_OP

from .files import MAX_FILE, Files, parameter_file
from .service import Address, Handler, Service, sender

if TYPE_CHECKING:
    from .vehicle import Vehicle

T = TypeVar("T")
Operation = Callable[[FTP_OP, Address], FTP_OP | None]

MAX_SESSIONS = 4
BURST_PACKETS = 500
PACKETS_PER_TICK = 4
ACK, NAK = mavlink.MAV_FTP_OPCODE_ACK, mavlink.MAV_FTP_OPCODE_NAK
BURST = mavlink.MAV_FTP_OPCODE_BURSTREADFILE


class FtpError(Exception):
    """A request that gets a NAK with this MAV_FTP_ERR."""

    def __init__(self, error: int) -> None:
        super().__init__(error)
        self.error = error


@dataclass
class Session:
    """An open file."""

    path: str
    data: bytearray
    writing: bool = False
    block: int = 0


@dataclass
class Stream:
    """A burst that is being sent."""

    to: Address
    session: int
    seq: int
    offset: int
    block: int
    left: int = BURST_PACKETS


class Ftp(Service):
    """The file server of one vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.files = Files(vehicle.personality.files(vehicle))
        if vehicle.personality.packed_params:
            self.files.add_made("@PARAM/param.pck", parameter_file(vehicle))
        self._sessions: dict[int, Session] = {}
        self._streams: list[Stream] = []
        self._last: tuple[Address, bytes, bytes] | None = None
        self._operations: dict[int, Operation] = {
            mavlink.MAV_FTP_OPCODE_NONE: lambda packet, to: _reply(packet),
            mavlink.MAV_FTP_OPCODE_TERMINATESESSION: self._terminate,
            mavlink.MAV_FTP_OPCODE_RESETSESSION: self._reset,
            mavlink.MAV_FTP_OPCODE_LISTDIRECTORY: self._list,
            mavlink.MAV_FTP_OPCODE_OPENFILERO: self._open,
            mavlink.MAV_FTP_OPCODE_READFILE: self._read,
            mavlink.MAV_FTP_OPCODE_CREATEFILE: self._create,
            mavlink.MAV_FTP_OPCODE_OPENFILEWO: self._create,
            mavlink.MAV_FTP_OPCODE_WRITEFILE: self._write,
            mavlink.MAV_FTP_OPCODE_REMOVEFILE: self._changed(self.files.remove),
            mavlink.MAV_FTP_OPCODE_CREATEDIRECTORY: self._make_folder,
            mavlink.MAV_FTP_OPCODE_REMOVEDIRECTORY: self._changed(self.files.remove_folder),
            mavlink.MAV_FTP_OPCODE_TRUNCATEFILE: self._truncate,
            mavlink.MAV_FTP_OPCODE_RENAME: self._rename,
            mavlink.MAV_FTP_OPCODE_CALCFILECRC: self._crc,
            BURST: self._burst,
        }

    def handlers(self) -> Mapping[str, Handler]:
        return {"FILE_TRANSFER_PROTOCOL": self._on_packet}

    def _on_packet(self, msg: Any) -> None:
        request, to = bytes(msg.payload), sender(msg)
        packet = unpacked(request)
        if packet.opcode in (ACK, NAK):
            return
        last = self._last
        if last is not None and last[:2] == (to, request):
            self._send(to, last[2])
            return
        answer = self._answer(packet, to)
        if answer is not None:
            payload = padded(answer)
            self._last = (to, request, payload)
            self._send(to, payload)

    def _answer(self, packet: FTP_OP, to: Address) -> FTP_OP | None:
        operation = self._operations.get(packet.opcode)
        try:
            if operation is None:
                raise FtpError(mavlink.MAV_FTP_ERR_UNKNOWNCOMMAND)
            if packet.size > MAX_PAYLOAD:
                raise FtpError(mavlink.MAV_FTP_ERR_INVALIDDATASIZE)
            return operation(packet, to)
        except FtpError as failed:
            return _reply(packet, bytes((failed.error,)), opcode=NAK)

    def _send(self, to: Address, payload: bytes) -> None:
        self.vehicle.send(mavlink.MAVLink_file_transfer_protocol_message(0, *to, payload))

    # -- sessions

    def _session(self, packet: FTP_OP) -> Session:
        session = self._sessions.get(packet.session)
        if session is None:
            raise FtpError(mavlink.MAV_FTP_ERR_INVALIDSESSION)
        return session

    def _add_session(self, packet: FTP_OP, session: Session) -> int:
        """The number of a new session: PX4 hands one out, ArduPilot takes the client's."""
        number = packet.session
        if self.vehicle.personality.ftp_client_sessions:
            if number in self._sessions:
                self._close(number)
        else:
            number = next((n for n in range(MAX_SESSIONS) if n not in self._sessions), MAX_SESSIONS)
        if len(self._sessions) >= MAX_SESSIONS:
            raise FtpError(mavlink.MAV_FTP_ERR_NOSESSIONSAVAILABLE)
        self._sessions[number] = session
        return number

    def _close(self, number: int) -> None:
        session = self._sessions.pop(number)
        self._streams = [stream for stream in self._streams if stream.session != number]
        if session.writing:
            self.files.write(session.path, bytes(session.data))

    def _terminate(self, packet: FTP_OP, to: Address) -> FTP_OP:
        self._session(packet)
        self._close(packet.session)
        return _reply(packet)

    def _reset(self, packet: FTP_OP, to: Address) -> FTP_OP:
        for number in list(self._sessions):
            self._close(number)
        return _reply(packet)

    # -- reading

    def _list(self, packet: FTP_OP, to: Address) -> FTP_OP:
        entries = _found(self.files.listing(_path(packet)))
        if packet.offset >= len(entries):
            raise FtpError(mavlink.MAV_FTP_ERR_EOF)
        data = b""
        for entry in entries[packet.offset :]:
            if len(data) + len(entry) + 1 > MAX_PAYLOAD:
                break
            data += entry + b"\0"
        return _reply(packet, data)

    def _open(self, packet: FTP_OP, to: Address) -> FTP_OP:
        data = _found(self.files.read(_path(packet), MAX_PAYLOAD))
        number = self._add_session(packet, Session(_path(packet), bytearray(data)))
        return _reply(packet, struct.pack("<I", len(data)), session=number)

    def _block(self, packet: FTP_OP) -> int:
        """How much to read at once; a file that is made is laid out for the first size asked."""
        session, size = self._session(packet), packet.size or MAX_PAYLOAD
        if not session.writing and session.block == 0:
            session.block = size
            session.data = bytearray(self.files.read(session.path, size) or session.data)
        return size

    def _read(self, packet: FTP_OP, to: Address) -> FTP_OP:
        size = self._block(packet)
        data = self._session(packet).data[packet.offset : packet.offset + size]
        if not data:
            raise FtpError(mavlink.MAV_FTP_ERR_EOF)
        return _reply(packet, bytes(data))

    def _burst(self, packet: FTP_OP, to: Address) -> None:
        size = self._block(packet)
        if packet.offset >= len(self._session(packet).data):
            raise FtpError(mavlink.MAV_FTP_ERR_EOF)
        # One for each session, not for each sender: a peer may make up any number of addresses.
        self._streams = [s for s in self._streams if s.session != packet.session]
        self._streams.append(Stream(to, packet.session, packet.seq, packet.offset, size))
        self._last = None

    def step(self) -> None:
        """Send a few packets of each burst."""
        if self._streams:
            for stream in list(self._streams):
                for _ in range(PACKETS_PER_TICK):
                    if not self._send_next(stream):
                        self._streams.remove(stream)
                        break

    def _send_next(self, stream: Stream) -> bool:
        """Send the next packet; whether there are more."""
        data = self._sessions[stream.session].data
        piece = bytes(data[stream.offset : stream.offset + stream.block])
        stream.seq += 1
        stream.left -= 1
        end = stream.offset + len(piece) >= len(data) or stream.left == 0
        head = stream.seq & 0xFFFF, stream.session, ACK, len(piece), BURST, int(end)
        self._send(stream.to, padded(FTP_OP(*head, stream.offset, piece)))
        stream.offset += len(piece)
        return not end

    def _crc(self, packet: FTP_OP, to: Address) -> FTP_OP:
        data = _found(self.files.read(_path(packet), MAX_PAYLOAD))
        return _reply(packet, struct.pack("<I", _crc32(data)))

    # -- writing

    def _create(self, packet: FTP_OP, to: Address) -> FTP_OP:
        if not self.files.writable(_path(packet)):
            raise FtpError(mavlink.MAV_FTP_ERR_FILEPROTECTED)
        old = b""
        if packet.opcode == mavlink.MAV_FTP_OPCODE_OPENFILEWO:
            old = self.files.read(_path(packet), MAX_PAYLOAD) or b""
        number = self._add_session(packet, Session(_path(packet), bytearray(old), writing=True))
        self.files.write(_path(packet), old)
        return _reply(packet, struct.pack("<I", len(old)), session=number)

    def _write(self, packet: FTP_OP, to: Address) -> FTP_OP:
        session = self._session(packet)
        if not session.writing:
            raise FtpError(mavlink.MAV_FTP_ERR_FILEPROTECTED)
        end = packet.offset + packet.size
        if end > MAX_FILE:
            raise FtpError(mavlink.MAV_FTP_ERR_FAIL)
        if len(session.data) < end:
            session.data.extend(bytes(end - len(session.data)))
        session.data[packet.offset : end] = packet.payload or b""
        return _reply(packet)

    def _make_folder(self, packet: FTP_OP, to: Address) -> FTP_OP | None:
        if self.files.exists(_path(packet)):
            raise FtpError(mavlink.MAV_FTP_ERR_FILEEXISTS)
        return self._changed(self.files.make_folder)(packet, to)

    def _changed(self, change: Callable[[str], bool]) -> Operation:
        """The operation that does `change` to a path, which says whether that was possible."""

        def operation(packet: FTP_OP, to: Address) -> FTP_OP:
            path = _path(packet)
            if not change(path):
                exists = self.files.exists(path)
                error = mavlink.MAV_FTP_ERR_FAIL if exists else mavlink.MAV_FTP_ERR_FILENOTFOUND
                raise FtpError(error)
            return _reply(packet)

        return operation

    def _truncate(self, packet: FTP_OP, to: Address) -> FTP_OP:
        data = _found(self.files.contents.get("/" + _path(packet).strip("/")))
        if packet.offset > MAX_FILE:
            raise FtpError(mavlink.MAV_FTP_ERR_FAIL)
        self.files.write(_path(packet), data[: packet.offset].ljust(packet.offset, b"\0"))
        return _reply(packet)

    def _rename(self, packet: FTP_OP, to: Address) -> FTP_OP:
        old, _, new = _text(packet).partition("\0")
        data = _found(self.files.contents.get("/" + old.strip("/")))
        new = new.rstrip("\0")
        if self.files.exists(new) or not self.files.writable(new):
            raise FtpError(mavlink.MAV_FTP_ERR_FILEEXISTS)
        self.files.remove(old)
        self.files.write(new, data)
        return _reply(packet)


def _text(packet: FTP_OP) -> str:
    return bytes(packet.payload or b"").decode("utf-8", "replace")


def _path(packet: FTP_OP) -> str:
    return _text(packet).partition("\0")[0]


def _found(data: T | None) -> T:
    if data is None:
        raise FtpError(mavlink.MAV_FTP_ERR_FILENOTFOUND)
    return data


def _reply(
    packet: FTP_OP, data: bytes = b"", opcode: int = ACK, session: int | None = None
) -> FTP_OP:
    """The answer to a request: the next sequence number, and whose answer it is."""
    head = packet.seq + 1 & 0xFFFF, packet.session if session is None else session
    return FTP_OP(*head, opcode, len(data), packet.opcode, 0, packet.offset, data)


def _crc32(data: bytes) -> int:
    """CRC-32 as the protocol has it: the usual polynomial, but nothing inverted at either end."""
    return zlib.crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF
