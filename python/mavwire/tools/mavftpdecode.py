"""The files that a vehicle sent by FTP while a telemetry log was written (mavftpdecode.py).

Prints the name of each, and of a parameter file the parameters.
"""

from __future__ import annotations

import os
import sys
from collections import Counter

from mavwire._wording import printable
from mavwire.cli._errors import CommandError
from mavwire.cli._output import OutputFile
from mavwire.cli._reading import definitions, reading
from mavwire.tools._arguments import add_logs
from mavwire.tools._telemetry import require_telemetry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterable, Iterator
    from typing import Any

# A file that claims more is not put together.
LARGEST = 64 << 20


def add_arguments(parser: ArgumentParser) -> None:
    """mavftpdecode.py's options."""
    add_logs(parser)
    parser.add_argument("--save", metavar="FOLDER", help="write the files into this folder")


def main(args: Namespace) -> int:
    """Run the subcommand."""
    if args.save:
        os.makedirs(args.save, exist_ok=True)
    for path in args.logs:
        with definitions(), reading("ftpdecode", path) as log:
            require_telemetry(log)
            strays = Counter[int]()
            for transfer in transfers(log.messages(["FILE_TRANSFER_PROTOCOL"]), strays):
                _tell(transfer, args.save)
        for system, count in sorted(strays.items()):
            print(
                f"mavwire ftpdecode: {path}: {count} parts of files that system {system} sent are left"
                " out: the log does not have which files were asked for",
                file=sys.stderr,
            )
    return 0


class Transfer:
    """One file on its way from a vehicle."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.size: int | None = None
        self._parts: dict[int, bytes] = {}

    def add(self, offset: int, data: bytes) -> None:
        """Take in a part; of two at one place the longer one."""
        if offset + len(data) <= LARGEST and len(data) > len(self._parts.get(offset, b"")):
            self._parts[offset] = data

    def content(self) -> tuple[bytes, int]:
        """What came, with zeros for what did not, and how many bytes are missing."""
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
    from mavwire.mavftp_op import OP_Ack, OP_OpenFileRO, OP_ResetSessions, OP_TerminateSession

    # By the system that has the file and the session; of system 0 what all were asked for.
    opened: dict[tuple[int, int], Transfer] = {}
    for msg in messages:
        packet = parse(msg)
        if packet is None:
            continue
        if packet.opcode == OP_Ack:
            yield from _answered(opened, msg.get_srcSystem(), packet, strays)
        elif packet.opcode == OP_OpenFileRO:
            request = (msg.target_system, packet.session)
            if request in opened:
                yield opened.pop(request)
            name = bytes(packet.payload or b"").split(b"\0")[0]
            opened[request] = Transfer(name.decode(errors="replace"))
        elif packet.opcode in (OP_TerminateSession, OP_ResetSessions):
            for key in [one for one in opened if msg.target_system in (0, one[0])]:
                if packet.opcode == OP_ResetSessions or key[1] == packet.session:
                    yield opened.pop(key)
    yield from opened.values()


def _answered(
    opened: dict[tuple[int, int], Transfer], system: int, packet: Any, strays: Counter[int]
) -> Iterator[Transfer]:
    """Take in an answer. Whoever says that it has opened what all were asked for is the one that
    sends it; what it had in that session is at its end.
    """
    from mavwire.mavftp_op import OP_BurstReadFile, OP_OpenFileRO, OP_ReadFile

    one, everyone = (system, packet.session), (0, packet.session)
    if packet.req_opcode == OP_OpenFileRO and everyone in opened:
        transfer = opened.pop(everyone)
        if one in opened:
            yield opened.pop(one)
        opened[one] = transfer
    data = bytes(packet.payload or b"")
    is_part = packet.req_opcode in (OP_ReadFile, OP_BurstReadFile)
    if one not in opened:
        strays.update([system] if is_part else ())
    elif packet.req_opcode == OP_OpenFileRO and len(data) >= 4:
        opened[one].size = int.from_bytes(data[:4], "little")
    elif is_part:
        opened[one].add(packet.offset, data)


def _tell(transfer: Transfer, folder: str | None) -> None:
    content, missing = transfer.content()
    name = printable(transfer.name)
    print(f"# {name}")
    if _is_parameters(transfer):
        _tell_parameters(name, content)
    elif missing:
        print(f"mavwire ftpdecode: {name}: {missing} bytes are missing", file=sys.stderr)
    if folder:
        _save(transfer.name, content, folder)


def _save(remote: str, content: bytes, folder: str) -> None:
    """Write a file under the last part of its name; one that is there already is left alone."""
    from mavwire._ftp.local import local_name

    try:
        path = os.path.join(folder, local_name(remote))
    except ValueError as error:
        raise CommandError(str(error)) from error
    if os.path.lexists(path):
        raise CommandError(f"--save: {path} is there already")
    file = OutputFile(path, "--save")
    file.write(content)
    file.close()


def _is_parameters(transfer: Transfer) -> bool:
    return transfer.name.startswith("@PARAM/param.pck")


def _tell_parameters(file: str, content: bytes) -> None:
    from mavwire._ftp.params import ftp_param_decode

    found = ftp_param_decode(content)
    if found is None:
        print(f"mavwire ftpdecode: {file}: the parameters are not complete", file=sys.stderr)
        return
    for name, value, _ in found.params:
        print(printable(name.decode(errors="replace")), value)


if __name__ == "__main__":
    from mavwire.tools._script import run

    run(__file__)
