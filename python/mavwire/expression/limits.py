"""What an expression may cost, and the operators and functions that could cost more.

An expression has no loops but comprehensions, so its cost is bounded by its length unless one
operation alone is huge: ``9**9**9``, ``"x" * 10**9``, ``factorial(10**8)``. Those are guarded
here; everything else is the operator of Python itself.
"""

from __future__ import annotations

import functools
import math
import operator
import re
from collections.abc import Callable, Iterable
from typing import Any

MAX_LENGTH = 4096  # characters of an expression
MAX_DEPTH = 100  # of nested constructs
MAX_NODES = 4000  # of the syntax tree
MAX_BITS = 4096  # of an integer that an operation makes
MAX_ITEMS = 1024  # of a sequence that an operation makes
MAX_TEXT = 4096  # characters or bytes that an operation makes
MAX_STEPS = 20_000  # node visits of all comprehensions in one evaluation
MAX_WIDTH = 256  # of a number in a %-format
MAX_ZIPPED = 8  # sequences side by side


class ExpressionError(ValueError):
    """An expression asks for something that it may not do.

    ``reason`` says what, ``column`` where (counted from 0; None where only the value shows it).
    """

    def __init__(self, reason: str, column: int | None = None) -> None:
        self.reason = reason
        self.column = column
        where = "" if column is None else f" at column {column}"
        super().__init__(f"expression refused{where}: {reason}")


def _is_int(value: Any) -> bool:
    return isinstance(value, int)


def _check_bits(bits: int) -> None:
    if bits > MAX_BITS:
        raise ExpressionError(f"an integer of {bits} bits, more than {MAX_BITS}")


_TEXT = (str, bytes, bytearray)
_SEQUENCES = (*_TEXT, list, tuple)
_CONTAINERS = (list, tuple, dict, set, frozenset)


def _check_items(sequence: Any, items: int) -> None:
    limit = MAX_TEXT if isinstance(sequence, _TEXT) else MAX_ITEMS
    if items > limit:
        raise ExpressionError(f"a sequence of {items} items, more than {limit}")


def check_flat(value: Any) -> None:
    """Refuse a container of containers where it could be multiplied.

    Each nesting of shared containers multiplies the cost of comparing or printing them, so a few
    lines could make one that never ends; one level is bounded by MAX_ITEMS.
    """
    if not isinstance(value, _CONTAINERS):
        return
    items = value.values() if isinstance(value, dict) else value
    if any(isinstance(item, _CONTAINERS) for item in items):
        raise ExpressionError("a container of containers, repeated or in a variable")


def _check_printed(value: Any) -> None:
    """Refuse what would be a text of more than MAX_TEXT characters, without making it."""
    length, left = 0, [value]
    while left:
        one = left.pop()
        if isinstance(one, _CONTAINERS):
            length += len(one)
            left.extend(one)
            if isinstance(one, dict):
                left.extend(one.values())
        elif isinstance(one, _TEXT):
            length += len(one)
        elif _is_int(one):
            length += one.bit_length() // 4
        if length > MAX_TEXT:
            raise ExpressionError(f"a text of more than {MAX_TEXT} characters")


def _printing(function: Callable[..., str]) -> Callable[..., str]:
    def bounded(*arguments: Any, **keywords: Any) -> str:
        for value in arguments:
            _check_printed(value)
        return function(*arguments, **keywords)

    return bounded


CALLED: dict[str, Callable[..., str]] = {one.__name__: _printing(one) for one in (str, repr, ascii)}
"""What a call of a builtin calls instead; ``str`` is also a class that ``isinstance`` takes."""


def power(base: Any, exponent: Any) -> Any:
    """``base ** exponent``, bounded where both are integers."""
    if _is_int(base) and _is_int(exponent) and exponent > 0 and abs(base) > 1:
        _check_bits(exponent if exponent > MAX_BITS else int(exponent * math.log2(abs(base))))
    return base**exponent


def shift_left(value: Any, bits: Any) -> Any:
    """``value << bits``, bounded."""
    if _is_int(value) and _is_int(bits) and bits > 0:
        _check_bits(value.bit_length() + bits)
    return value << bits


