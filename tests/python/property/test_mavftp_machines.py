"""Downloads, listings and uploads over MAVFTP, whatever the vehicle answers and whatever is lost on the way."""

from __future__ import annotations

import io
import struct
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mavwire import mavftp
from mavwire._ftp import channel, commands, download, transfers, upload
from mavwire.mavftp import (
    FTP_OP,
    FtpError,
    OP_Ack,
    OP_BurstReadFile,
    OP_CreateFile,
    OP_ListDirectory,
    OP_Nack,
    OP_OpenFileRO,
    OP_ReadFile,
    OP_TerminateSession,
    OP_WriteFile,
)
from property.hostile import PROFILE
from unit.test_mavftp_hostile import HEADER, Message, ack, nack
from watchdog import watched

MODULES = (channel, commands, download, transfers, upload)
POLL = 0.05
"""Seconds that pass while nothing comes."""
BLOCK = 80


class Clock:
    """Time passes where somebody waits."""

    def __init__(self) -> None:
        self.now = 1000.0

    def monotonic(self) -> float:
        return self.now


class Way:
    """A link to a vehicle, on whose way packets are lost, come twice, and late: `fates` say so, one for each of
    them, and the rest comes through.
    """

    source_system = 255

    def __init__(
        self, answers: Callable[[FTP_OP], Iterator[FTP_OP]], fates: list[str], clock: Clock
    ) -> None:
        self.answers, self.clock, self.mav = answers, clock, self
        self.fates = deque(fates)
        self.arrived: deque[FTP_OP] = deque()
        self.late: deque[FTP_OP] = deque()

    def file_transfer_protocol_send(self, _network: int, *target_and_payload: Any) -> None:
        payload = bytes(target_and_payload[-1])
        seq, session, opcode, size, request, complete, _, offset = HEADER.unpack_from(payload)
        op = FTP_OP(seq, session, opcode, size, request, complete, offset, payload[12 : 12 + size])
        if self._fate() == "lost":
            return
        for answer in self.answers(op):
            self._send(answer)

    def _fate(self) -> str:
        return self.fates.popleft() if self.fates else "comes"

    def _send(self, answer: FTP_OP) -> None:
        fate = self._fate()
        if fate == "late":
            self.late.append(answer)
        elif fate != "lost":
            self.arrived.extend([answer] * (2 if fate == "twice" else 1))

    def recv_match(self, timeout: float = 0.0, **_: Any) -> Message | None:
        if not self.arrived:
            self.clock.now += max(min(timeout, POLL), 0.001)
            self.arrived, self.late = self.late, deque()
        if not self.arrived:
            return None
        return Message(bytes(self.arrived.popleft().pack()).ljust(251, b"\0"))


class Files:
    """An honest vehicle with one file to read, one to write and a directory."""

    def __init__(self, content: bytes, names: list[bytes], claimed: int | None = None) -> None:
        self.content, self.names = content, names
        self.claimed = len(content) if claimed is None else claimed
        self.written = bytearray()

    def __call__(self, op: FTP_OP) -> Iterator[FTP_OP]:
        if op.opcode == OP_OpenFileRO:
            yield ack(op, struct.pack("<I", self.claimed))
        elif op.opcode == OP_ReadFile:
            piece = self.content[op.offset : op.offset + op.size]
            yield ack(op, piece) if piece else nack(op, FtpError.EndOfFile)
        elif op.opcode == OP_BurstReadFile:
            yield from self._burst(op)
        elif op.opcode == OP_ListDirectory:
            # Two of them in each answer.
            raw = b"".join(name + b"\0" for name in self.names[op.offset : op.offset + 2])
            yield ack(op, raw) if raw else nack(op, FtpError.EndOfFile)
        elif op.opcode == OP_WriteFile:
            end = op.offset + op.size
            self.written.extend(bytes(max(end - len(self.written), 0)))
            self.written[op.offset : end] = bytes(op.payload or b"")
            yield ack(op)
        else:
            yield ack(op)

    def _burst(self, op: FTP_OP) -> Iterator[FTP_OP]:
        seq = op.seq
        for at in range(op.offset, min(len(self.content), op.offset + 10 * BLOCK), BLOCK):
            seq += 1
            last = at + BLOCK >= op.offset + 10 * BLOCK
            piece = self.content[at : at + BLOCK]
            yield ack(op, piece, seq=seq & 0xFFFF, offset=at, burst_complete=int(last))
        if op.offset + 10 * BLOCK > len(self.content):
            yield nack(op, FtpError.EndOfFile, seq=(seq + 1) & 0xFFFF)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    for module in MODULES:
        monkeypatch.setattr(module, "time", clock)
    return clock


def client(
    answers: Callable[[FTP_OP], Iterator[FTP_OP]], fates: list[str], clock: Clock
) -> mavftp.MAVFTP:
    return mavftp.MAVFTP(Way(answers, fates, clock), 1, 1)


