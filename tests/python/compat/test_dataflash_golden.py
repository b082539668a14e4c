"""DFReader and CSVReader against golden cases observed on pymavlink 2.4.50.

`tests/vectors/dataflash_golden.json` holds code and the literal results. Where mavwire differs on
purpose, DIFFERENCES says what it gives instead.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import os
import struct
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dataflash_writer as writer
import pytest
from compat.golden_setup import outcome

VECTORS = Path(__file__).parents[2] / "vectors" / "dataflash_golden.json"
CASES = {case["id"]: case for case in json.loads(VECTORS.read_text(encoding="utf-8"))}
TEXT_LOG = """\
FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 162, 18, IMU, QBfh, TimeUS,I,AccX,Raw
FMT, 163, 14, MODE, QMBB, TimeUS,Mode,ModeNum,Rsn
FMT, 161, 31, PARM, QNff, TimeUS,Name,Value,Default
IMU, 4000, 0, 1.5, 7
MODE, 5000, Loiter, 5, 1
PARM, 6000, RC1_MIN, 1100, 1000
GARB, 1
IMU, 7000, 1, nan, -7
"""
# id -> (result, reason)
DIFFERENCES = {
    "B22": ("str: ['FMT', 'FMT']", "a type that cannot be read does not hide the others"),
}
# What is asked of the log where a case only opens it.
EDITS = {"B22": ("mavutil.mavlink_connection('bad.bin')",
                 "str([m.get_type() for m in drain(mavutil.mavlink_connection('bad.bin'))])")}  # fmt: skip


def make_files(directory: Path) -> None:
    """The logs that the cases read."""
    writer.sample().write(directory / "t.bin")
    data = bytes(writer.sample().data)
    imu = writer.record(162, "QBfh", 4000, 0, 1.5, 7)
    described = data[: data.index(b"ArduCopter") - 11]
    junk = described + bytes(7) + imu + b"\xa3\x95\xf0abc"
    (directory / "junk.bin").write_bytes(junk)
    (directory / "e.bin").write_bytes(b"")
    (directory / "n.bin").write_bytes(b"hello world, " * 10)
    bad = writer.FMT + writer.HEAD + b"\x80" + struct.pack("<BB4s16s64s", 9, 4, b"BAD", b"x", b"A")
    (directory / "bad.bin").write_bytes(bad)
    (directory / "t.log").write_text(TEXT_LOG)
    (directory / "f.csv").write_text("T;A;B\n1000;1.5;foo\n2000;2.5;bar\n")


def namespace(package: str) -> dict[str, Any]:
    """Globals of a case."""
    mavutil = importlib.import_module(f"{package}.mavutil")

    def drain(log: Any, **arguments: Any) -> list[Any]:
        return list(iter(lambda: log.recv_match(**arguments), None))

    return {
        "mavutil": mavutil, "DFReader": importlib.import_module(f"{package}.DFReader"), "io": io,
        "os": os, "struct": struct, "nan": float("nan"), "drain": drain, "FMT": writer.FMT,
        "fmt": writer.fmt, "msg": writer.record,
        "mk": lambda name, data: Path(name).write_bytes(bytes(writer.sample().data[:801]) + data),
    }  # fmt: skip


@pytest.fixture
def names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, subject: str
) -> Iterator[dict[str, Any]]:
    """A namespace, in a directory with the logs; the clocks are at UTC."""
    make_files(tmp_path)
    with monkeypatch.context() as patch:
        patch.chdir(tmp_path)
        patch.setenv("TZ", "UTC")
        patch.setenv("HOME", str(tmp_path))
        time.tzset()
        yield namespace(subject)
    time.tzset()


@pytest.mark.parametrize("case", CASES)
def test_golden_case(case: str, names: dict[str, Any], subject: str) -> None:
    code, expected = (
        CASES[case]["code"].replace(*EDITS.get(case, ("", ""))),
        CASES[case]["expected"],
    )
    if case in DIFFERENCES and subject == "mavwire":
        expected = DIFFERENCES[case][0]
    with contextlib.redirect_stderr(io.StringIO()):
        result = outcome(code, names)
    assert result == expected, CASES[case]["title"]
