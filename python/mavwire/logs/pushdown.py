"""What a filter of polars says of times and senders, so that no more than that is decoded.

A filter is understood by its serialised form, which other versions of polars may write otherwise.
What is not understood is left to polars, which filters all that it gets.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from .selection import MAX_SYSTEM, record_seconds

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .selection import Selection

MIRRORED = {"Gt": "Lt", "GtEq": "LtEq", "Lt": "Gt", "LtEq": "GtEq", "Eq": "Eq"}
"""Comparisons, and what they are with their sides exchanged."""
EXACT = 1 << 53
"""Microseconds, those of the year 2255; the seconds of later times are too coarse for a bound."""
NANOSECONDS = {"Nanoseconds": 1, "Microseconds": 1_000, "Milliseconds": 1_000_000}


def narrow(selection: Selection, predicate: Any) -> None:
    """Take over what a filter says of `timestamp` and `sysid`."""
    for column, operator, literal in _comparisons(predicate):
        if column == "timestamp" and (seconds := _seconds(literal)) is not None:
            _limit(selection, operator, seconds)
        elif column == "sysid" and operator == "Eq":
            numbers = _integers(_literal(literal))
            wanted = numbers[0] if len(numbers) == 1 else -1
            if 0 <= wanted <= MAX_SYSTEM and (
                selection.systems is None or wanted in selection.systems
            ):
                selection.systems = [wanted]


def _limit(selection: Selection, operator: str, seconds: float) -> None:
    if operator in ("Gt", "GtEq", "Eq"):
        selection.start = seconds if selection.start is None else max(selection.start, seconds)
    if operator in ("Lt", "LtEq", "Eq"):
        # The end itself does not belong to what is read, and the filter may include it.
        after = seconds + 1e-3
        selection.end = after if selection.end is None else min(selection.end, after)


def _comparisons(predicate: Any) -> Iterator[tuple[str, str, Any]]:
    """Column, operator and literal of comparisons that all must hold."""
    import warnings

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = json.loads(predicate.meta.serialize(format="json"))
    except Exception:  # a form that this polars cannot write; the filter holds all the same
        return
    stack = [tree]
    while stack:
        node = stack.pop()
        if not isinstance(node, dict):
            continue
        if isinstance(inner := node.get("BinaryExpr"), dict):
            operator, left, right = (inner.get(key) for key in ("op", "left", "right"))
            if operator in ("And", "LogicalAnd"):
                stack += [left, right]
            elif operator in MIRRORED:
                yield from _compared(left, operator, right)
                yield from _compared(right, MIRRORED[operator], left)
        elif isinstance(inner := node.get("Function"), dict):
            yield from _between(inner)


def _compared(column: Any, operator: str, literal: Any) -> Iterator[tuple[str, str, Any]]:
    if isinstance(column, dict) and isinstance(name := column.get("Column"), str):
        yield name, operator, literal


def _between(function: dict[str, Any]) -> Iterator[tuple[str, str, Any]]:
    """`is_between`, whose bounds are taken as included."""
    inputs = function.get("input")
    if "IsBetween" in json.dumps(function.get("function")) and isinstance(inputs, list):
        column, low, high = inputs
        yield from _compared(column, "GtEq", low)
        yield from _compared(column, "LtEq", high)


def _literal(node: Any) -> Any:
    """What a literal holds; None for any other expression, whose value is not known here."""
    return node["Literal"] if isinstance(node, dict) and node.keys() == {"Literal"} else None


def _seconds(literal: Any) -> float | None:
    """The time of a literal of type datetime."""
    node = _literal(literal)
    text = json.dumps(node)
    if '"DateTime"' not in text and '"Datetime"' not in text:
        return None
    numbers = _integers(node)
    units = [factor for name, factor in NANOSECONDS.items() if name in text]
    if len(numbers) != 1 or len(units) != 1:
        return None
    micros = numbers[0] * units[0] // 1_000
    return record_seconds(micros) if abs(micros) <= EXACT else None


def _integers(node: Any) -> list[int]:
    if isinstance(node, bool):
        return []
    if isinstance(node, int):
        return [node]
    values = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return [number for value in values for number in _integers(value)]
