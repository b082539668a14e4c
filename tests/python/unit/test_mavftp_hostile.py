"""A vehicle that answers with lies: no path it names is opened, nothing grows without bound, and every
call ends.
"""

from __future__ import annotations

import io
import random
import struct
from collections import deque
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavftp
from mavwire._ftp import listing
from mavwire.mavftp import (
    FTP_OP,
    FtpError,
    OP_Ack,
    OP_BurstReadFile,
    OP_ListDirectory,
    OP_Nack,
    OP_OpenFileRO,
    OP_ReadFile,
)

Answers = Iterable[FTP_OP]
Server = Callable[[FTP_OP], Answers]
HEADER = struct.Struct("<HBBBBBBI")


class Message:
    """A FILE_TRANSFER_PROTOCOL of anyone."""

    def __init__(self, payload: bytes, system: int = 1, component: int = 1, to: int = 255) -> None:
        self.payload = list(payload)
        self.sender, self.target_system = (system, component), to

    def get_srcSystem(self) -> int:
        return self.sender[0]

    def get_srcComponent(self) -> int:
        return self.sender[1]


class Link:
    """A link to a server that is a function: request -> answers."""

    source_system = 255

    def __init__(self, server: Server) -> None:
        self.server, self.mav = server, self
        self.requests: list[FTP_OP] = []
        self.arrived: deque[Message] = deque()

    def file_transfer_protocol_send(self, network: int, *target_and_payload: Any) -> None:
        payload = bytes(target_and_payload[-1])
        seq, session, opcode, size, request, complete, _, offset = HEADER.unpack_from(payload)
        data = payload[12 : 12 + size]
        op = FTP_OP(seq, session, opcode, size, request, complete, offset, data)
        self.requests.append(op)
        self.arrived += (Message(bytes(a.pack()).ljust(251, b"\0")) for a in self.server(op))

    def recv_match(self, **options: Any) -> Message | None:
        return self.arrived.popleft() if self.arrived else None


def ack(op: FTP_OP, data: bytes = b"", **changes: Any) -> FTP_OP:
    values = {
        "seq": (op.seq + 1) & 0xFFFF, "session": op.session, "opcode": OP_Ack, "size": len(data),
        "req_opcode": op.opcode, "burst_complete": 0, "offset": op.offset,
    } | changes  # fmt: skip
    return FTP_OP(**values, payload=data)


def nack(op: FTP_OP, *codes: int, **changes: Any) -> FTP_OP:
    return ack(op, bytes(codes), opcode=OP_Nack, **changes)


def serving(**answers: Server) -> Server:
    """A server that opens any file, of 1000 bytes, and answers what is given for other requests."""
    names = {"burst": OP_BurstReadFile, "read": OP_ReadFile, "list": OP_ListDirectory}
    by_opcode = {names[name]: answer for name, answer in answers.items()}

    def server(op: FTP_OP) -> Answers:
        if op.opcode in by_opcode:
            return by_opcode[op.opcode](op)
        size = struct.pack("<I", 1000) if op.opcode == OP_OpenFileRO else b""
        return [ack(op, size)]

    return server


def client(server: Server) -> tuple[Link, mavftp.MAVFTP]:
    link = Link(server)
    ftp = mavftp.MAVFTP(link, 1, 1)
    for name in ("retry_time", "read_retry_time", "idle_detection_time"):
        setattr(ftp.ftp_settings, name, 0.02)
    return link, ftp


def fetch(server: Server, folder: Path) -> mavftp.MAVFTPReturn:
    _, ftp = client(server)
    ftp.cmd_get(["/file", str(folder / "local")])
    return ftp.process_ftp_reply("get", timeout=0.2)


def entries(raw: bytes) -> mavftp.MAVFTPReturn:
    pages = iter([raw])

    def server(op: FTP_OP) -> Answers:
        page = next(pages, None)
        return [nack(op, 6) if page is None else ack(op, page)]

    return client(serving(list=server))[1].cmd_list(["/"])


