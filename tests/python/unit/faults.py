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
