"""Processes of the command line, and what they say."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mavwire import mavutil
from unit.bridge_tools import LIMIT

PACKAGE_FOLDER = str(Path(mavutil.__file__).parents[1])


@contextmanager
def mavwire(
    *arguments: str, env: dict[str, str] | None = None
) -> Iterator[tuple[subprocess.Popen[str], queue.Queue[str]]]:
    """A `mavwire` process, and the lines of its standard error."""
    process = subprocess.Popen(
        [sys.executable, "-m", "mavwire", *arguments],
        env={**os.environ, "PYTHONPATH": PACKAGE_FOLDER, **(env or {})},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    lines: queue.Queue[str] = queue.Queue()

    def collect() -> None:
        assert process.stderr is not None
        for line in process.stderr:
            lines.put(line.rstrip())

    thread = threading.Thread(target=collect)
    thread.start()
    try:
        yield process, lines
    finally:
        process.kill()
        process.wait()
        thread.join()
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        process.stderr.close()


def announced_ports(lines: queue.Queue[str]) -> list[int]:
    """The ports in the line that tells what is routed."""
    while True:
        line = lines.get(timeout=LIMIT)
        if line.startswith("routing between "):
            links = line.removeprefix("routing between ").partition(";")[0]
            return [int(link.rpartition(":")[2]) for link in links.split(", ")]
