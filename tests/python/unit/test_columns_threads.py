"""How many threads logs are read with."""

from __future__ import annotations

import os
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


@pytest.mark.parametrize("asked", ["0", "", "many", "-3", str(10**30)])
def test_what_is_no_number_of_threads_is_none(asked: str, log: str) -> None:
    rows, threads = read_with(asked, log)
    assert rows > 0 and 0 < threads <= (os.cpu_count() or 1)
