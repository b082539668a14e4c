"""Texts of a log do not steer the terminal, and code runs only where it is asked for."""

from __future__ import annotations

import io
import subprocess
import sys
from argparse import ArgumentParser
from pathlib import Path
from typing import Any

import pytest
from dataflash_writer import FMT, fmt, record
from mavwire import cli, expression, mavftpfs, mavtestgen, uninstall_as_pymavlink
from mavwire._ftp import cli as ftp
from mavwire._text import guarded_output, printable
from mavwire.dialects.v20 import ardupilotmega as mavlink
from mavwire.expression import names
from tool_runs import Log, flight_log


class Terminal(io.TextIOWrapper):
    """Standard output that is a terminal."""

    def __init__(self) -> None:
        super().__init__(io.BytesIO(), encoding="utf-8")

    def isatty(self) -> bool:
        return True

    def text(self) -> str:
        self.flush()
        return self.buffer.getvalue().decode()  # type: ignore[attr-defined]


@pytest.fixture
def log(tmp_path: Path) -> str:
    made = Log(tmp_path / "hostile.tlog")
    for value in (1.0, 2.0):
        made.add(value, mavlink.MAVLink_param_value_message(b"A\x1b[2J\x07", value, 9, 1, 0))
    made.add(3, mavlink.MAVLink_statustext_message(6, b"\x1b]0;pwn\x07"))
    return str(made.done())


