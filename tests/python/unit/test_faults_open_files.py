"""Logs of more types than files may be open: as many as the system allows, and what to do about more."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from dataflash_writer import Log
from mavwire.logs.conversion import convert
from mavwire.logs.open_files import many_open_files
from unit.faults import files, mavwire

resource = pytest.importorskip("resource")

TYPES = 100
FEW = 64
"""Files that may be open: less than there are types, and enough to begin."""


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> str:
    made = Log()
    for n in range(1, TYPES + 1):
        made.define(f"T{n}", "Qf", "TimeUS,X", n).add(f"T{n}", n, 1.0)
    return made.write(tmp_path_factory.mktemp("log") / "many.BIN")


@pytest.fixture
def hard() -> Iterator[int]:
    """The hard limit; the soft one is below."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    if before[1] == resource.RLIM_INFINITY:
        pytest.skip("there is no limit")
    resource.setrlimit(resource.RLIMIT_NOFILE, (before[1] - 1, before[1]))
    yield before[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, before)


def soft() -> Any:
    return resource.getrlimit(resource.RLIMIT_NOFILE)[0]


def test_the_limit_is_raised(hard: int, log: str, tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"many \(each type .*'x'") as caught, many_open_files():
        raise OSError(errno.EMFILE, "too many", "x")
    assert caught.value.errno == errno.EMFILE and soft() == hard
    seen = set()
    convert([log], tmp_path, progress=lambda path, percents: seen.add(soft()))
    assert seen == {hard}


@pytest.mark.parametrize("format", ["parquet", "jsonl"])
def test_as_many_types_as_the_hard_limit_allows(log: str, tmp_path: Path, format: str) -> None:
    argv = ["convert", log, "-o", str(tmp_path), "--format", format, "--quiet"]
    done = mavwire(*argv, before=f"ulimit -S -n {FEW}")
    assert (done.returncode, done.stderr) == (0, "")
    assert sum(name.startswith("T") for name in files(tmp_path)) == TYPES


def test_more_types_than_the_hard_limit_allows(log: str, tmp_path: Path) -> None:
    argv = ["convert", log, "-o", str(tmp_path), "--quiet"]
    done = mavwire(*argv, before=f"ulimit -n {FEW}")
    assert done.returncode == 1
    advice = "choose some types with --types, or raise `ulimit -n`)\n"
    assert "Too many open files" in done.stderr and done.stderr.endswith(advice)
    assert not any(name.startswith("T") for name in files(tmp_path))
    assert mavwire(*argv, "--types", "T1,T2", before=f"ulimit -n {FEW}").returncode == 0


def test_workers_of_a_fleet_too(log: str, tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    argv = ["convert", log, "-o", str(tmp_path), "--quiet", "--workers", "1"]
    done = mavwire(*argv, before="ulimit -S -n 90")
    assert (done.returncode, done.stderr) == (0, "")
    assert sum(name.startswith("T") for name in files(tmp_path)) == TYPES