@pytest.mark.parametrize(
    "name", [b"../x", b"/etc/passwd", b"a/b", b"..\\x", b"", b".", b"..", b"C:\\x"]
)
def test_names_that_lead_elsewhere_are_left_out(name: bytes) -> None:
    result = entries(b"F" + name + b"\t5\0Fgood\t1\0")
    assert result.directory_listing == [mavftp.DirectoryEntry("good", False, 1)]


def test_names_in_any_bytes_can_be_asked_for_again() -> None:
    (entry,) = entries(b"Fb\xff\t1\0").directory_listing or []
    link, ftp = client(serving())
    ftp.cmd_rm(["/" + entry.name])
    assert link.requests[-1].payload == b"/b\xff"


@pytest.mark.parametrize(
    ("raw", "found"),
    [
        (b"", []),
        (b"\0\0\0", []),
        (b"Fbad\txx\0", [("bad", 0)]),
        (b"Fminus\t-5\0", [("minus", 0)]),
        (b"Ftwo\t1\t2\0", [("two\t1", 2)]),
        (b"Fend\t12", [("end", 12)]),
        (b"Sskip\0Xnone\0", []),
        ("Fu\t\u0663\0".encode(), [("u", 0)]),
    ],
)
def test_entries_of_any_kind(raw: bytes, found: list[tuple[str, int]]) -> None:
    result = entries(raw)
    assert result.error_code == FtpError.Success
    assert [(e.name, e.size_b) for e in result.directory_listing or []] == found


def test_an_entry_without_a_size_is_an_error() -> None:
    assert entries(b"Fname\0").error_code == FtpError.InvalidDataSize


