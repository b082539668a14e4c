"""``EXPR`` and ``EXPR{COND}``: from a text to a value, with pymavlink's outcomes.

None stands for "no value now": the condition does not hold or fails, a message has not been seen,
a division by zero, an instance or item that is not there. Other errors are the caller's to see.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from mavwire.expression.compiler import Compiled, compile_text
from mavwire.expression.limits import ExpressionError

_NO_VALUE_NOW = (NameError, ZeroDivisionError, IndexError)

Program = Callable[[Any, bool], Any]


def _split(expression: str) -> tuple[str, str | None]:
    """The parts EXPR and COND; COND is None without braces at the end."""
    if not expression.endswith("}"):
        return expression, None
    start = expression.rfind("{")
    # a brace that was never opened makes the condition one that cannot be read
    return (expression[:start], expression[start + 1 : -1]) if start >= 0 else (expression, "")


def _nothing(variables: Any, nocondition: bool) -> None:
    """The program of an expression whose condition cannot be read."""
    return None


def _plain(compiled: Compiled) -> Program:
    value, budget = compiled

    def run(variables: Any, nocondition: bool) -> Any:
        try:
            return value(variables, budget)
        except _NO_VALUE_NOW:
            return None

    return run


def _conditional(compiled: Compiled, holding: Compiled) -> Program:
    value, budget = compiled
    condition, own_budget = holding

    def run(variables: Any, nocondition: bool) -> Any:
        try:
            holds = condition(variables, own_budget)
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

    return run


def _compile_or_raise_later(text: str) -> Compiled:
    """A syntax error behind a condition shows once the condition holds."""
    try:
        return compile_text(text)
    except SyntaxError as error:
        caught = error

        def fail(variables: Any, budget: Any) -> Any:
            raise caught

        return fail, None


@lru_cache(maxsize=512)
def _program(expression: str) -> Program:
    if not isinstance(expression, str):
        raise TypeError(f"an expression is a str, not {type(expression).__name__}")
    if not expression:
        raise IndexError("string index out of range")  # the empty expression, as in pymavlink
    text, condition = _split(expression)
    if condition is None:
        return _plain(compile_text(text))
    try:
        holds = compile_text(condition)
    except SyntaxError:
        return _nothing
    return _conditional(_compile_or_raise_later(text), holds)


def evaluate_expression(expression: str, vars: Mapping[str, Any], nocondition: bool = False) -> Any:
    """The value of ``expression`` over ``vars`` (messages by name), or None if it has none now.

    ``EXPR{COND}`` has a value where COND is true; ``nocondition`` asks for it where false as well.
    NameError, ZeroDivisionError and IndexError give None, any failure of COND does; other
    exceptions (AttributeError, KeyError, TypeError, SyntaxError, ...) are raised, ExpressionError
    among them for what an expression may not do. An empty expression raises IndexError.
    """
    return _program(expression)({} if vars is None else vars, nocondition)


def evaluate_condition(condition: str | None, vars: Mapping[str, Any]) -> Any:
    """The value of a condition, usually a bool: True for no condition, False for no value."""
    if condition is None:
        return True
    value = _program(condition)({} if vars is None else vars, False)
    return False if value is None else value
