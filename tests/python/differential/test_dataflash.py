"""Dataflash logs read through both packages in every way give the same transcript.

Generated logs always; real ones where there are some (`real_logs` says where).
"""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import zip_longest
from pathlib import Path

import pytest
from differential.dataflash_logs import generated
from differential.dataflash_transcript import WAYS
from real_logs import each_log

NAMES = [
    "kinds0.bin", "kinds1.bin", "kinds2.bin", "flight.bin", "no_units.bin", "no_fix.bin",
    "back.bin", "text0.log", "text1.log",
]  # fmt: skip


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The generated logs."""
    made = tmp_path_factory.mktemp("dataflash")
    assert [path.name for path in generated(made)] == NAMES
    return made


def transcript(package: str, ways: str, path: Path) -> list[str]:
    """The lines of one package, in a process and a home of its own."""
    keep = {k: v for k, v in os.environ.items() if not k.startswith(("MAV", "MDEF"))}
    keep["PYTHONPATH"] = os.pathsep.join(
        filter(None, [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH")])
    )
    keep |= {"HOME": str(Path(__file__).parent), "PYTHONIOENCODING": "utf-8:backslashreplace"}
    command = [sys.executable, "-m", "differential.dataflash_transcript", package, ways, str(path)]
    run = subprocess.run(command, capture_output=True, env=keep, timeout=250, check=False)
    assert run.returncode == 0, run.stderr.decode()[-2000:]
    return run.stdout.decode().splitlines()


def compare(subject: str, oracle: str, path: Path, *but: str) -> None:
    """All ways but some give the same lines."""
    ways = ",".join(way for way in WAYS if way not in but)
    ours, theirs = transcript(subject, ways, path), transcript(oracle, ways, path)
    for number, (our, their) in enumerate(zip_longest(ours, theirs), 1):
        assert our == their, f"line {number} of {path.name}"
    assert len(ours) > 100


@pytest.mark.parametrize("name", NAMES)
def test_generated_log(name: str, directory: Path, subject: str, oracle: str) -> None:
    has_types = name.startswith(("flight", "no_", "back"))
    compare(subject, oracle, directory / name, *(() if has_types else ("condition",)))


@each_log("*.BIN", "*.log")
def test_real_log(path: Path, subject: str, oracle: str) -> None:
    # In text logs pymavlink applies units from the line on that tells them.
    compare(subject, oracle, path, *(("verbose",) if path.suffix == ".log" else ()))
