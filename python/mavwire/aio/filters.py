"""Which messages a reader wants: by type, sender and condition."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from mavwire.links.conditions import evaluate_condition

Wants = Callable[[Any], object]


def message_filter(
    sync: Any,
    type: str | Iterable[str] | None = None,
    condition: str | None = None,
    sysid: int | None = None,
    compid: int | None = None,
) -> Wants | None:
    """A function that says whether a message is wanted; None if every message is."""
    tests: list[Wants] = []
    if type is not None:
        names = frozenset((type,) if isinstance(type, str) else type)
        tests.append(lambda msg: msg.get_type() in names)
    if sysid is not None:
        tests.append(lambda msg: msg.get_srcSystem() == sysid)
    if compid is not None:
        tests.append(lambda msg: msg.get_srcComponent() == compid)
    if condition is not None:
        tests.append(lambda msg: _holds(sync, condition, msg))
    if len(tests) < 2:
        return tests[0] if tests else None
    return lambda msg: all(test(msg) for test in tests)


def _holds(sync: Any, condition: str, msg: Any) -> object:
    """Whether `condition` holds over the messages of the sender.

    The link may have received a newer message of the type since. The condition is about `msg`.
    """
    states = getattr(sync, "sysid_state", None)
    messages = sync.messages if states is None else states[msg.get_srcSystem()].messages
    return evaluate_condition(condition, {**messages, msg.get_type(): msg})