@pytest.mark.parametrize(
    "arguments",
    [
        ["parms"], ["parms", "--changes"], ["search"], ["dump"], ["dump", "--format", "csv",
        "--types", "STATUSTEXT"], ["dump", "--verbose"],
    ],
)  # fmt: skip
def test_a_terminal_sees_no_control_characters(
    arguments: list[str], log: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for terminal in (Terminal(), io.TextIOWrapper(io.BytesIO(), encoding="utf-8")):
        monkeypatch.setattr(sys, "stdout", terminal)
        assert cli.main([*arguments, log]) == 0
        terminal.flush()
        text = terminal.buffer.getvalue().decode()  # type: ignore[attr-defined]
        assert ("\x1b" in text) == (not terminal.isatty())
        assert ("\\x1b" in text) == terminal.isatty()
        assert text.count("\n") >= 1


@pytest.mark.parametrize("verb", ["info", "msgstats"])
def test_names_of_types_and_files_steer_no_terminal(
    verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a\x1b[2J.bin"
    path.write_bytes(FMT + fmt(1, "A\x1b[7", "QB", "TimeUS,N") + record(1, "QB", 1, 2) * 3)
    terminal = Terminal()
    monkeypatch.setattr(sys, "stdout", terminal)
    assert cli.main([verb, str(path)]) == 0
    assert sys.stdout is terminal
    assert terminal.text().count("\\x1b[") >= 2
    assert "\x1b" not in terminal.text()


HOSTILE = "a\x1b]0;pwned\x07\x9b31m.tlog"


@pytest.mark.parametrize(
    "arguments",
    [
        ["info", HOSTILE], ["info", "junk" + HOSTILE], ["convert", "junk" + HOSTILE, "-o", "out"],
        ["dump", HOSTILE], ["dump", "junk" + HOSTILE], ["replay", HOSTILE],
        ["plot", HOSTILE, "A.b", "-o", "a.png"], ["gen", HOSTILE, "-o", "out.py"], ["gen", "b.xml", "-o", "out.py"],
        ["bridge", "--config", HOSTILE], ["parmdiff", HOSTILE, HOSTILE], ["fft", HOSTILE, "--image", "a.png"], [HOSTILE],
        ["dump", "--dialect", HOSTILE, "x"], ["info", "x", "--" + HOSTILE], ["run", "-" + HOSTILE],
    ],
)  # fmt: skip
def test_errors_steer_no_terminal(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("junk" + HOSTILE).write_bytes(b"junk" * 3000)
    message = '<message id="1" name="M\x9b31m"><field type="uint8_t" name="a">d</field></message>'
    xml = f"<mavlink><messages>{message}</messages></mavlink>"
    Path("b.xml").write_text(xml, encoding="utf-8")
    said = []
    for stream in (Terminal(), io.TextIOWrapper(io.BytesIO(), encoding="utf-8")):
        monkeypatch.setattr(sys, "stderr", stream)
        try:
            cli.main(arguments)
        except SystemExit as ending:
            print(ending.code, file=stream)
        assert sys.stderr is stream
        stream.flush()
        said.append(stream.buffer.getvalue().decode())  # type: ignore[attr-defined]
    on_terminal, in_file = said
    assert "\\x9b31m" in on_terminal
    assert not set(on_terminal) & set("\x1b\x07\x9b")
    assert on_terminal == "\n".join(map(printable, in_file.split("\n")))


FORGED = "a\nmavwire: all is well\n\x1b[2J.tlog"


@pytest.mark.parametrize(
    "arguments",
    [
        ["info", FORGED], ["info", "junk" + FORGED], ["convert", "junk" + FORGED, "-o", "out"], ["dump", FORGED],
        ["dump", "junk" + FORGED], ["cut", FORGED, "-o", "out"], ["plot", FORGED, "A.b", "-o", "a.png"],
        ["gen", FORGED, "-o", "out.py"], ["bridge", "--config", FORGED], ["parmdiff", FORGED, FORGED], [FORGED],
        ["dump", "--dialect", FORGED, "x"], ["dump", "good.tlog", "-q", "-o", f"none/{FORGED}"],
        ["mission", "good.tlog", "--output", f"none/{FORGED}"],
    ],
)  # fmt: skip
def test_a_name_makes_no_line_of_an_error(
    arguments: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Nor of one that a file or a pipe takes, such as the journal of a service."""
    monkeypatch.chdir(tmp_path)
    Path("junk" + FORGED).write_bytes(b"junk" * 3000)
    flight_log(Path("good.tlog"))
    try:
        code = cli.main(arguments)
    except SystemExit as ending:
        code = int(ending.code or 0)
    said = capsys.readouterr().err
    assert code != 0 or "no telemetry record" in said
    assert said.count("\n") == 1
    assert "\x1b" not in said
    assert "\\x1b[2J" in said


def test_a_name_makes_no_line_of_an_error_of_run(tmp_path: Path) -> None:
    """In a process of its own, as `run` refuses one in which somebody has imported pymavlink."""
    command = [sys.executable, "-m", "mavwire", "run", FORGED]
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode != 0, done.stderr.count("\n")) == (True, 1)
    assert "\x1b" not in done.stderr and "\\x1b[2J" in done.stderr


def test_a_name_makes_no_line_of_a_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    flight_log(Path("log" + FORGED))
    for arguments in (
        ["convert", "log" + FORGED, "-o", "out"],
        ["repair", "log" + FORGED, "-o", FORGED],
    ):
        assert cli.main(arguments) == 0
        said = capsys.readouterr().out
        assert (said.count("\n"), "\x1b" in said) == (1, False), said
    assert Path(FORGED).exists()


def test_a_text_that_ends_a_program_steers_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> int:
        raise OSError("wrong: \x9b31m")

    monkeypatch.setattr(mavtestgen, "generate", fail)
    monkeypatch.setattr(sys, "stderr", Terminal())
    with pytest.raises(SystemExit) as ending:
        mavtestgen.main(["a.xml"])
    assert ending.value.code == "mavtestgen: wrong: \\x9b31m"


def test_lines_that_are_written_at_once_steer_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stdout", terminal)
    with guarded_output():
        sys.stdout.writelines(["a\x1b[2J\n", "b\n"])
    assert terminal.text() == "a\\x1b[2J\nb\n"


@pytest.mark.parametrize(
    "arguments",
    [["dump"], ["definitions", "show"], mavtestgen.main, mavftpfs.main, ftp.main],
)
def test_help_has_no_colours(arguments: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = ArgumentParser.format_help

    def coloured(parser: ArgumentParser) -> str:  # as in Python 3.14
        return "\x1b[1;34m" * getattr(parser, "color", True) + plain(parser)

    monkeypatch.setattr(ArgumentParser, "format_help", coloured)
    monkeypatch.setattr(sys, "argv", ["program", "--help"])
    terminal = Terminal()
    monkeypatch.setattr(sys, "stdout", terminal)
    with pytest.raises(SystemExit):
        arguments() if callable(arguments) else cli.main([*arguments, "--help"])
    assert terminal.text().startswith("usage: ")


class Tee:
    """A stream that cannot tell whether it is a terminal."""

    def __init__(self) -> None:
        self.said = ""

    def write(self, text: str) -> None:
        self.said += text

    def flush(self) -> None:
        """Nothing is kept back."""


@pytest.mark.parametrize("name", ["stdout", "stderr"])
def test_streams_that_are_no_files(name: str, log: str, monkeypatch: pytest.MonkeyPatch) -> None:
    tee = Tee()
    monkeypatch.setattr(sys, name, tee)
    assert cli.main(["--version"]) == 0
    assert cli.main(["dump", log]) == 0
    assert cli.main(["dump", "nosuch.tlog"]) == 1
    assert "nosuch.tlog" in tee.said or "STATUSTEXT" in tee.said


def test_streams_that_are_closed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    closed = io.StringIO()
    closed.close()
    monkeypatch.setattr(sys, "stderr", closed)
    assert cli.main(["--version"]) == 0
    monkeypatch.setattr(sys, "stderr", None)
    with pytest.raises(SystemExit):
        cli.main(["run", "nosuch.py"])
    uninstall_as_pymavlink()  # which a process of its own would take along
    assert "nosuch" not in capsys.readouterr().out


@pytest.mark.parametrize("verb", ["search", "dump"])
def test_functions_of_ones_own(
    verb: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    known = dict(names.known_names())
    monkeypatch.setattr(names, "known_names", lambda: known)
    path = str(flight_log(tmp_path / "flight.tlog"))
    functions = tmp_path / "mine.py"
    functions.write_text("def wanted(mode):\n    return mode == 81\n")
    condition = ["--condition", "wanted(HEARTBEAT.base_mode)"]
    expected = ["--condition", "HEARTBEAT.base_mode == 81"]
    arguments = [verb, path, "--types", "HEARTBEAT"]
    assert cli.main([*arguments, *condition]) == 0
    assert "HEARTBEAT {" not in capsys.readouterr().out
    assert cli.main([*arguments, *condition, "--user-functions", str(functions)]) == 0
    found = capsys.readouterr().out
    assert cli.main([*arguments, *expected]) == 0
    assert capsys.readouterr().out == found
    assert "HEARTBEAT {" in found


@pytest.mark.parametrize(
    ("text", "reason"),
    [(None, "No such file"), ("def", "SyntaxError"), ("1 / 0", "ZeroDivisionError")],
)
def test_a_file_of_functions_that_is_none(
    text: str | None, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    functions = tmp_path / "mine.py"
    if text is not None:
        functions.write_text(text)
    assert cli.main(["search", "x.tlog", "--user-functions", str(functions)]) == 1
    error = capsys.readouterr().err
    assert reason in error
    assert error.count("\n") == 1


def test_nothing_is_run_that_was_not_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / ".pymavlink"
    folder.mkdir()
    (folder / "mavextra.py").write_text("raise SystemExit('run')")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert expression.evaluate_expression("1 + 1", {}) == 2
    path = str(flight_log(tmp_path / "flight.tlog"))
    assert cli.main(["search", path, "--condition", "1 == 2"]) == 0
