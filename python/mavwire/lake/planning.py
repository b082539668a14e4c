"""Planning: which logs a run has to do, and in which parts."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass

from mavwire._text import in_words
from mavwire.fleet.grouping import grouped
from mavwire.logs.manifest import Converted

from .ledger import Ledger

PART_BYTES = 1 << 30
"""Bytes of logs that are committed together: their rows share files."""

Shard = tuple[int, int]
"""The number of a job, from 1 on, and of how many."""


@dataclass(frozen=True)
class Task:
    """A log to do."""

    path: str
    size: int
    mtime_ns: int
    digest: str = ""
    """That of its rows in the lake, if it has any there."""


@dataclass
class Plan:
    """The work of a run: the parts to read, and the logs that need no reading."""

    parts: list[list[Task]]
    rows: dict[str, Converted]
    """Logs that are in the lake as they are, and those that cannot be read."""


def plan(
    found: Mapping[str, tuple[int, int] | Exception],
    ledger: Ledger,
    workers: int,
    part_bytes: int,
) -> Plan:
    """The parts for logs with their sizes and times, or why these cannot be had."""
    rows: dict[str, Converted] = {}
    todo: list[tuple[Task, int]] = []
    for path, status in found.items():
        known = ledger.rows.get(path)
        if isinstance(status, Exception):
            rows[path] = Converted(path, "", error=in_words(status, path))
        elif known is None or (known.error is not None and not known.rows):
            todo.append((Task(path, *status), status[0]))
        elif status != (known.size, known.mtime_ns):
            todo.append((Task(path, *status, known.digest), status[0]))
        else:
            rows[path] = known
            known.skipped = True
    total = sum(size for _, size in todo)
    return Plan(grouped(todo, min(part_bytes, total // workers + 1)), rows)


def of_shard(logs: list[str], shard: Shard | None) -> list[str]:
    """The logs of one job of several. A log keeps its job in later runs: others make no difference."""
    if shard is None:
        return logs
    number, jobs = shard
    if not 1 <= number <= jobs:
        raise ValueError(f"a shard is one of 1/{jobs} to {jobs}/{jobs}, not {number}/{jobs}")
    return [
        one for one in logs if zlib.crc32(one.encode(errors="surrogateescape")) % jobs == number - 1
    ]
