"""Ground stations as programs: installed or not, started, waited for, ended."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

WAIT = 60.0
TIMEOUT = 150
INSTALL = "make test installs requirements/peers.txt where it can"


def needs(*packages: str) -> pytest.MarkDecorator:
    """Skips where a program that the test talks with is not installed."""
    missing = [name for name in packages if importlib.util.find_spec(name) is None]
    return pytest.mark.skipif(
        bool(missing), reason=f"{', '.join(missing)} not installed: {INSTALL}"
    )


def command(under: str, script: str, *arguments: str) -> list[str]:
    """How a script is run on the package `under`; skips while mavwire lacks modules it imports."""
    if under == "pymavlink":
        return [sys.executable, script, *arguments]
    for name in ("mavwp", "mavparm"):
        if importlib.util.find_spec(f"mavwire.{name}") is None:
            pytest.skip(f"the program imports pymavlink.{name}, and there is no mavwire.{name} yet")
    return [sys.executable, "-m", "mavwire", "run", script, *arguments]


def report(arguments: Sequence[str]) -> Any:
    """Run a station to its end; the JSON of its last line. What it started ends with it, for a
    server that is left behind would keep the pipes open.
    """
    process = subprocess.Popen(
        arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        out, err = process.communicate(timeout=TIMEOUT)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 0, err.splitlines()[-1:]
    return json.loads(out.splitlines()[-1])


def wait_until(condition: Callable[[], object], what: str) -> None:
    """Poll until `condition()` holds."""
    deadline = time.monotonic() + WAIT
    while not condition():
        assert time.monotonic() < deadline, f"not within {WAIT:.0f} s: {what}"
        time.sleep(0.02)


class Console:
    """A program that is driven by lines on its standard input; its output collects in `text`."""

    def __init__(self, arguments: list[str], folder: Path) -> None:
        self.text = ""
        self._process = subprocess.Popen(
            arguments,
            cwd=folder, env={**os.environ, "PYTHONUNBUFFERED": "1", "HOME": str(folder)},
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, bufsize=0,
        )  # fmt: skip
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        while data := self._process.stdout.read(4096):
            self.text += data.decode(errors="replace")

    def say(self, line: str) -> None:
        """Type a line."""
        assert self._process.stdin is not None
        self._process.stdin.write(line.encode() + b"\n")

    def expect(self, text: str) -> None:
        """Wait until the program has printed `text`."""
        wait_until(lambda: text in self.text, f"{text!r} in {self.text[-500:]!r}")

    def __enter__(self) -> Console:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        self._reader.join()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
