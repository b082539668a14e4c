"""What is delivered: one version, extras that exist, a source distribution that builds, workflows that
agree with the rest.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import check_wheel
import mavwire
import pytest

ROOT = Path(__file__).parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
EXTRAS = PROJECT["project"]["optional-dependencies"]
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
# In the source distribution; `*` is any name.
NEEDED = {
    "Cargo.toml", "Cargo.lock", "pyproject.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE",
    "python/mavwire/py.typed", "python/mavwire/_data/summaries.toml", "python/mavwire/_native.pyi",
    "python/mavwire/bridge/inspector.html", "python/mavwire/plots/_assets/chart.js",
}  # fmt: skip
FUZZ = ROOT / "rust" / "fuzz"  # a workspace of its own, which is not distributed
UNWANTED = re.compile(
    r"\.(so|pyd|pyc|tlog|BIN|log|orig|rej)$|__pycache__|/\.|^(\.|tests/|target/|docs/|benches/|dist/)"
)


def test_the_version_has_one_place() -> None:
    assert mavwire.__version__ == VERSION
    assert PROJECT["project"]["dynamic"] == ["version"]
    for manifest in sorted(set((ROOT / "rust").glob("*/Cargo.toml")) - {FUZZ / "Cargo.toml"}):
        package = tomllib.loads(manifest.read_text())["package"]
        assert package["version"] == {"workspace": True}, manifest
    locked = tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]
    assert {p["version"] for p in locked if p["name"].startswith("mavwire-")} == {VERSION}
    assert (ROOT / "CHANGELOG.md").read_text().startswith(f"# Changes\n\n## {VERSION}")


def test_all_is_all_extras() -> None:
    (everything,) = EXTRAS["all"]
    names = re.fullmatch(r"mavwire\[(.+)\]", everything)
    assert names and set(names[1].split(",")) == set(EXTRAS) - {"all"}


def test_extras_that_texts_name_exist() -> None:
    files = [*(ROOT / "python").rglob("*.py"), *(ROOT / "docs").glob("*.md"), ROOT / "README.md"]
    named = {
        extra: path.relative_to(ROOT)
        for path in files
        for extras in re.findall(r"mavwire\[([a-z,]+)\]", path.read_text(encoding="utf-8"))
        for extra in extras.split(",")
    }
    assert not {extra: path for extra, path in named.items() if extra not in EXTRAS}
    assert {"serial", "ws", "cli", "data", "plot", "fleet", "zenoh", "mqtt"} <= named.keys()


@pytest.fixture(scope="module")
def source_files(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Names of the files in the source distribution, below its folder."""
    maturin = Path(sys.executable).with_name("maturin")
    if not maturin.exists() or shutil.which("cargo") is None:
        pytest.skip("maturin and cargo are needed to make the source distribution")
    out = tmp_path_factory.mktemp("sdist")
    made = subprocess.run(
        [maturin, "sdist", "--out", out], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert made.returncode == 0, made.stderr[-1000:]
    (archive,) = out.glob(f"mavwire-{VERSION}.tar.gz")
    with tarfile.open(archive) as tar:
        return {name.partition("/")[2] for name in tar.getnames()}


def test_the_source_distribution_builds(source_files: set[str]) -> None:
    """It has all that the build reads: each tracked file of the package, crates and definitions."""
    assert not NEEDED - source_files
    for folder, pattern in (
        ("python/mavwire", "*.py"), ("python/mavwire", "*.pyi"), ("rust", "src/**/*.rs"),
        ("rust", "build.rs"), ("rust", "Cargo.toml"), ("message_definitions/v1.0", "*.xml"),
    ):  # fmt: skip
        paths = (path for path in (ROOT / folder).rglob(pattern) if FUZZ not in path.parents)
        found = {path.relative_to(ROOT).as_posix() for path in paths}
        assert found
        assert not found - source_files


def test_copies_of_definitions_are_left_to_the_build(source_files: set[str]) -> None:
    assert not {name for name in source_files if name.startswith("python") and ".xml" in name}


def test_nothing_else_is_in_the_source_distribution(source_files: set[str]) -> None:
    assert not {name for name in source_files if UNWANTED.search(name)}


def test_workflows_use_what_there_is() -> None:
    texts = {path.name: path.read_text() for path in WORKFLOWS}
    assert set(texts) == {"ci.yml", "definitions.yml", "release.yml"}
    assert "bash .ci/run" in texts["ci.yml"]
    pinned = (ROOT / "requirements" / "build.txt").read_text()
    maturin = re.search(r"MATURIN: v(\S+)", texts["release.yml"])
    assert maturin and f"maturin=={maturin[1]}\n" in pinned
    for text in texts.values():
        for action in re.findall(r"uses: (.+)", text):
            # A tag can be moved to other code.
            pinned_by_commit = re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", action)
            assert pinned_by_commit, f"{action} is not pinned by commit and version"
        for path in re.findall(r"\b((?:tools|requirements)/[\w./]+)", text):
            assert (ROOT / path).is_file(), path


def test_requirements_are_pinned() -> None:
    """But for what builds a package of the benchmarks, which its own build bounds."""
    for path in sorted((ROOT / "requirements").glob("*.txt")):
        for line in path.read_text().splitlines():
            if line and not line.startswith("#") and path.name != "bench-build.txt":
                assert "==" in line, f"{path.name}: {line}"


WHEEL = [
    *check_wheel.NEEDED,
    "mavwire/_native.abi3.so",
    "mavwire-0.1.0.dist-info/licenses/LICENSE-MIT",
    "mavwire-0.1.0.dist-info/licenses/LICENSE-APACHE",
    "mavwire-0.1.0.dist-info/METADATA",
]


def test_a_good_wheel_passes() -> None:
    check_wheel.check_contents(WHEEL)
    check_wheel.check_name(
        "mavwire-0.1.0-cp311-abi3-manylinux_2_17_armv7l.manylinux2014_armv7l.whl"
    )


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (WHEEL[1:], "missing: mavwire/__init__.py"),
        ([*WHEEL, "mavwire/_native.pyd"], "exactly one extension module"),
        (WHEEL[:-2], "licences"),
        ([*WHEEL, "tests/test_x.py"], "not to be in it: tests/test_x.py"),
        ([*WHEEL, "mavwire.libs/libz.so"], "not to be in it: mavwire.libs"),
    ],
)
def test_a_bad_wheel_is_refused(names: list[str], said: str) -> None:
    with pytest.raises(SystemExit, match=said):
        check_wheel.check_contents(names)


def test_a_wheel_of_one_version_is_refused() -> None:
    with pytest.raises(SystemExit, match="stable ABI"):
        check_wheel.check_name("mavwire-0.1.0-cp311-cp311-linux_x86_64.whl")
