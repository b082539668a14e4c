"""``EXPR`` and ``EXPR{COND}``: from a text to a value, with pymavlink's outcomes.

None means "no value now": the condition does not hold or fails, a message has not been seen,
a division by zero, an instance or item that is not there. Other errors are the caller's to see.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from mavwire.expression.compiler import compile_text
from mavwire.expression.comprehension import Closure
from mavwire.expression.limits import MAX_ITEMS, Budget, ExpressionError

_NO_VALUE_NOW = (NameError, ZeroDivisionError, IndexError)

Program = tuple[Closure, Closure | None]
"""The closures of a value and of its condition."""


def _split(expression: str) -> tuple[str, str | None]:
    """The parts EXPR and COND; COND is None without braces at the end."""
    if not expression.endswith("}"):
        return expression, None
    start = expression.rfind("{")
    # a brace that was never opened makes the condition one that cannot be read
    return (expression[:start], expression[start + 1 : -1]) if start >= 0 else (expression, "")


def _nothing(variables: Any, budget: Budget) -> None:
    """The closure of an expression whose condition cannot be read."""
    return None


def _compile_or_raise_later(text: str) -> Closure:
    """A syntax error behind a condition shows once the condition holds."""
    try:
        return compile_text(text)
    except SyntaxError as error:
        caught = error

        def fail(variables: Any, budget: Budget) -> Any:
            raise caught

        return fail


@lru_cache(maxsize=512)
def _program(expression: str) -> Program:
    if not isinstance(expression, str):
        raise TypeError(f"an expression is a str, not {type(expression).__name__}")
    if not expression:
        raise IndexError("string index out of range")  # the empty expression, as in pymavlink
    text, condition = _split(expression)
    if condition is None:
        return compile_text(text), None
    try:
        holds = compile_text(condition)
    except SyntaxError:
        return _nothing, None
    return _compile_or_raise_later(text), holds


def evaluate_expression(expression: str, vars: Mapping[str, Any], nocondition: bool = False) -> Any:
    """The value of ``expression`` over ``vars`` (messages by name), or None if it has none now.

    ``EXPR{COND}`` has a value where COND is true; ``nocondition`` asks for it where false as well.
    NameError, ZeroDivisionError and IndexError give None, any failure of COND does; other
    exceptions (AttributeError, KeyError, TypeError, SyntaxError, ...) are raised, ExpressionError
    among them for what an expression may not do. An empty expression raises IndexError.
    """
    value, condition = _program(expression)
    variables = {} if vars is None else vars
    budget: Budget = [MAX_ITEMS]
    if condition is not None:
        try:
            holds = condition(variables, budget)
        except ExpressionError:
            raise
        except Exception:
            return None
        if not holds and not nocondition:
            return None
    try:
        return value(variables, budget)
    except _NO_VALUE_NOW:
        return None


def evaluate_condition(condition: str | None, vars: Mapping[str, Any]) -> Any:
    """The value of a condition, usually a bool: True for no condition, False for no value."""
    if condition is None:
        return True
    value = evaluate_expression(condition, vars)
    return False if value is None else value
