"""Ordinary expressions through mavwire and through pymavlink's evaluator."""

from __future__ import annotations

import math
import random
import warnings
from typing import Any

import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    oracle = pytest.importorskip("pymavlink.mavexpression", reason="pymavlink is not installed")

from mavwire.expression import evaluate_expression

R = random.Random(11)


class Message:
    """A message with fields and instances."""

    def __init__(self, **fields: Any) -> None:
        self.__dict__.update(fields)

    def __getitem__(self, instance: int) -> Any:
        if instance != 1:
            raise IndexError
        return self


MESSAGES = {
    "ATT": Message(Roll=1.5, Yaw=-200, text="AUTO", list=[1, 2, 3]),
    "GPS": Message(Status=3, Lat=-35.2, Lng=149.1, Alt=580.0),
    "n": 0,
    "x": 2.5,
}

ATOMS = (
    *("ATT.Roll", "ATT.Yaw", "GPS.Alt", "x", "n", "3", "0.25", "ATT.list[1]", "ATT[1].Roll", "pi"),
    *("len(ATT.list)", "NOPE.x", "ATT[2].Roll", "ATT.nope", "ATT.list[7]", "ATT.text", "True"),
)
BINARY = "+ - * / // % < <= > >= == != and or & | ^ << >>".split()
CALLS = ("abs", "sqrt", "sin", "floor", "wrap_180", "degrees", "max", "min", "str", "int", "round")


def expression(depth: int) -> str:
    if depth == 0 or R.random() < 0.2:
        return R.choice(ATOMS)
    kind = R.randrange(7)
    part = expression(depth - 1)
    if kind < 3:
        return f"({part} {R.choice(BINARY)} {expression(depth - 1)})"
    if kind == 3:
        return f"{R.choice(CALLS)}({part})"
    if kind == 4:
        return f"({part} if {expression(depth - 1)} else {expression(depth - 1)})"
    if kind == 5:
        return f"({R.choice(('-', '+', 'not ', '~'))}{part})"
    return f"max({part}, {expression(depth - 1)})"


def outcome(evaluate: Any, text: str, nocondition: bool) -> tuple[str, str]:
    try:
        value = evaluate(text, MESSAGES, nocondition)
    except Exception as error:
        return type(error).__name__, str(error)
    if isinstance(value, float) and math.isnan(value):
        return "value", "nan"
    return "value", repr(value)


def test_same_as_pymavlink() -> None:
    values = 0
    for _ in range(6000):
        text = expression(R.randrange(1, 4))
        if R.random() < 0.3:
            text += "{" + expression(2) + "}"
        nocondition = R.random() < 0.2
        theirs = outcome(oracle.evaluate_expression, text, nocondition)
        assert outcome(evaluate_expression, text, nocondition) == theirs, text
        values += theirs[0] == "value" and theirs[1] != "None"
    assert values > 1500  # most texts mean something