def multiply(left: Any, right: Any) -> Any:
    """``left * right``, bounded for integers and for repeated sequences."""
    if type(left) is float or type(right) is float:
        return left * right
    if _is_int(left) and _is_int(right):
        _check_bits(left.bit_length() + right.bit_length())
    elif isinstance(left, _SEQUENCES) and _is_int(right):
        _check_repetition(left, right)
    elif isinstance(right, _SEQUENCES) and _is_int(left):
        _check_repetition(right, left)
    return left * right


def _check_repetition(sequence: Any, times: int) -> None:
    check_flat(sequence)
    _check_items(sequence, len(sequence) * times)


def add(left: Any, right: Any) -> Any:
    """``left + right``, bounded where it joins sequences."""
    if isinstance(left, _SEQUENCES) and isinstance(right, _SEQUENCES):
        _check_items(left, len(left) + len(right))
    return left + right


_CONVERSION = re.compile(r"%[-+ #0]*(\*|\d+)?(?:\.(\*|\d+))?")
_NUMBER = re.compile(r"(\*|\d+)()")


def modulo(left: Any, right: Any) -> Any:
    """``left % right``; as a text format, without ``*`` and with bounded widths."""
    if isinstance(left, str | bytes):
        text = left if isinstance(left, str) else left.decode("latin-1")
        # conversions with a (name) nest parentheses, so there any number counts as a width
        widths = (_NUMBER if "(" in text else _CONVERSION).findall(text)
        if any(_is_too_wide(width) for pair in widths for width in pair):
            raise ExpressionError(f"a format wider than {MAX_WIDTH}: {text[:40]!r}")
        _check_printed(right)
    return left % right


def _is_too_wide(width: str) -> bool:
    return width == "*" or len(width) > 4 or int(width or 0) > MAX_WIDTH


def rounded(number: Any, ndigits: Any = None) -> Any:
    """``round``, which for an integer would compute 10 to the power of -ndigits."""
    if _is_int(ndigits) and abs(ndigits) > MAX_WIDTH:
        raise ExpressionError(f"round() to {ndigits} digits")
    return round(number, ndigits)


def bounded_range(*bounds: Any) -> range:
    """``range`` of at most MAX_ITEMS numbers."""
    numbers = range(*bounds)
    if len(numbers) > MAX_ITEMS:
        raise ExpressionError(f"a range of more than {MAX_ITEMS} numbers")
    return numbers


def _total_bits(values: Iterable[Any]) -> int:
    return sum(value.bit_length() for value in values if _is_int(value))


def bounded_prod(values: Iterable[Any], /, *, start: Any = 1) -> Any:
    """``math.prod``, each step of it bounded."""
    return functools.reduce(multiply, iter(values), start)


def bounded_sum(values: Iterable[Any], /, start: Any = 0) -> Any:
    """The builtin ``sum``, each step of it bounded where it joins sequences."""
    if isinstance(start, list | tuple):
        return functools.reduce(add, iter(values), start)
    return sum(values, start)  # which refuses to join texts


def bounded_zip(*iterables: Any, strict: bool = False) -> Any:
    """``zip`` of a few: each of its items is as long as they are many."""
    if len(iterables) > MAX_ZIPPED:
        raise ExpressionError(f"zip() of more than {MAX_ZIPPED} sequences")
    return zip(*iterables, strict=strict)


def bounded_lcm(*values: Any) -> int:
    """``math.lcm``, bounded."""
    _check_bits(_total_bits(values))
    return math.lcm(*values)


def small_integers(function: Callable[..., int]) -> Callable[..., int]:
    """A function of combinatorics, for arguments up to 500 (whose factorial has 3,767 bits)."""

    def bounded(*arguments: Any) -> int:
        if any(_is_int(value) and value > 500 for value in arguments):
            raise ExpressionError(f"{function.__name__}() of more than 500")
        return function(*arguments)

    return bounded


BINARY_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "Add": add,
    "Sub": operator.sub,
    "Mult": multiply,
    "Div": operator.truediv,
    "FloorDiv": operator.floordiv,
    "Mod": modulo,
    "Pow": power,
    "LShift": shift_left,
    "RShift": operator.rshift,
    "BitOr": operator.or_,
    "BitXor": operator.xor,
    "BitAnd": operator.and_,
    "MatMult": operator.matmul,
}
