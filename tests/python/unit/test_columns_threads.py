"""How many threads logs are read with, and that more than anybody needs do no harm."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from mavwire import traffic

pytestmark = pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="counts threads")

PROGRAM = """
import os, sys, mavwire
before = len(os.listdir("/proc/self/task"))
rows = len(mavwire.read(sys.argv[1], "ATTITUDE")["ATTITUDE"])
print(rows, len(os.listdir("/proc/self/task")) - before)
"""
ALLOWED = max(64, 4 * (os.cpu_count() or 1))


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("threads") / "flight.tlog"
    traffic.generate(path, 40_000)
    return str(path)


def read_with(asked: str, log: str) -> tuple[int, int]:
    environment = {**os.environ, "RAYON_NUM_THREADS": asked}
    command = [sys.executable, "-c", PROGRAM, log]
    done = subprocess.run(command, env=environment, capture_output=True, timeout=60, check=True)
    rows, threads = map(int, done.stdout.split())
    return rows, threads


@pytest.mark.parametrize("asked", [1, 2, 8, 64])
def test_there_are_as_many_as_are_asked_for(asked: int, log: str) -> None:
    rows, threads = read_with(str(asked), log)
    assert rows > 0 and threads == asked


@pytest.mark.parametrize("asked", [5000, 100_000, 2**63])
def test_thousands_are_bounded(asked: int, log: str) -> None:
    assert read_with(str(asked), log) == (read_with("1", log)[0], ALLOWED)


@pytest.mark.parametrize("asked", ["0", "", "many", "-3", str(10**30)])
def test_what_is_no_number_of_threads_is_none(asked: str, log: str) -> None:
    rows, threads = read_with(asked, log)
    assert rows > 0 and 0 < threads <= ALLOWED


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_is_heard_with_thousands(number: int, log: str, tmp_path: Path) -> None:
    several = [str(tmp_path / f"{n}.tlog") for n in range(200)]
    for one in several:
        os.link(log, one)
    command = [sys.executable, "-m", "mavwire", "convert", *several, "-o", str(tmp_path / "out")]
    environment = {**os.environ, "RAYON_NUM_THREADS": "5000"}
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        while not (tmp_path / "out" / "manifest.journal").exists():  # until it is at work
            assert process.poll() is None
        process.send_signal(number)
        assert process.wait(30) == 130
