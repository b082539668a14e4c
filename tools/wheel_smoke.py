"""Use an installed mavwire that has nothing beside it: no package of the extras, no compiler.

Run by tools/check_wheel.py in a fresh environment; `--with-compiler` where it was built from source.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import mavwire
from mavwire import mavutil, traffic
from mavwire.sim import Vehicle

MESSAGES = 2000


def main() -> None:
    """AssertionError or CalledProcessError where something does not work."""
    assert "--with-compiler" in sys.argv or shutil.which("cargo") is shutil.which("rustc") is None
    assert Path(mavwire.__file__).is_relative_to(sys.prefix), mavwire.__file__
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        use(Path("flight.tlog"))
        os.chdir(os.sep)


def use(log: Path) -> None:
    """A log is made, read, converted and shown; a vehicle flies."""
    traffic.generate(log, MESSAGES)
    with mavutil.mavlink_connection(str(log)) as link:
        count = 0
        while link.recv_match() is not None:
            count += 1
    assert count == MESSAGES, count
    mavwire.open_log(log)["ATTITUDE"].write("attitude.parquet")
    assert Path("attitude.parquet").read_bytes()[:4] == b"PAR1"
    assert Vehicle().step(5.0), "a vehicle that says nothing"
    assert str(mavwire.__version__) in run("mavwire", "--version")
    assert f"{MESSAGES:,} messages" in run("mavwire", "info", str(log))
    assert run("mavwire", "dump", "--types", "HEARTBEAT", str(log)).count("HEARTBEAT")
    assert "roll" in run("mavwire", "definitions", "show", "ATTITUDE")


def run(*command: str) -> str:
    """The output of a command."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
