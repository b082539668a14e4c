"""The files that a vehicle sent by FTP while a telemetry log was written (mavftpdecode.py).

Prints the name of each, and of a parameter file the parameters.
"""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

from mavwire._text import printable
from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._output import writing
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._telemetry import require_telemetry

# A file that claims more is not put together.
LARGEST = 64 << 20


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs")
    parser.add_argument("--save", metavar="FOLDER", help="write the files into this folder")


def main(args: Namespace) -> int:
    if args.save:
        os.makedirs(args.save, exist_ok=True)
    read_each("ftpdecode", args, lambda log: _decode(log, args.save), title="")
    return 0


def _decode(log: Reading, folder: str | None) -> None:
    require_telemetry(log)
    strays = Counter[int]()
    for transfer in transfers(log.messages(["FILE_TRANSFER_PROTOCOL"]), strays):
        _tell(transfer, folder)
    for system, count in sorted(strays.items()):
        tell(
            f"mavwire ftpdecode: {log.path}: {count} parts of files that system {system} sent are left"
            " out: the log does not have which files were asked for"
        )


class Transfer:
    """One file on its way from a vehicle."""

    def __init__(self, name: str, number: int) -> None:
        self.name = name
        # Of the request to open it.
        self.number = number
        self.size: int | None = None
        self._parts: dict[int, bytes] = {}

    def add(self, offset: int, data: bytes) -> None:
        """Take in a part; of two at one place the longer one."""
        if offset + len(data) <= LARGEST and len(data) > len(self._parts.get(offset, b"")):
            self._parts[offset] = data

    def content(self) -> tuple[bytes, int]:
        """The received bytes, with zeros for missing ones, and the number of missing bytes."""
        found = bytearray()
        missing = 0
        for offset, data in sorted(self._parts.items()):
            if offset > len(found):
                missing += offset - len(found)
                found.extend(bytes(offset - len(found)))
            found[offset : offset + len(data)] = data
        if self.size is not None:
            missing += max(0, self.size - len(found))
        return bytes(found), missing


def transfers(messages: Iterable[Any], strays: Counter[int]) -> Iterator[Transfer]:
    """The files that were opened for reading, each when it is at its end. `strays` counts the parts
    of others, by system.
    """
    from mavwire._ftp.channel import parse

    sessions = Sessions(strays)
    for msg in messages:
        packet = parse(msg)
        if packet is not None:
            yield from sessions.take(msg, packet)
    yield from sessions.opened.values()


class Sessions:
    """Which file each session is about."""

    def __init__(self, strays: Counter[int]) -> None:
        # By the system that has the file, and the session. System 0 is a request to all.
        self.opened: dict[tuple[int, int], Transfer] = {}
        self._strays = strays
        # All files that were opened, and the number of the last request for each.
        self._known: dict[tuple[int, int], int] = {}
        # Files without an acknowledged request: system and number of the request -> key in `opened`.
        self._asked: dict[tuple[int, int], tuple[int, int]] = {}

    def take(self, msg: Any, packet: Any) -> Iterator[Transfer]:
        """Take in a message; the files that are at their end then."""
        from mavwire.mavftp_op import OP_Ack, OP_OpenFileRO, OP_ResetSessions, OP_TerminateSession

        if packet.opcode == OP_Ack and packet.req_opcode == OP_OpenFileRO:
            yield from self._open(msg.get_srcSystem(), packet)
        elif packet.opcode == OP_Ack:
            self._add(msg.get_srcSystem(), packet)
        elif packet.opcode == OP_OpenFileRO:
            name = bytes(packet.payload or b"").split(b"\0")[0]
            key = (msg.target_system, packet.session)
            yield from self._begin(key, Transfer(name.decode(errors="replace"), packet.seq))
            self._asked[msg.target_system, packet.seq] = key
        elif packet.opcode in (OP_TerminateSession, OP_ResetSessions):
            for key in [one for one in self.opened if msg.target_system in (0, one[0])]:
                if packet.opcode == OP_ResetSessions or key[1] == packet.session:
                    yield self._end(key)

    def _begin(self, key: tuple[int, int], transfer: Transfer) -> Iterator[Transfer]:
        if key in self.opened:
            yield self._end(key)
        self.opened[key] = transfer
        self._known[key] = transfer.number

    def _end(self, key: tuple[int, int]) -> Transfer:
        transfer = self.opened.pop(key)
        self._asked.pop((key[0], transfer.number), None)
        return transfer

    def _open(self, system: int, packet: Any) -> Iterator[Transfer]:
        """The system that acknowledges a request sends the file, in the session of its answer: a PX4
        chooses the session itself. An earlier file of that session has ended.
        """
        key, number = (system, packet.session), (packet.seq - 1) % (1 << 16)
        asked = self._asked_for(key, number)
        if asked in self.opened:
            transfer = self._end(asked)
            yield from self._begin(key, transfer)
        elif key not in self.opened and self._known.get(key) != number:
            self._known.pop(key, None)  # a file that nobody asks for in the log
        data = bytes(packet.payload or b"")
        if key in self.opened and len(data) >= 4:
            self.opened[key].size = int.from_bytes(data[:4], "little")

    def _asked_for(self, key: tuple[int, int], number: int) -> tuple[int, int]:
        """Where the file is that is opened in a session now, by the number of the request; in that
        session itself if one with this number waits there.
        """
        own = self.opened.get(key)
        if own is not None and own.size is None and own.number == number:
            return key
        system, session = key
        return self._asked.get((system, number)) or self._asked.get((0, number), (0, session))

    def _add(self, system: int, packet: Any) -> None:
        from mavwire.mavftp_op import OP_BurstReadFile, OP_ReadFile

        key = (system, packet.session)
        if packet.req_opcode not in (OP_ReadFile, OP_BurstReadFile):
            return
        if key in self.opened:
            self.opened[key].add(packet.offset, bytes(packet.payload or b""))
        elif key not in self._known:
            self._strays[system] += 1


def _tell(transfer: Transfer, folder: str | None) -> None:
    content, missing = transfer.content()
    name = printable(transfer.name)
    print(f"# {name}")
    if transfer.name.startswith("@PARAM/param.pck"):
        _tell_parameters(name, content)
    elif missing:
        tell(f"mavwire ftpdecode: {name}: {missing} bytes are missing")
    if folder:
        _save(transfer.name, content, folder)


def _save(remote: str, content: bytes, folder: str) -> None:
    """Write a file under the last part of its name; one that is there already is left alone."""
    from mavwire._ftp.local import local_name

    with refused(ValueError):
        path = os.path.join(folder, local_name(remote))
    if os.path.lexists(path):
        raise CommandError(f"--save: {path} is there already")
    with writing(path, option="--save") as file:
        file.write(content)


def _tell_parameters(file: str, content: bytes) -> None:
    from mavwire._ftp.params import ftp_param_decode

    found = ftp_param_decode(content)
    if found is None:
        tell(f"mavwire ftpdecode: {file}: the parameters are not complete")
        return
    for name, value, _ in found.params:
        print(printable(name.decode(errors="replace")), value)