@pytest.mark.parametrize("data", [b"Fname\t\xff\0", b"Fname\xff\0", b"F..\xff/\t1\0"])
def test_what_is_logged_of_a_listing_can_be_written(
    data: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    """Files take logs as UTF-8, which a stray byte of a name is none of."""
    entries(data)
    assert "\\udcff" in caplog.text.encode("utf-8").decode()


def test_an_endless_directory_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    from mavwire._ftp import commands as module

    monkeypatch.setattr(module, "MAX_ENTRIES", 500)
    assert listing.MAX_ENTRIES >= 65_536
    link, ftp = client(serving(list=lambda op: [ack(op, b"Fa\t1\0Fb\t1\0")]))
    assert len(ftp.cmd_list(["/"]).directory_listing or []) == 500
    assert len(link.requests) == 251


@pytest.mark.parametrize("payload", [b"", b"\0", b"\xff", b"\2", b"\1\2", b"x" * 239])
def test_refusals_that_say_nothing(payload: bytes) -> None:
    server = serving(list=lambda op: [ack(op, payload, opcode=OP_Nack)])
    assert client(server)[1].cmd_list(["/"]).error_code >= FtpError.NoErrorCodeInPayload


def test_a_burst_of_nothing_times_out(tmp_path: Path) -> None:
    """Duplicates and empty blocks without end are no progress."""
    server = serving(
        burst=lambda op: [ack(op, b""), ack(op, b"", seq=(op.seq + 2) & 0xFFFF, burst_complete=1)]
    )

    assert fetch(server, tmp_path).error_code == FtpError.RemoteReplyTimeout
    assert list(tmp_path.iterdir()) == []


def test_reads_of_nothing_time_out(tmp_path: Path) -> None:
    def burst(op: FTP_OP) -> Answers:
        return [ack(op, b"x" * 80, offset=op.offset + 80), nack(op, 6, seq=op.seq + 2)]

    server = serving(burst=burst, read=lambda op: [ack(op, b"")])
    assert fetch(server, tmp_path).error_code == FtpError.RemoteReplyTimeout


def test_a_block_far_ahead_makes_no_list_of_what_is_missing(tmp_path: Path) -> None:
    def burst(op: FTP_OP) -> Answers:
        return [ack(op, b"x" * 80, offset=0xFFFFFF00)]

    link, ftp = client(serving(burst=burst))
    ftp.cmd_get(["/file", str(tmp_path / "local")])
    assert ftp.process_ftp_reply("get", timeout=0.1).error_code == FtpError.RemoteReplyTimeout
    assert not any(op.opcode == OP_ReadFile for op in link.requests)


def test_a_file_in_memory_has_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    from mavwire._ftp import transfers as module

    monkeypatch.setattr(module, "MAX_IN_MEMORY", 10_000)

    def burst(op: FTP_OP) -> Answers:
        blocks = range(op.offset, op.offset + 8000, 80)
        return [ack(op, b"x" * 80, seq=op.seq + i, offset=at) for i, at in enumerate(blocks, 1)]

    server = serving(burst=burst)

    def huge(op: FTP_OP) -> Answers:
        if op.opcode == OP_OpenFileRO:
            return [ack(op, b"\xff" * 4)]
        return server(op)

    _, ftp = client(huge)
    got: list[Any] = []
    ftp.cmd_get(["/file"], got.append)
    assert ftp.process_ftp_reply("get").error_code == FtpError.InvalidDataSize
    assert got == [None]


def test_a_size_that_was_a_guess_is_not_believed(tmp_path: Path) -> None:
    """As ArduPilot does with its parameter file."""
    content = bytes(range(200)) * 3

    def burst(op: FTP_OP) -> Answers:
        pieces = range(op.offset, len(content), 80)
        blocks = [
            ack(op, content[at : at + 80], seq=op.seq + i, offset=at)
            for i, at in enumerate(pieces, 1)
        ]
        return [*blocks, nack(op, 6, seq=op.seq + len(blocks) + 1)]

    def read(op: FTP_OP) -> Answers:
        piece = content[op.offset : op.offset + op.size]
        return [ack(op, piece) if piece else nack(op, 6)]

    assert fetch(serving(burst=burst, read=read), tmp_path).error_code == FtpError.Success
    assert (tmp_path / "local").read_bytes() == content


def test_others_are_not_heard() -> None:
    link, ftp = client(lambda op: [])
    payload = bytes(ack(FTP_OP(1, 0, OP_ListDirectory, 0, 0, 0, 0), b"Fx\t1\0").pack())
    padded = payload.ljust(251, b"\0")
    link.arrived += [Message(padded, 2, 1), Message(padded, 1, 9), Message(padded, 1, 1, to=7)]
    assert ftp.cmd_list(["/"]).error_code == FtpError.RemoteReplyTimeout


def test_answers_to_other_requests_are_ignored() -> None:
    def server(op: FTP_OP) -> Answers:
        return [ack(op, seq=op.seq), ack(op, req_opcode=1), ack(op, opcode=op.opcode)]

    assert client(server)[1].cmd_rm(["/x"]).error_code == FtpError.RemoteReplyTimeout


def test_noise_is_survived(tmp_path: Path) -> None:
    chance = random.Random(11)

    def server(op: FTP_OP) -> Answers:
        for _ in range(chance.randrange(4)):
            size = chance.randrange(240)
            opcode = chance.choice((OP_Ack, OP_Ack, OP_Nack, chance.randrange(256)))
            request = chance.choice((op.opcode, op.opcode, chance.randrange(16)))
            seq = op.seq + chance.choice((1, 1, 1, 2, chance.randrange(300)))
            offset = chance.choice((op.offset, op.offset, chance.randrange(3000), 0xFFFFFFFF))
            yield ack(
                op, chance.randbytes(size), opcode=opcode, req_opcode=request, seq=seq & 0xFFFF,
                offset=offset, size=chance.choice((size, 255)), burst_complete=chance.randrange(2),
            )  # fmt: skip

    for number in range(60):
        _, ftp = client(server)
        ftp.ftp_settings.retry_time = ftp.ftp_settings.read_retry_time = 0.001
        ftp.ftp_settings.idle_detection_time = 0.002
        ftp.cmd_list(["/"])
        ftp.cmd_get(["/file", str(tmp_path / f"local{number}")])
        ftp.process_ftp_reply("get", timeout=0.01)
        ftp.cmd_put(["name", "/up"], io.BytesIO(b"x" * 500))
        ftp.process_ftp_reply("put", timeout=0.01)
        ftp.read("/x", 100)
        ftp.cmd_crc(["/x"])
    assert {path.name[:5] for path in tmp_path.iterdir()} <= {"local"}
