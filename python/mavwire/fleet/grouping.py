"""How much work is a task: small logs together, parts of large ones."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from .places import is_url

TASK_BYTES = 128 << 20
"""Bytes of logs that are worth a task: less costs more to hand out than to do."""
TASKS_FOR_A_WORKER = 4
"""Tasks that each worker should have where there is little work, so that none is idle."""

Item = TypeVar("Item")


def check_at_least_1(**numbers: int | None) -> None:
    """ValueError for the name of an argument that is neither None nor a number of 1 or more."""
    for name, number in numbers.items():
        try:
            enough = number is None or number >= 1
        except TypeError:
            enough = False
        if not enough:
            raise ValueError(f"{name} must be at least 1, not {number!r}")


def may_be_cut(path: str, size: int, task_bytes: int) -> bool:
    """Whether a log is large enough for two tasks, and can be read in parts. One on an object store
    would have to be fetched twice.
    """
    return size >= 2 * task_bytes and not is_url(path)


def grouped(items: Iterable[tuple[Item, int]], task_bytes: int) -> list[list[Item]]:
    """Items with their sizes, in order, in groups that reach `task_bytes` where enough follow."""
    groups: list[list[Item]] = []
    room = 0
    for item, size in items:
        if room <= 0:
            groups.append([])
            room = task_bytes
        groups[-1].append(item)
        room -= size
    return groups


def group_bytes(total: int, workers: int, task_bytes: int) -> int:
    """How large groups of small logs are: less than a task where workers would be idle."""
    return min(task_bytes, total // (workers * TASKS_FOR_A_WORKER) + 1)
