"""Programs in processes of their own, under limits, for the tests of faults."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from mavwire import mavutil
from unit.bridge_tools import LIMIT

HERE = Path(__file__).parents[1]
ENVIRONMENT = {
    **os.environ,
    "PYTHONPATH": os.pathsep.join([str(HERE), str(Path(mavutil.__file__).parents[1])]),
}

# `child` runs in each fork, and `parent` once they have ended; a child that hangs ends by its alarm. Python's own rule
# holds: no other thread may be in the middle of an import when a process forks, so what threads do is done once before.
FORKS = """
import faulthandler, os, signal, sys, threading
os.environ["MAVLINK20"] = "1"
import mavwire
from mavwire import aio, mavutil
path = sys.argv[1]
def connect(device):
    return mavutil.mavlink_connection(device)
def udp():
    link = connect("udpin:127.0.0.1:0")
    return link, connect(f"udpout:127.0.0.1:{link.port.getsockname()[1]}")
def count(log):
    return sum(1 for _ in iter(log.recv_msg, None))
def forks(child, parent=lambda: None, times=1):
    for _ in range(times):
        pid = os.fork()
        if pid == 0:
            faulthandler.dump_traceback_later(50)
            signal.alarm(60)
            code = 1
            try:
                child()
                code = 0
            except BaseException:
                import traceback
                traceback.print_exc()
            os._exit(code)
        assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    parent()
"""


def python(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a program to its end."""
    return run([sys.executable, "-c", program, *arguments])


def mavwire(*arguments: str, before: str = "") -> subprocess.CompletedProcess[str]:
    """Run a command to its end; `before` are words of the shell that come first, such as `ulimit -f 8`."""
    command = [sys.executable, "-m", "mavwire", *arguments]
    if before:
        command = ["sh", "-c", f'{before} && exec "$@"', "sh", *command]
    return run(command)


def run(command: list[str]) -> subprocess.CompletedProcess[str]:
    """Run a command to its end."""
    return subprocess.run(
        command, env=ENVIRONMENT, capture_output=True, text=True, timeout=2 * LIMIT, check=False
    )


def files(folder: Path) -> list[str]:
    """Names of all files in a folder and those below it."""
    return sorted(str(one.relative_to(folder)) for one in folder.rglob("*") if one.is_file())
