"""`mavwire dump` over a dataflash log, text or binary, prints what mavlogdump.py prints."""

from __future__ import annotations

import shlex
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from differential.dataflash_logs import flight
from dump_logs import environment, oracle_dump
from mavwire import cli

FORMATS = """\
FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 1, 31, PARM, QNf, TimeUS,Name,Value
FMT, 2, 75, MSG, QZ, TimeUS,Message
FMT, 3, 30, IMU, QBff, TimeUS,I,AccX,AccY
FMT, 4, 20, ATT, Qcc, TimeUS,Roll,Pitch
FMT, 5, 20, ERR, QBB, TimeUS,Subsys,ECode
"""
CASES = (
    "",
    "--format json",
    "--format csv --types IMU",
    "--format csv --types ATT --csv_sep ';'",
    "--types 'IMU,PARM' --verbose",
    "--types 'A*,*R*' --format json",
    "--nottypes 'FMT*'",
    "--condition 'ATT.Roll>1'",
    "--condition 'ATT.Roll>1' --meta",
    "--reduce 3",
    "--reduce-rate 20",
    "--zero-time-base",
    "--quiet",
    # What only telemetry has, where nothing of it is shown.
    "--show-source --show-seq --quiet",
    "--show-source --show-seq --verbose",
    "--show-source --show-seq --format csv --types IMU",
    "--show-loss --quiet",
)


@pytest.fixture
def clocks(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """This process shows times as the other one does."""
    with monkeypatch.context() as patch:
        patch.setenv("TZ", environment()["TZ"])
        time.tzset()
        yield
    time.tzset()


@pytest.fixture
def log(tmp_path: Path, clocks: None, oracle: str) -> str:
    """A text log."""
    lines = [FORMATS, "PARM, 1000, RATE_MAX, 1.5\n", "MSG, 1500, hello, world\n"]
    for number in range(40):
        micros = 2000 + number * 10_000
        lines.append(f"IMU, {micros}, {number % 2}, {number * 0.25}, -9.8\n")
        lines.append(f"ATT, {micros + 100}, {number * 0.05:.2f}, 0.00\n")
        if number % 16 == 9:
            lines.append(f"ERR, {micros + 200}, 5, 1\n")
    path = tmp_path / "flight.log"
    path.write_text("".join(lines))
    return str(path)


@pytest.fixture
def binary(tmp_path: Path, clocks: None, oracle: str) -> str:
    """A binary log with units, instances and a GPS fix."""
    return flight(11).write(tmp_path / "flight.bin")


def assert_same_lines(options: str, log: str, capsys: pytest.CaptureFixture[str]) -> None:
    theirs, code = oracle_dump(*shlex.split(options), log)
    assert code == 0
    capsys.readouterr()
    assert cli.main(["dump", *shlex.split(options), log]) == 0
    assert capsys.readouterr().out.split("\n") == theirs
    assert (len(theirs) > 5) == ("--quiet" not in options)


@pytest.mark.parametrize("options", [one for one in CASES if "ERR" not in one])
def test_lines_of_a_binary_log(
    options: str, binary: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert_same_lines(options, binary, capsys)


@pytest.mark.parametrize("options", CASES)
def test_lines(options: str, log: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert_same_lines(options, log, capsys)


@pytest.mark.parametrize("options", ["--types ATT", "--parms --condition False", "--parms"])
def test_output_file(options: str, log: str, tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    assert cli.main(["dump", "-q", "-o", str(ours), *shlex.split(options), log]) == 0
    assert oracle_dump("-q", "-o", str(theirs), *shlex.split(options), log)[1] == 0
    assert ours.read_bytes() == theirs.read_bytes() != b""


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--format csv --types IMU,ATT", "exactly one message type"),
        ("--format csv --types NONE", "no message type 'NONE' in this log"),
        ("--show-source", "--show-source"),
        ("--link 1", "for telemetry only"),
    ],
)
def test_errors(options: str, words: str, log: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["dump", *shlex.split(options), log]) == 1
    assert words in capsys.readouterr().err
