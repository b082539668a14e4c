"""Reading logs in a process that was forked, as multiprocessing does by default on Linux."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest
from mavwire import traffic

PROGRAM = """
import os, sys
import mavwire
from mavwire.logs.conversion import convert

log, out = sys.argv[1:]

def work(name):
    table = mavwire.read(log, "ATTITUDE", enums="names")["ATTITUDE"]
    table.write(f"{out}/{name}.parquet")
    for kind in ("parquet", "mcap"):
        (row,) = convert([log], f"{out}/{name}-{kind}", format=kind)
        assert row.error is None, row.error
    return len(table), mavwire.open_log(log).info().messages

def forked(name, children):
    child = os.fork()
    if child == 0:
        status = 1
        try:
            assert work(name) == expected
            if children:
                forked(f"{name}-child", children - 1)
            status = 0
        finally:
            os._exit(status)
    _, status = os.waitpid(child, 0)
    assert status == 0, status

expected = work("parent")
forked("child", 1)
assert work("parent-again") == expected
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_children_have_threads_of_their_own(tmp_path):
    log = tmp_path / "flight.tlog"
    traffic.generate(log, 3_000)
    command = [sys.executable, "-W", "ignore", "-c", PROGRAM, str(log), str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True) as process:
        try:
            errors = process.communicate(timeout=60)[1]
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            pytest.fail("a forked process hangs")
    assert process.returncode == 0, errors.decode()
    assert (tmp_path / "child-child.parquet").exists()
