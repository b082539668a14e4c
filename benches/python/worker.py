"""Measures one package in a process of its own: reads case names from stdin, writes one JSON line
for each.

The driver starts a worker for every package, pins all of them to the same processor and lets them
work in turn, so that all packages see the same machine in the same minutes.
"""

from __future__ import annotations

import gc
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import cases
from corpus import Corpus


def measure(job: cases.Job, seconds: float) -> dict[str, float]:
    """Microseconds of CPU and of wall time for each message, over at least so many seconds."""
    cpu = wall = 0.0
    runs = 0
    gc.collect()
    while runs == 0 or wall < seconds:
        state = job.prepare()
        cpu_before, wall_before = time.process_time(), time.perf_counter()
        result = job.run(state)
        wall += time.perf_counter() - wall_before
        cpu += time.process_time() - cpu_before
        runs += 1
        if result != job.expect:
            raise AssertionError(f"the work gave {result!r} and not {job.expect!r}")
        del state
    per = 1e6 / (runs * job.count)
    return {"cpu": cpu * per, "wall": wall * per, "count": job.count, "runs": runs}


def main() -> None:
    package, folder, messages, processor, seconds = sys.argv[1:]
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {int(processor)})
    side = cases.Side(package)
    corpus = Corpus(Path(folder), int(messages))
    digests: dict[str, Any] = {}
    for line in sys.stdin:
        name = line.strip()
        try:
            job = cases.CASES[name](side, corpus)
            if name not in digests:
                digests[name] = job.digest()
            answer = measure(job, float(seconds)) | {"digest": digests[name]}
        except ImportError as error:
            answer = {"unavailable": f"{type(error).__name__}: {error}"}
        except Exception as error:
            answer = {"failed": f"{type(error).__name__}: {error}"}
        job = None  # type: ignore[assignment]  # its messages are not to be there in the next case
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
