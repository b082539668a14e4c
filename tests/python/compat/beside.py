"""Runs a program with mavwire and with pymavlink, each in a process and a folder of its own, and
compares what it prints.

A program finds the package's name in `pkg`; `show(text)` runs an expression and prints it with its
value, or with the class of the exception it raises.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mavwire

PACKAGE_FOLDER = str(Path(mavwire.__file__).parent.parent)

PRELUDE = """
import importlib, sys, warnings
warnings.simplefilter("ignore")
pkg = sys.argv[1]
sys.excepthook = lambda kind, value, trace: print("UNCAUGHT", kind.__name__, value)

def load(name):
    return importlib.import_module(pkg + "." + name)

def write(name, text):
    with open(name, "w", newline="") as file:
        file.write(text)
    return name

def show(text, values=None):
    try:
        result = repr(eval(text, globals() | (values or {})))
    except Exception as error:
        result = "RAISES " + type(error).__name__
    print(text, "->", result.replace(pkg, "PACKAGE"))
"""


def output(package: str, program: str, folder: Path, mavlink20: bool = True) -> list[str]:
    """The lines that a program prints; its own failure is the last one."""
    folder.mkdir()
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER, "TZ": "UTC"}
    for name in ("MAVLINK20", "MAVLINK_DIALECT"):  # pymavlink sets them where it runs
        environment.pop(name, None)
    if mavlink20:
        environment["MAVLINK20"] = "1"
    run = subprocess.run(
        [sys.executable, "-c", PRELUDE + program, package],
        capture_output=True, text=True, env=environment, cwd=folder, timeout=120, check=False,
    )  # fmt: skip
    return run.stdout.splitlines()


def assert_same(program: str, folder: Path, oracle: str, mavlink20: bool = True) -> None:
    """Both packages print the same lines, and some."""
    ours = output("mavwire", program, folder / "ours", mavlink20)
    theirs = output(oracle, program, folder / "theirs", mavlink20)
    assert ours == theirs
    assert ours
    assert not any(line.startswith("UNCAUGHT") for line in ours)