FATES = st.lists(st.sampled_from(["comes", "comes", "comes", "lost", "twice", "late"]), max_size=60)
CONTENTS = st.builds(
    lambda size, seed: bytes((seed + n * 7) & 255 for n in range(size)),
    st.sampled_from([0, 1, 79, 80, 81, 500, 800, 801, 2000]) | st.integers(0, 3000),
    st.integers(0, 255),
)
NAMES = st.lists(st.integers(0, 9999), max_size=9, unique=True)


@PROFILE
@given(content=CONTENTS, fates=FATES, guess=st.sampled_from([None, 0, 1, 5000]))
@example(content=b"x", fates=["comes"] * 5 + ["lost"], guess=0)
def test_a_download_over_any_way_is_the_file_or_an_error(
    content: bytes, fates: list[str], guess: int | None, clock: Clock, tmp_path: Path
) -> None:
    """R67: also where the size that the vehicle names is a guess."""
    local = tmp_path / "local"
    with watched():
        ftp = client(Files(content, [], guess), fates, clock)
        ftp.cmd_get(["/file", str(local)])
        result = ftp.process_ftp_reply("get", timeout=60)
    if result.error_code == FtpError.Success:
        found = local.read_bytes()
        # A size that is too small is believed, as nothing tells it from the file's.
        whole = guess is None or not 0 < guess < len(content)
        assert found == content if whole else content.startswith(found) and found
        local.unlink()
    assert list(tmp_path.iterdir()) == []


@PROFILE
@given(content=CONTENTS, fates=FATES)
def test_an_upload_over_any_way_is_the_file_or_an_error(
    content: bytes, fates: list[str], clock: Clock
) -> None:
    files = Files(b"", [])
    with watched():
        ftp = client(files, fates, clock)
        ftp.cmd_put(["local", "/file"], io.BytesIO(content))
        result = ftp.process_ftp_reply("put", timeout=60)
    if result.error_code == FtpError.Success:
        assert bytes(files.written) == content


@PROFILE
@given(numbers=NAMES, fates=FATES)
def test_a_listing_over_any_way_is_the_directory_or_an_error(
    numbers: list[int], fates: list[str], clock: Clock
) -> None:
    with watched():
        ftp = client(Files(b"", [b"Ff%d\t%d" % (n, n) for n in numbers]), fates, clock)
        result = ftp.cmd_list(["/"])
    if result.error_code == FtpError.Success:
        found = {(one.name, one.size_b) for one in result.directory_listing or []}
        assert found == {(f"f{n}", n) for n in numbers}


LIES = st.lists(
    st.fixed_dictionaries(
        {},
        optional={
            "data": st.binary(max_size=239),
            "opcode": st.sampled_from([OP_Ack, OP_Nack, OP_BurstReadFile, 0, 255]),
            "req_opcode": st.sampled_from([OP_ReadFile, OP_BurstReadFile, OP_OpenFileRO, OP_CreateFile,
                                           OP_WriteFile, OP_ListDirectory, OP_TerminateSession]),
            "session": st.integers(0, 3),
            "seq": st.integers(-2, 300) | st.just(1),
            "offset": st.sampled_from([0, 1, 79, 80, 81, 160, 5000, 0xFFFFFFFF, 0xFFFFFFB0]),
            "size": st.sampled_from([0, 1, 80, 239, 240, 255]),
            "burst_complete": st.integers(0, 1),
        },
    )
    | st.none(),
    max_size=40,
)  # fmt: skip


@PROFILE
@given(lies=LIES, fates=FATES, claimed=st.sampled_from([0, 100, 0xFFFFFFFF]))
def test_any_answers_end_every_command(
    lies: list[dict[str, Any] | None], fates: list[str], claimed: int, clock: Clock, tmp_path: Path
) -> None:
    """R67, R68: no exception, no file beside those that were asked for, and an end."""
    left = deque(lies)
    honest = Files(b"x" * 500, [b"Fa\t1", b"Db"], claimed)

    def answers(op: FTP_OP) -> Iterator[FTP_OP]:
        lie = left.popleft() if left else None
        if lie is None:
            yield from honest(op)
            return
        changes = dict(lie)
        data = changes.pop("data", b"")
        if "seq" in changes:
            changes["seq"] = (op.seq + changes["seq"]) & 0xFFFF
        yield ack(op, data, **changes)
        yield from honest(op)

    with watched():
        ftp = client(answers, fates, clock)
        results = [ftp.cmd_list(["/"])]
        ftp.cmd_get(["/file", str(tmp_path / "local")])
        results.append(ftp.process_ftp_reply("get", timeout=60))
        ftp.cmd_put(["local", "/file"], io.BytesIO(b"y" * 500))
        results.append(ftp.process_ftp_reply("put", timeout=60))
        results += [ftp.cmd_crc(["/file"]), ftp.cmd_rm(["/file"])]
        read = ftp.read("/file", 100)
    assert all(isinstance(one.error_code, FtpError) for one in results)
    assert read is None or len(read) <= 100
    assert {path.name for path in tmp_path.iterdir()} <= {"local"}
    for path in tmp_path.iterdir():
        path.unlink()
