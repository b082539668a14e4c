"""``mavwire run`` shows a program what ``python`` itself would show it, apart from pymavlink."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import mavwire
import pytest

PACKAGE_FOLDER = str(Path(mavwire.__file__).parent.parent)

REPORT = """
import sys, __main__
print(sys.argv)
print(__name__, __file__, __spec__ and __spec__.name, repr(__package__), type(__loader__).__name__)
print(sys.path[0])
print(__main__.__dict__ is globals())
print(__builtins__)
"""


def python(*arguments: str, cwd: Path, stdin: str = "") -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True, text=True, env=environment, cwd=cwd, input=stdin, timeout=60,
        check=False,
    )  # fmt: skip


def mavwire_run(*arguments: str, cwd: Path, stdin: str = "") -> subprocess.CompletedProcess[str]:
    return python("-m", "mavwire", "run", *arguments, cwd=cwd, stdin=stdin)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "report.py").write_text(REPORT)
    (tmp_path / "pack").mkdir()
    (tmp_path / "pack" / "__init__.py").write_text("")
    (tmp_path / "pack" / "__main__.py").write_text(REPORT)
    (tmp_path / "pack" / "report.py").write_text(REPORT)
    (tmp_path / "link.py").symlink_to(tmp_path / "sub" / "report.py")
    with zipfile.ZipFile(tmp_path / "app.pyz", "w") as archive:
        archive.writestr("__main__.py", REPORT)
    return tmp_path


@pytest.mark.parametrize(
    "arguments",
    [
        ["sub/report.py"],
        ["sub/report.py", "-m", "--help", "-x", "a b", "--", "-"],
        ["link.py", "1"],
        ["-m", "pack", "-q", "--types", "A,B"],
        ["-m", "pack.report"],
        ["-m", "pack.report", "-m", "again"],
        ["pack"],
        ["app.pyz", "x"],
    ],
    ids=" ".join,
)
def test_program_sees_what_python_shows(folder: Path, arguments: list[str]) -> None:
    expected = python(*arguments, cwd=folder)
    assert expected.returncode == 0, expected.stderr
    result = mavwire_run(*arguments, cwd=folder)
    assert result.stdout == expected.stdout
    assert result.stderr == ""


def test_absolute_path(folder: Path) -> None:
    path = str(folder / "sub" / "report.py")
    assert mavwire_run(path, cwd=folder).stdout == python(path, cwd=folder).stdout


def test_pymavlink_is_mavwire(folder: Path) -> None:
    (folder / "program.py").write_text(
        "import pymavlink\nfrom pymavlink.dialects.v20 import minimal as mavlink\n"
        "print(pymavlink.__version__, mavlink.__name__)\n"
    )
    result = mavwire_run("program.py", cwd=folder)
    assert result.stdout == "2.4.50 mavwire.dialects.v20.minimal\n", result.stderr


@pytest.mark.parametrize(
    ("code", "exit_code", "stderr"),
    [
        ("raise SystemExit", 0, ""),
        ("raise SystemExit(7)", 7, ""),
        ("raise SystemExit('reason')", 1, "reason\n"),
        ("import os; os._exit(9)", 9, ""),
        ("import atexit; atexit.register(print, 'bye')", 0, ""),
    ],
)
def test_exit_codes(folder: Path, code: str, exit_code: int, stderr: str) -> None:
    (folder / "program.py").write_text(code)
    result = mavwire_run("program.py", cwd=folder)
    assert (result.returncode, result.stderr) == (exit_code, stderr)
    assert result.stdout == python("program.py", cwd=folder).stdout


@pytest.mark.parametrize(
    "code",
    [
        "def f():\n    1 / 0\nf()\n",
        "try:\n    1 / 0\nexcept Exception as e:\n    raise ValueError('x') from e\n",
        "x = = 1\n",
        "import signal, os\nos.kill(os.getpid(), signal.SIGINT)\n",
        "import nonsense_module\n",
        "import sys\nsys.excepthook = lambda *a: print('own hook', a[0].__name__)\n1 / 0\n",
    ],
    ids=["error", "chained", "syntax", "interrupt", "import", "own hook"],
)
def test_tracebacks_have_no_frames_of_ours(folder: Path, code: str) -> None:
    (folder / "program.py").write_text(code)
    path = str(folder / "program.py")
    expected = python(path, cwd=folder)
    result = mavwire_run(path, cwd=folder)
    assert result.stderr == expected.stderr
    assert result.stdout == expected.stdout
    assert result.returncode == expected.returncode


def test_module_traceback_has_no_frames_of_ours(folder: Path) -> None:
    (folder / "pack" / "bad.py").write_text("1 / 0")
    result = mavwire_run("-m", "pack.bad", cwd=folder)
    assert result.returncode == 1
    assert "mavwire" not in result.stderr.replace(str(folder), "")
    assert result.stderr.endswith("ZeroDivisionError: division by zero\n")


def test_classes_of_main_can_be_pickled_and_threads_outlive_the_script(folder: Path) -> None:
    (folder / "program.py").write_text(
        "import pickle, threading, time\n"
        "class Thing: pass\n"
        "data = pickle.dumps(Thing())\n"
        "def later():\n"
        "    time.sleep(0.2)\n"
        "    print(type(pickle.loads(data)) is Thing)\n"
        "threading.Thread(target=later).start()\n"
    )
    result = mavwire_run("program.py", cwd=folder)
    assert (result.stdout, result.stderr) == ("True\n", "")


@pytest.mark.parametrize(
    ("arguments", "exit_code", "reason"),
    [
        ([], 2, "name a script"),
        (["-m"], 2, "name a script, or a module"),
        (["--frob", "x.py"], 2, "unknown option --frob"),
        (["-"], 2, "unknown option -"),
        (["nowhere.py"], 2, "can't open file"),
        (["-m", "nonsense"], 1, "No module named nonsense"),
        (["-m", "nonsense.deeper"], 1, "No module named 'nonsense'"),
        (["-m", "xml"], 1, "cannot be directly executed"),
        (["."], 1, "can't find '__main__' module in"),
    ],
)
def test_wrong_arguments(folder: Path, arguments: list[str], exit_code: int, reason: str) -> None:
    result = mavwire_run(*arguments, cwd=folder)
    assert result.returncode == exit_code
    assert reason in result.stderr
    assert "Traceback" not in result.stderr


def test_safe_path_is_respected(folder: Path) -> None:
    show = "import sys; print(sys.path[0])"
    (folder / "program.py").write_text(show)
    expected = python("-P", "program.py", cwd=folder)
    result = python("-P", "-m", "mavwire", "run", "program.py", cwd=folder)
    assert result.stdout == expected.stdout


def test_a_pymavlink_in_use_is_a_clear_error(folder: Path) -> None:
    (folder / "pymavlink.py").write_text("")
    code = "import pymavlink; from mavwire import cli; cli.main(['run', 'sub/report.py'])"
    result = python("-c", code, cwd=folder)
    assert result.returncode == 1
    assert result.stderr.startswith("mavwire run: pymavlink is already imported (from ")


def test_installed_scripts_are_found_by_name(folder: Path) -> None:
    import sysconfig

    scripts = Path(sysconfig.get_path("scripts"))
    names = [p.name for p in scripts.iterdir() if p.suffix == ".py"] if scripts.is_dir() else []
    if "mavgen.py" not in names:
        pytest.skip("no installed script to try with")
    result = mavwire_run("mavgen.py", "--help", cwd=folder)
    assert result.returncode == 0, result.stderr
    assert "--wire-protocol" in result.stdout
