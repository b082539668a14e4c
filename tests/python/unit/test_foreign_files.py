"""Files without a record: every command says so on standard error and prints what it always does."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import pytest
from dataflash_writer import sample
from encoder import heartbeat, record
from mavwire import cli, mavutil

NO_TELEMETRY = "no telemetry log, there is no record in it"
NO_DATAFLASH = "no dataflash log, there is no record in it"
NOISE = bytes(number * number * 7 % 251 for number in range(3000))
COMMANDS = ("dump", "info", "parms", "flightmodes", "summarize")


@pytest.fixture(autouse=True)
def in_its_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", [*COMMANDS, "loss"])
@pytest.mark.parametrize("name", ["empty.BIN", "empty.tlog", "empty.log"])
def test_an_empty_log(name: str, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path(name).write_bytes(b"")
    assert cli.main([command, name]) == 0
    assert capsys.readouterr().err == f"mavwire {command}: the log is empty: {name!r}\n"


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("name", "content", "said", "is_refused"),
    [
        ("noise.BIN", NOISE, NO_DATAFLASH, False),
        ("head.BIN", b"\xa3\x95\x80", NO_DATAFLASH, False),
        ("text.tlog", b"hello\n", NO_TELEMETRY, True),
        ("one.tlog", b"x", NO_TELEMETRY, True),
        ("seven.tlog", b"1234567", NO_TELEMETRY, True),
        ("markers.tlog", b"\xfd" * 20_000, NO_TELEMETRY, False),
    ],
)
def test_no_record(
    name: str,
    content: bytes,
    said: str,
    is_refused: bool,
    command: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """`is_refused`: by `info`, which sees at the head of the file what it is not, before it reads on."""
    Path(name).write_bytes(content)
    assert cli.main([command, name]) == (1 if command == "info" else 0)
    line = f"{said}: {name!r}"
    if command == "info" and is_refused:
        line = f"{name}: {said}"
    assert capsys.readouterr().err == f"mavwire {command}: {line}\n"


def test_info_of_what_looks_like_frames_alone(capsys: pytest.CaptureFixture[str]) -> None:
    Path("markers.tlog").write_bytes(b"\xfe" * 20_000)
    assert cli.main(["info", "markers.tlog"]) == 1
    assert NO_TELEMETRY in capsys.readouterr().err


def test_a_dataflash_log_behind_noise_is_one(capsys: pytest.CaptureFixture[str]) -> None:
    sample().write(Path("flight.BIN"))
    Path("late.BIN").write_bytes(b"noise" + Path("flight.BIN").read_bytes())
    assert cli.main(["info", "late.BIN"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert "bad      5 bytes in 1 pieces\n" in printed.out


PREFIX = ("dump", "info", "parms", "flightmodes", "flighttime", "summarize", "loss", "msgstats", "search",
          "mission", "togpx", "extract", "tomfile")  # fmt: skip


@pytest.fixture
def named_like_a_program(monkeypatch: pytest.MonkeyPatch) -> Path:
    """R69. Files of a stranger: a program, and an empty log that is called as who runs it would be."""
    program = Path("payload.tlog")
    program.write_text("#!/bin/sh\n: > ran\n")
    program.chmod(0o755)
    Path("exec:payload.tlog").write_bytes(b"")
    Path("exec:.").mkdir()
    Path("exec:.", "payload.tlog").write_bytes(b"")
    monkeypatch.setenv("PATH", f".:{os.environ['PATH']}")
    return Path("ran")


@pytest.mark.skipif(os.name == "nt", reason="such names are not allowed there")
@pytest.mark.parametrize("command", PREFIX)
def test_the_name_of_a_log_runs_no_program(named_like_a_program: Path, command: str) -> None:
    """R69."""
    for name in ("exec:payload.tlog", "exec:./payload.tlog"):
        with contextlib.suppress(SystemExit):
            cli.main([command, name])
        plot = ["plot", name, "ATTITUDE.roll", "--out", "plot.png"]
        assert cli.main(plot) in (0, 1)
        with contextlib.suppress(OSError, ValueError):
            mavutil.mavlink_connection(name).close()
    assert not named_like_a_program.exists()


@pytest.mark.skipif(os.name == "nt", reason="such names are not allowed there")
def test_the_name_of_a_log_opens_no_connection(capsys: pytest.CaptureFixture[str]) -> None:
    name = "udpin:127.0.0.1:0.tlog"
    Path(name).write_bytes(record(heartbeat(), 10**15))
    assert cli.main(["dump", name]) == 0
    assert "HEARTBEAT" in capsys.readouterr().out
