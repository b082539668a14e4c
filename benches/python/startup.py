"""Costs that need a process of their own: importing, memory for messages that are kept, the command
line tools.

CPU time is what the operating system counts for the child, so the interpreter's start is part of
it; a run that does nothing is measured as well and taken off.
"""

from __future__ import annotations

import hashlib
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from corpus import Corpus

# Not ru_maxrss: a child starts with its parent's there, this is the image that runs.
RSS = "print(open('/proc/self/status').read().split('VmHWM:')[1].split()[0])"
KEEP = """
import gc, sys
sys.path.insert(0, {here!r})
import cases, corpus
side = cases.Side({package!r})
pieces = corpus.chunks(open({stream!r}, "rb").read(), 1 << 16)
warm = list(cases.parse(side.parser(), pieces[:2]))
del warm
gc.collect()
def resident():
    return int(open('/proc/self/statm').read().split()[1]) * 4096
before = resident()
kept = list(cases.parse(side.parser(), pieces))
gc.collect()
print((resident() - before) / len(kept))
"""


def environment() -> dict[str, str]:
    """Without the variables that the packages read."""
    return {k: v for k, v in os.environ.items() if not k.startswith(("MAV", "MDEF", "PYTHON"))}


def child(
    command: list[str], processor: int, folder: str | None = None
) -> tuple[float, float, bytes]:
    """CPU seconds, wall seconds and output of a program that works in `folder`."""

    def pin() -> None:
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(0, {processor})

    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(
        command, check=True, cwd=folder, env=environment(), preexec_fn=pin, stdout=subprocess.PIPE
    )
    wall = time.perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu, wall, done.stdout


def import_cost(module: str, processor: int, runs: int) -> dict[str, float]:
    """Milliseconds of CPU and megabytes that importing a module adds to bare Python, and the dialect of
    `mavutil`, which mavwire loads when a program asks for it.
    """
    samples: dict[str, list[tuple[float, float]]] = {"": [], module: []}
    for _ in range(runs):
        for name, kept in samples.items():
            code = f"import {name} as m; getattr(m, 'mavlink', None); {RSS}" if name else RSS
            cpu, _, out = child([sys.executable, "-c", code], processor)
            kept.append((cpu * 1e3, int(out) / 1024))
    bare, full = (
        [median(column) for column in zip(*samples[name], strict=True)] for name in samples
    )
    return {"ms": full[0] - bare[0], "mb": full[1] - bare[1]}


def kept_bytes(package: str, corpus: Corpus, processor: int) -> float:
    """Bytes of memory for every message of a list of messages."""
    here, stream = str(Path(__file__).parent), str(corpus.folder / "stream.raw")
    code = KEEP.format(here=here, package=package, stream=stream)
    return float(child([sys.executable, "-c", code], processor)[2])


def dump_command(package: str, path: str, form: str) -> list[str]:
    """The command that prints a log."""
    if package == "mavwire":
        return [sys.executable, "-m", "mavwire", "dump", "--format", form, path]
    tool = Path(sys.executable).parent / "mavlogdump.py"
    return [sys.executable, str(tool), "--format", form, path]


def dump_cost(package: str, corpus: Corpus, form: str, processor: int) -> dict[str, Any]:
    """Microseconds a message for printing a log, the start of the program taken off, and the digest
    of the output.
    """
    start, start_wall, _ = child(dump_command(package, corpus.short, form), processor)
    cpu, wall, out = child(dump_command(package, corpus.tlog, form), processor)
    per = 1e6 / corpus.messages
    return {
        "cpu": (cpu - start) * per,
        "wall": (wall - start_wall) * per,
        "digest": hashlib.sha256(out).hexdigest(),
        "lines": out.count(b"\n"),
    }


if __name__ == "__main__":
    print(json.dumps(import_cost(sys.argv[1], 0, 5)))
