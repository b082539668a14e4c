"""`mavwire tools`: scripts with pymavlink's names, in a folder that others write to as well."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import sysconfig
from fnmatch import fnmatch
from pathlib import Path

import mavwire
import pytest
from mavwire import cli, traffic
from mavwire.cli.dev import tools

PACKAGE_FOLDER = str(Path(mavwire.__file__).parent.parent)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The environment's folder of scripts, empty."""
    path = tmp_path / "scripts"
    monkeypatch.setattr(sysconfig, "get_path", lambda name: str(path) if name == "scripts" else "")
    return path


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_install_writes_every_script_and_uninstall_removes_them(folder: Path) -> None:
    assert cli.main(["tools", "--install"]) == 0
    assert names(folder) == set(tools.scripts())
    assert {"mavlogdump.py", "mavgen.py", "mavparms.py", "mavloss.py"} <= names(folder)
    assert all(os.access(path, os.X_OK) for path in folder.iterdir())
    assert cli.main(["tools", "--uninstall"]) == 0
    assert names(folder) == set()


def test_another_folder(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = tmp_path / "bin"
    assert cli.main(["tools", "--install", str(other)]) == 0
    assert names(other) == set(tools.scripts())
    assert not folder.exists()
    assert cli.main(["tools", "--status", str(other)]) == 0
    assert "not there" not in capsys.readouterr().out
    assert cli.main(["tools", "--uninstall", str(other)]) == 0
    assert names(other) == set()


def test_a_script_does_what_its_subcommand_does(folder: Path, tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    traffic.generate(log, 300)
    assert cli.main(["tools", "--install"]) == 0
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
    outputs = [
        subprocess.run(
            [*command, str(log)], capture_output=True, env=environment, timeout=120, check=True
        ).stdout
        for command in (
            [str(folder / "mavmsgstats.py")],
            [sys.executable, "-m", "mavwire", "msgstats"],
        )
    ]
    assert outputs[0] == outputs[1] != b""


def test_a_module_is_its_script() -> None:
    """`python -m mavwire.tools.mavparms`, as programs run `python -m pymavlink.tools.mavparms`."""
    code = (
        "import runpy, sys\n"
        "names, sys.argv[1:] = sys.argv[1:], ['--help']\n"
        "for name in names:\n"
        "    try:\n"
        "        runpy.run_module('mavwire.tools.' + name, run_name='__main__')\n"
        "    except SystemExit as end:\n"
        "        assert end.code == 0, name\n"
    )
    names = [name.removesuffix(".py") for name in tools.scripts()]
    helped = subprocess.run(
        [sys.executable, "-W", "error", "-c", code, *names],
        capture_output=True, text=True, check=True, timeout=120,
        env={**os.environ, "PYTHONPATH": PACKAGE_FOLDER},
    )  # fmt: skip
    told = re.findall(r"^usage: mavwire (\w+)", helped.stdout, re.MULTILINE)
    assert told == list(tools.scripts().values())


@pytest.mark.skipif(os.name != "posix", reason="scripts are started by their first line")
@pytest.mark.parametrize("name", ["it's my environment", "e" * 150])
def test_the_interpreter_may_be_called_anything(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    interpreter = tmp_path / name / "python"
    interpreter.parent.mkdir()
    # It says that it was started, and is the interpreter of the tests behind that.
    interpreter.write_text(f'#!/bin/sh\necho started\nexec {shlex.quote(sys.executable)} "$@"\n')
    interpreter.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(interpreter))
    assert cli.main(["tools", "--install"]) == 0
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
    command = [str(folder / "mavlink_bitmask_decoder.py"), "--help"]
    done = subprocess.run(command, capture_output=True, env=environment, timeout=120, check=True)
    assert done.stdout.startswith(b"started\n") and b"usage:" in done.stdout
    assert cli.main(["tools", "--uninstall"]) == 0
    assert names(folder) == set()


def test_files_of_others_stay(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder.mkdir()
    theirs = folder / "mavparms.py"
    theirs.write_text("# pymavlink's\n")
    elsewhere = folder.parent / "elsewhere.py"
    elsewhere.write_text(tools.MARK + "\n")
    (folder / "mavloss.py").symlink_to(elsewhere)
    (folder / "mavgen.py").mkdir()
    (folder / "own.py").write_text("print('mine')\n")
    assert cli.main(["tools", "--install"]) == 1
    assert "mavgen.py, mavloss.py, mavparms.py;" in capsys.readouterr().err
    assert cli.main(["tools", "--uninstall"]) == 0
    assert names(folder) == {"mavparms.py", "mavloss.py", "mavgen.py", "own.py"}
    assert theirs.read_text() == "# pymavlink's\n"
    assert elsewhere.read_text() == tools.MARK + "\n"


def test_an_older_script_is_renewed_and_a_forgotten_one_removed(folder: Path) -> None:
    folder.mkdir()
    for name in ("mavparms.py", "mavgone.py"):
        (folder / name).write_text(f"#!/old/python\n{tools.MARK}\n")
    assert cli.main(["tools", "--install"]) == 0
    assert "/old/python" not in (folder / "mavparms.py").read_text()
    assert cli.main(["tools", "--uninstall"]) == 0
    assert names(folder) == set()


def test_status(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["tools", "--status"]) == 0
    assert capsys.readouterr().out.count("not there") == len(tools.scripts())
    assert cli.main(["tools", "--uninstall"]) == 0
    folder.mkdir()
    (folder / "mavloss.py").write_text("\n")
    cli.main(["tools", "--install"])
    capsys.readouterr()
    assert cli.main(["tools", "--status"]) == 0
    lines = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert lines["mavloss.py"].startswith("not mavwire's")
    assert lines["mavparms.py"] == "mavwire's      mavwire parms"


def test_one_of_the_options_is_needed(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as exit_info:
        cli.main(["tools"])
    assert exit_info.value.code == 2
    assert "--install" in capsys.readouterr().err


def test_every_script_name_is_one_of_pymavlinks(oracle: str) -> None:
    from importlib.util import find_spec

    missing = [name for name in tools.scripts() if not find_spec(f"{oracle}.tools.{name[:-3]}")]
    assert missing == []


def test_every_script_of_pymavlink_is_a_verb_or_listed(oracle: str) -> None:
    """A listed name may stand for several: `magfit_*.py`. pymavlink's own tests are no tools."""
    from importlib import import_module
    from pkgutil import iter_modules

    page = (Path(__file__).parents[3] / "docs" / "pymavlink-tools.md").read_text(encoding="utf-8")
    listed = re.findall(
        r"[\w*]+\.py\b", page.partition("\nNot there are ")[2].partition("\n## ")[0]
    )
    there = {f"{one.name}.py" for one in iter_modules(import_module(f"{oracle}.tools").__path__)}
    left = {name for name in there - tools.scripts().keys() if "test" not in name}
    assert len(there) > 30
    assert [name for name in sorted(left) if not any(fnmatch(name, one) for one in listed)] == []
