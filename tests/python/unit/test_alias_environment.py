"""``mavwire alias`` in a throw-away environment: what is written, what it does, and that it can do no harm."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from unit.environment_tools import Environment

FAKE_PYMAVLINK = "__version__ = '9.9'"
SHOW = "import pymavlink; print(pymavlink.__version__)"

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the environment's layout differs")


@pytest.fixture
def environment(tmp_path: Path) -> Environment:
    return Environment(tmp_path / "environment")


def test_enable_status_disable(environment: Environment) -> None:
    before = environment.alias("--status")
    assert before.returncode == 1
    assert "not enabled" in before.stdout
    assert "there is no such module" in before.stdout

    enabled = environment.alias("--enable")
    assert enabled.returncode == 0, enabled.stderr
    assert f"enabled by {environment.alias_pth}" in enabled.stdout
    assert "gives mavwire (as pymavlink 2.4.50)" in enabled.stdout
    assert environment.run("-c", SHOW).stdout == "2.4.50\n"
    assert environment.alias("--enable").returncode == 0
    assert environment.alias("--status").returncode == 0

    disabled = environment.alias("--disable")
    assert disabled.returncode == 0
    assert not environment.alias_pth.exists()
    assert "ModuleNotFoundError" in environment.run("-c", SHOW).stderr
    again = environment.alias("--disable")
    assert again.returncode == 0
    assert "not enabled" in again.stdout


def test_installed_pymavlink_returns_after_disable(environment: Environment) -> None:
    (environment.site_packages / "pymavlink").mkdir()
    (environment.site_packages / "pymavlink" / "__init__.py").write_text(FAKE_PYMAVLINK)
    assert "gives pymavlink 9.9 from" in environment.alias("--status").stdout
    environment.alias("--enable")
    assert environment.run("-c", SHOW).stdout == "2.4.50\n"
    assert "gives pymavlink 9.9 from" in environment.alias("--disable").stdout


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A source tree with a pymavlink of its own, and a script beside it."""
    package = tmp_path / "tree" / "pymavlink"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text(FAKE_PYMAVLINK)
    (package / "own.py").write_text("")
    (package.parent / "show.py").write_text(SHOW)
    return package.parent


def test_a_pymavlink_in_front_of_the_installed_one_stays(
    environment: Environment, tree: Path
) -> None:
    (environment.site_packages / "pymavlink").mkdir()
    (environment.site_packages / "pymavlink" / "__init__.py").write_text("__version__ = '1.1'")
    environment.alias("--enable")
    assert environment.run(str(tree / "show.py")).stdout == "9.9\n"
    for position, version in ((0, "9.9"), (len(sys.path) + 9, "2.4.50")):
        program = f"import sys; sys.path.insert({position}, {str(tree)!r}); {SHOW}"
        assert environment.run("-c", program).stdout == f"{version}\n"
    program = f"""
import sys; sys.path.insert(0, {str(tree)!r})
import importlib.util, pymavlink.own
assert importlib.util.find_spec("pymavlink.mavutil") is None
from importlib import metadata
try:
    print(metadata.version("pymavlink"))
except metadata.PackageNotFoundError:
    print("own alone")
"""
    done = environment.run("-c", program)
    assert (done.stdout, done.stderr) == ("own alone\n", "")


def test_a_folder_that_is_no_package_does_not_count(environment: Environment, tree: Path) -> None:
    (tree / "pymavlink" / "__init__.py").unlink()
    environment.alias("--enable")
    assert environment.run(str(tree / "show.py")).stdout == "2.4.50\n"


def test_a_program_that_asks_for_mavwire_gets_it(environment: Environment, tree: Path) -> None:
    environment.alias("--enable")
    asking = "import mavwire; mavwire.install_as_pymavlink()"
    program = f"import sys; sys.path.insert(0, {str(tree)!r}); {asking}; {SHOW}"
    assert environment.run("-c", program).stdout == "2.4.50\n"
    assert environment.run("-m", "mavwire", "run", str(tree / "show.py")).stdout == "2.4.50\n"


@pytest.mark.parametrize("is_relative", [False, True])
def test_status_names_the_pymavlink_that_comes_first(
    environment: Environment, tree: Path, monkeypatch: pytest.MonkeyPatch, is_relative: bool
) -> None:
    environment.alias("--enable")
    monkeypatch.chdir(tree.parent)
    status = environment.alias("--status", PYTHONPATH="tree" if is_relative else str(tree))
    assert status.returncode == 1
    assert f"gives pymavlink 9.9 from {tree}" in status.stdout
    assert "PYTHONPATH names the folder of this pymavlink" in status.stdout


def test_status_does_not_look_into_the_folder(
    environment: Environment, tree: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    environment.alias("--enable")
    monkeypatch.chdir(tree)
    assert environment.run("-P", "-m", "mavwire", "alias", "--status").returncode == 0


def test_silent_after_mavwire_was_uninstalled(environment: Environment) -> None:
    environment.alias("--enable")
    environment.mavwire_pth.unlink()
    result = environment.run("-c", "print('started')")
    assert (result.stdout, result.stderr, result.returncode) == ("started\n", "", 0)
    assert "No module named 'pymavlink'" in environment.run("-c", SHOW).stderr


def test_silent_when_mavwire_is_broken(environment: Environment, tmp_path: Path) -> None:
    environment.alias("--enable")
    broken = tmp_path / "broken" / "mavwire"
    broken.mkdir(parents=True)
    (broken / "__init__.py").write_text("raise RuntimeError('half an installation')")
    environment.mavwire_pth.write_text(str(broken.parent))
    result = environment.run("-c", "print('started')")
    assert (result.stdout, result.stderr, result.returncode) == ("started\n", "", 0)


def test_status_says_when_the_file_has_no_effect(environment: Environment) -> None:
    environment.alias_pth.write_text("# emptied\n")
    result = environment.alias("--status")
    assert result.returncode == 1
    assert "the file has no effect" in result.stdout


def test_start_imports_nothing_heavy(environment: Environment) -> None:
    environment.alias("--enable")
    listing = "import sys; print(' '.join(sorted(sys.modules)))"
    with_alias = set(environment.run("-c", listing).stdout.split())
    without = set(environment.run("-S", "-c", listing).stdout.split())
    site = {"site", "_sitebuiltins", "sitecustomize", "usercustomize", "genericpath", "posixpath"}
    extra = with_alias - without - site - {"os", "os.path", "stat", "_stat", "_collections_abc"}
    assert extra <= {"mavwire", "mavwire._alias", "__future__"}


@pytest.mark.skipif(getattr(os, "geteuid", lambda: 1)() == 0, reason="root may write everywhere")
def test_unwritable_folder_is_a_clear_error(environment: Environment) -> None:
    environment.site_packages.chmod(0o555)
    try:
        result = environment.alias("--enable")
    finally:
        environment.site_packages.chmod(0o755)
    assert result.returncode == 1
    assert "cannot write" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_folder_in_the_way_is_a_clear_error(environment: Environment) -> None:
    environment.alias_pth.mkdir()
    result = environment.alias("--enable")
    assert result.returncode == 1
    assert result.stderr.startswith("mavwire alias: error: cannot write")
    assert list(environment.site_packages.glob("*.tmp")) == []
