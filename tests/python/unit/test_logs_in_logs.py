"""A flight on which a dataflash log was downloaded: its telemetry log carries that log, and stays one."""

from __future__ import annotations

import gzip
import struct
from pathlib import Path
from typing import Any

import mavwire
import pytest
from dataflash_writer import flight, fmt
from mavwire.dialects.v20 import all as mavlink
from mavwire.fleet import decode
from mavwire.fleet.cuts import find_cuts
from mavwire.logs.rewriting import cut
from mavwire.logs.telemetry import TelemetryLog
from unit.link_tools import T0, heartbeat, pack, record

BLOCK = 4 << 20
"""Bytes that the reader reads at once."""


def dataflash_log() -> bytes:
    """A log with many descriptions at its start."""
    log = bytes(flight().data)
    more = b"".join(fmt(100 + n, f"T{n:03d}", "QI", "TimeUS,X") for n in range(20))
    return log[:89] + more + log[89:]


def downloaded(kind: str) -> list[bytes]:
    """The frames that carry it."""
    size = {"FILE_TRANSFER_PROTOCOL": 239, "LOG_DATA": 90}[kind]
    log, frames = dataflash_log(), []
    for seq, start in enumerate(range(0, len(log), size)):
        piece = log[start : start + size]
        filled = piece.ljust(size, b"\0")
        message: Any = mavlink.MAVLink_log_data_message(1, start, len(piece), list(filled))
        if kind == "FILE_TRANSFER_PROTOCOL":
            head = struct.pack("<HBBBBBBI", seq & 0xFFFF, 0, 128, len(piece), 15, 0, 0, start)
            message = mavlink.MAVLink_file_transfer_protocol_message(
                0, 255, 190, list(head + filled)
            )
        frames.append(pack(message, seq))
    return frames


@pytest.mark.parametrize("kind", ["FILE_TRANSFER_PROTOCOL", "LOG_DATA"])
@pytest.mark.parametrize("before", [0, 20])
@pytest.mark.parametrize("framing", ["stamped", "raw", "compressed", "part"])
def test_a_download_is_no_dataflash_log(tmp_path, kind, before, framing):
    pieces = downloaded(kind)
    frames = [heartbeat(n) for n in range(before)] + pieces
    frames += [heartbeat(n) for n in range(50)]
    content = b"".join(frames if framing == "raw" else [record(one) for one in frames])
    path = tmp_path / "log.tlog"
    expected = {kind: len(pieces), "HEARTBEAT": before + 50}
    if framing == "part":
        path.write_bytes(b"noise" + content)
        tables = decode(path, (5, 5 + len(content)))
    else:
        path.write_bytes(gzip.compress(content) if framing == "compressed" else content)
        assert isinstance(mavwire.open_log(path), TelemetryLog)
        tables = mavwire.read(path)
        assert list(mavwire.read(path, "HEARTBEAT")) == ["HEARTBEAT"]
        cut(path, tmp_path / "cut.tlog", kind)
        assert mavwire.open_log(tmp_path / "cut.tlog").info().messages == len(pieces)
    assert {name: len(table) for name, table in tables.items()} == expected


def test_a_dataflash_log_without_its_first_bytes_is_still_one(tmp_path):
    path = tmp_path / "cut.BIN"
    path.write_bytes(dataflash_log()[40:])
    assert isinstance(mavwire.open_log(path), mavwire.logs.DataflashLog)


@pytest.fixture
def split(tmp_path: Path) -> Path:
    """A large log in which a download stands where it may be cut."""
    one = record(heartbeat(), T0)
    pieces = [record(frame, T0) for frame in downloaded("FILE_TRANSFER_PROTOCOL")]
    path = tmp_path / "split.tlog"
    front = one * ((BLOCK - 2000) // len(one))
    path.write_bytes(front + b"".join(pieces) + one * (BLOCK // len(one)))
    return path


def test_parts_of_a_log_are_what_the_log_is(split):
    parts = find_cuts(str(split), BLOCK // 2)
    assert len(parts) > 1
    with split.open("rb") as file:
        file.seek(parts[1][0])
        assert file.read(64 << 10).count(b"\xa3\x95\x80") > 4, "a part that looks like another log"
    counts: dict[str, int] = {}
    for part in parts:
        for name, table in decode(split, part).items():
            counts[name] = counts.get(name, 0) + len(table)
    assert counts == {name: len(table) for name, table in mavwire.read(split).items()}


def test_the_kind_that_is_handed_over_is_not_guessed_again(tmp_path):
    """Nothing but a dataflash log, of which the caller says that it is telemetry."""
    path = tmp_path / "log.BIN"
    path.write_bytes(dataflash_log())
    size = path.stat().st_size
    assert "GPS" in decode(path, (0, size))
    assert decode(path, (0, size, True)) == {}
    raw = tmp_path / "one.raw"
    raw.write_bytes(heartbeat())
    assert len(decode(raw, (0, raw.stat().st_size, False))["HEARTBEAT"]) == 1
    assert decode(raw, (0, raw.stat().st_size, True)) == {}
