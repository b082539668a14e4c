"""The expressions of `recv_match(condition=...)`, by way of the safe evaluator.

The evaluator and the function library behind it load when the first condition is used.
"""

from __future__ import annotations

from . import Any, state


def evaluate_expression(expression: str, vars: dict[str, Any], nocondition: bool = False) -> Any:
    """The value of `expression` over the names in `vars`, or None where it has none yet."""
    # mavutil's, since a program may replace it there.
    evaluator = getattr(state.public, "mavexpression", None)
    if evaluator is None:
        evaluator = state.import_module("mavwire.mavexpression")
    return evaluator.evaluate_expression(expression, vars, nocondition)


def evaluate_condition(condition: str | None, vars: dict[str, Any]) -> Any:
    """True without a condition, False where the condition has no value, else its raw value."""
    if condition is None:
        return True
    value = evaluate_expression(condition, vars)
    return False if value is None else value
