"""Which file what a vehicle sends by FTP belongs to."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mavwire import cli
from mavwire.cli.logs.ftpdecode import transfers
from mavwire.dialects.v20 import common as mavlink
from mavwire.mavftp_op import (
    FTP_OP,
    OP_Ack,
    OP_BurstReadFile,
    OP_ListDirectory,
    OP_OpenFileRO,
    OP_TerminateSession,
)
from tool_runs import Log

if TYPE_CHECKING:
    import pytest


def packed(source: int, target: int, packet: FTP_OP) -> Any:
    payload = bytes(packet.pack()).ljust(251, b"\0")
    msg = mavlink.MAVLink_file_transfer_protocol_message(0, target, 1, payload)
    sender = mavlink.MAVLink(None, srcSystem=source)
    return sender.decode(bytearray(msg.pack(sender)))


def request(opcode: int, target: int, data: bytes = b"", session: int = 0) -> Any:
    return packed(255, target, FTP_OP(1, session, opcode, len(data), 0, 0, 0, data))


def answer(opcode: int, source: int, data: bytes, session: int = 0) -> Any:
    return packed(source, 255, FTP_OP(2, session, OP_Ack, len(data), opcode, 0, 0, data))


def sent(source: int, content: bytes) -> list[Any]:
    """A file that was opened, in one piece."""
    size = len(content).to_bytes(4, "little")
    return [answer(OP_OpenFileRO, source, size), answer(OP_BurstReadFile, source, content)]


def found(*messages: Any) -> list[tuple[str, bytes, int]]:
    """Name, content and missing bytes of each file."""
    return [(one.name, *one.content()) for one in transfers(messages, Counter())]


def test_an_answer_to_something_else_opens_no_file() -> None:
    asked = request(OP_OpenFileRO, 0, b"b.txt")
    for other in (OP_ListDirectory, OP_BurstReadFile):
        listing = answer(other, 2, b"Fx.txt\t4")
        assert found(asked, listing, *sent(1, b"BBBB")) == [("b.txt", b"BBBB", 0)]


def test_a_file_asked_of_all_is_not_one_that_was_opened_before() -> None:
    messages = [request(OP_OpenFileRO, 1, b"a.txt"), *sent(1, b"AAAA")]
    messages += [request(OP_OpenFileRO, 0, b"b.txt"), *sent(1, b"BB")]
    assert found(*messages) == [("a.txt", b"AAAA", 0), ("b.txt", b"BB", 0)]
    messages += [request(OP_TerminateSession, 1), *sent(1, b"of no file")]
    assert found(*messages) == [("a.txt", b"AAAA", 0), ("b.txt", b"BB", 0)]


def test_a_file_of_who_has_no_number() -> None:
    messages = [request(OP_OpenFileRO, 0, b"b.txt"), *sent(0, b"BB")]
    assert found(*messages) == [("b.txt", b"BB", 0)]


def test_a_vehicle_that_chooses_the_session() -> None:
    messages = []
    for name in (b"a.txt", b"b.txt"):
        size = answer(OP_OpenFileRO, 1, b"\4\0\0\0")
        messages += [request(OP_OpenFileRO, 1, name, session=9), size]
        messages += [answer(OP_BurstReadFile, 1, name[:4]), request(OP_TerminateSession, 1)]
    assert found(*messages) == [("a.txt", b"a.tx", 0), ("b.txt", b"b.tx", 0)]


def test_a_part_that_comes_once_more_is_of_a_file() -> None:
    strays = Counter[int]()
    last = request(OP_TerminateSession, 1)
    messages = [request(OP_OpenFileRO, 1, b"a.txt"), *sent(1, b"AAAA"), last, *sent(1, b"AAAA")]
    assert len(list(transfers(messages, strays))) == 1
    assert not strays


def test_a_file_whose_request_is_lost_has_strays_in_a_session_that_was_used() -> None:
    strays = Counter[int]()
    last = request(OP_TerminateSession, 1)
    again = packed(1, 255, FTP_OP(12, 0, OP_Ack, 4, OP_OpenFileRO, 0, 0, b"\1\0\0\0"))
    part = packed(1, 255, FTP_OP(13, 0, OP_Ack, 1, OP_BurstReadFile, 0, 0, b"B"))
    messages = [request(OP_OpenFileRO, 1, b"a.txt"), *sent(1, b"AAAA"), last, again, part]
    assert [one.name for one in transfers(messages, strays)] == ["a.txt"]
    assert strays == {1: 1}


def test_two_clients_that_count_alike() -> None:
    """Each in a session of its own."""
    messages = [request(OP_OpenFileRO, 1, b"a", 0), request(OP_OpenFileRO, 1, b"b", 1)]
    for opcode, data in ((OP_OpenFileRO, b"\1\0\0\0"), (OP_BurstReadFile, b"?")):
        for session in (0, 1):
            text = b"AB"[session : session + 1] if data == b"?" else data
            messages.append(answer(opcode, 1, text, session))
    assert found(*messages) == [("a", b"A", 0), ("b", b"B", 0)]


def test_parts_of_files_that_the_log_does_not_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Such as in a log that has one direction alone, of which nothing would be said."""
    log = Log(tmp_path / "answers.tlog")
    listed = answer(OP_ListDirectory, 3, b"Fx.txt\t4")
    for number, message in enumerate([*sent(1, b"AAAA"), *sent(2, b"B"), listed]):
        log.add_bytes(number, message.get_msgbuf())
    assert cli.main(["ftpdecode", str(log.done())]) == 0
    said = capsys.readouterr()
    assert said.out == ""
    assert [line.split(": ")[2][:39] for line in said.err.splitlines()] == [
        "1 parts of files that system 1 sent are",
        "1 parts of files that system 2 sent are",
    ]
