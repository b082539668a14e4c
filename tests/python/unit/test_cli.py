"""The frame of the ``mavwire`` command: choosing a subcommand, help, version, errors."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import mavwire
import pytest
from mavwire import cli, traffic
from mavwire.cli._errors import CommandError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

PACKAGE_FOLDER = str(Path(mavwire.__file__).parent.parent)


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A subcommand ``probe`` whose ``main`` does what its ``action`` says."""
    module = ModuleType("mavwire.cli.dev.probe", "Probe things.")

    def add_arguments(parser: ArgumentParser) -> None:
        parser.add_argument("--number", type=int, default=0)

    def main(args: Namespace) -> int:
        return module.action(args)

    module.add_arguments, module.main = add_arguments, main  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "mavwire.cli.dev.probe", module)
    monkeypatch.setitem(cli.COMMANDS, "probe", ("dev", "", "probe things"))
    return module


def test_main_gets_parsed_arguments_and_its_code_is_the_exit_code(command: ModuleType) -> None:
    command.action = lambda args: args.number
    assert cli.main(["probe", "--number", "5"]) == 5
    assert cli.main(["probe"]) == 0


def test_command_error_is_one_line(command: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    def action(_args: Namespace) -> int:
        raise CommandError("no such log", exit_code=3)

    command.action = action
    assert cli.main(["probe"]) == 3
    assert capsys.readouterr().err == "mavwire probe: error: no such log\n"


def test_interrupt_ends_quietly(command: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    def action(_args: Namespace) -> int:
        raise KeyboardInterrupt

    command.action = action
    assert cli.main(["probe"]) == 130
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("arguments", [["help"], ["--help"], ["-h"]])
def test_help_lists_every_command(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(arguments) == 0
    text = capsys.readouterr().out
    for name, (_, _, line) in cli.COMMANDS.items():
        assert f"{name} " in text
        assert line in text


def test_no_command_prints_help_and_fails(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([]) == 2
    assert "usage: mavwire COMMAND" in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["help", "probe"], ["probe", "--help"]])
def test_help_of_a_command(
    command: ModuleType, arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as exit_info:
        cli.main(arguments)
    assert exit_info.value.code == 0
    text = capsys.readouterr().out
    assert text.startswith("usage: mavwire probe")
    assert "Probe things." in text


def test_unknown_command_suggests(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["alis"]) == 2
    assert capsys.readouterr().err == ("mavwire: unknown command 'alis'; did you mean 'alias'?\n")
    assert cli.main(["qqqq"]) == 2
    assert "see: mavwire help" in capsys.readouterr().err


def test_version_names_both(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--version"]) == 0
    text = capsys.readouterr().out
    assert text == f"mavwire {mavwire.__version__} (compatible with pymavlink 2.4.50)\n"


@pytest.mark.parametrize("name", sorted(cli.COMMANDS))
def test_every_command_of_the_table_has_its_module_and_help(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as exit_info:
        cli.main([name, "--help"])
    assert exit_info.value.code == 0
    assert f"mavwire {name}" in capsys.readouterr().out


def test_start_imports_only_the_chosen_command() -> None:
    code = (
        "import sys; from mavwire import cli; cli.main(['help']);"
        "print(sorted(m for m in sys.modules if m.startswith('mavwire')))"
    )
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
    result = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True, text=True, env=environment, timeout=60, check=True,
    )  # fmt: skip
    loaded = [
        "mavwire",
        "mavwire._arguments",
        "mavwire._text",
        "mavwire.cli",
        "mavwire.cli._errors",
        "mavwire.cli._parsers",
    ]
    assert result.stdout.splitlines()[-1] == str(loaded)


def test_a_tool_runs_without_the_definitions_of_version_1(tmp_path: Path) -> None:
    """A log of MAVLink 2 needs none, and they take a good part of a short run."""
    log = tmp_path / "flight.tlog"
    traffic.generate(log, 200)
    for verb in ("parms", "flightmodes", "summarize"):
        code = (
            f"import sys; from mavwire import cli; cli.main([{verb!r}, {str(log)!r}]);"
            "sys.exit(repr([name for name in sys.modules if name.startswith('mavwire.dialects.v10.')]))"
        )
        environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
        command = [sys.executable, "-c", code]
        done = subprocess.run(
            command, capture_output=True, text=True, env=environment, timeout=60, check=False
        )
        assert done.stderr == "[]\n", verb


def test_commands_start_without_what_they_seldom_need() -> None:
    """Each of these modules costs more time than the rest of a short run."""
    code = (
        "import sys\n"
        "from mavwire import cli\n"
        "from mavwire.cli import _parsers\n"
        "for name in ('parms', 'summarize', 'togpx', 'flighttime', 'loss', 'dump', 'gen'):\n"
        "    _parsers.parser_of(name, cli.module_of(name))\n"
        "    print(name, {'urllib.parse', 'ssl', 'socket'} & set(sys.modules))\n"
    )
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
    result = subprocess.run(
        [sys.executable, "-S", "-c", code],
        capture_output=True, text=True, env=environment, timeout=60, check=True,
    )  # fmt: skip
    lines = result.stdout.splitlines()
    assert len(lines) == 7
    assert [line for line in lines if not line.endswith("set()")] == []


def test_a_reader_that_goes_away_is_no_error(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(
        "import sys\nfrom types import ModuleType\nfrom mavwire import cli\n"
        "m = ModuleType('p', 'p')\nm.add_arguments = lambda parser: None\n"
        "def main(args):\n    for _ in range(200_000): print('line')\n    return 0\n"
        "m.main = main\nsys.modules['mavwire.cli.dev.p'] = m\ncli.COMMANDS['p'] = ('dev', '', 'p')\n"
        "sys.exit(cli.main(['p']))\n"
    )
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
    process = subprocess.Popen(
        [sys.executable, str(program)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment,
    )  # fmt: skip
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.readline()
    process.stdout.close()
    assert process.wait(timeout=60) == 0
    assert process.stderr.read() == b""
    process.stderr.close()


def shell(command: str) -> subprocess.CompletedProcess[str]:
    """Run a command line in which MAVWIRE stands for the command."""
    return subprocess.run(
        ["/bin/sh", "-c", command.replace("MAVWIRE", f"{sys.executable} -m mavwire")],
        capture_output=True, text=True, env={**os.environ, "PYTHONPATH": PACKAGE_FOLDER},
        timeout=60, check=False,
    )  # fmt: skip


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full here")
@pytest.mark.parametrize(
    ("command", "prefix"),
    [
        ("--help", "mavwire"),
        ("info LOG", "mavwire info"),
        ("dump LOG", "mavwire dump"),
        ("dump LOG --condition 1", "mavwire dump"),
    ],
)
def test_a_full_disk_is_one_line(command: str, prefix: str, tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 100)
    result = shell(f"MAVWIRE {command.replace('LOG', str(path))} > /dev/full")
    assert result.stderr == f"{prefix}: error: standard output: No space left on device\n"
    assert result.returncode == 1


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full here")
def test_what_cannot_be_printed_before_an_error_makes_no_other() -> None:
    """What is buffered is written when the interpreter ends."""
    result = shell("PYTHONUNBUFFERED= MAVWIRE tomfile missing.tlog > /dev/full")
    assert result.stderr == "mavwire tomfile: error: no such log: missing.tlog\n"
    assert result.returncode == 1


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-"])
@pytest.mark.parametrize("command", ["--help", "info LOG", "dump LOG"])
def test_streams_that_are_closed_take_nothing(command: str, closed: str, tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 100)
    result = shell(f"MAVWIRE {command.replace('LOG', str(path))} {closed}")
    assert result.returncode == 0
    assert result.stderr == ""
    assert bool(result.stdout) == (closed == "2>&-")


def test_an_error_of_a_program_that_is_run_passes_through(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text("raise BrokenPipeError(32, 'Broken pipe')")
    result = shell(f"MAVWIRE run {program}")
    assert result.returncode == 1
    assert result.stderr.splitlines()[-1] == "BrokenPipeError: [Errno 32] Broken pipe"
