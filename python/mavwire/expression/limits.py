"""The cost that an expression may have, and the operators and functions that could cost more.

One evaluation has one budget. The operands and results of operations, calls, lists and loops are
charged to it, with all values that they hold. So nothing grows step by step. Small operands can
make a huge value at once: ``9**9**9``, ``"x" * 10**9``. Those operations are guarded here.
Everything else is the operator of Python itself.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Iterable
from typing import Any

MAX_LENGTH = 4096  # characters of an expression
MAX_DEPTH = 100  # of nested constructs
MAX_NODES = 4000  # of the syntax tree
MAX_BITS = 4096  # of an integer that an operation makes
MAX_TEXT = 16_384  # characters of one text: some searches take the square of it
MAX_RANGE = 1024  # numbers of a range
MAX_WIDTH = 256  # of a number in a %-format
MAX_BYTES = 16 << 20  # of all values that one evaluation makes
ITEM_BYTES = 64  # that an element or a character counts; few take more
MAX_ITEMS = MAX_BYTES // ITEM_BYTES
STEP_ITEMS = 8  # that the visit of a node in a comprehension counts
OBJECT_ITEMS = 64  # that a message or a vector counts


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
_VIEWS: tuple[type, ...] = (type({}.keys()), type({}.values()), type({}.items()))
_CONTAINERS = (list, tuple, dict, set, frozenset, range, slice, *_VIEWS)

NUMBERS = frozenset((float, int, bool))
SCALARS = NUMBERS | {type(None)}
"""Types whose values cost no more than the construct that makes them."""


Budget = list[float]
"""The items that one evaluation may still make, or go through again in its loops, as the only element
of a list: no object is made faster."""


def charge(value: Any, budget: Budget, node: ast.AST) -> Any:
    """Spend what a value counts that ``node`` makes, or goes through in a loop; returns the value."""
    spend(weight(value, budget[0]), budget, node)
    return value


def spend(items: float, budget: Budget, node: ast.AST) -> None:
    """Charge work; ExpressionError names the part of the expression that is too much."""
    budget[0] -= items
    if budget[0] < 0:
        raise _too_much(node, items)


def _too_much(node: ast.AST, items: float) -> ExpressionError:
    part = ast.unparse(node)
    part = part if len(part) <= 40 else f"{part[:37]}..."
    if items == math.inf:
        reason = f"{part!r} has a text of more than {MAX_TEXT} characters"
    else:
        reason = f"with {part!r} the evaluation takes more than {MAX_BYTES >> 20} MB of values"
    return ExpressionError(reason, getattr(node, "col_offset", None))


def weight(value: Any, limit: float) -> float:
    """The items of a value and of all values in it, or any number above the limit; infinite with a
    text longer than MAX_TEXT.

    A container that is held twice counts twice, because to compare or print it takes twice as long.
    """
    items: float = 0
    pending = [value]
    while pending and items <= limit:
        one = pending.pop()
        if isinstance(one, _TEXT):
            items += 1 + len(one) if len(one) <= MAX_TEXT else math.inf
        elif isinstance(one, _CONTAINERS):
            inside = _inside(one)
            items += 1 + len(inside)
            if items <= limit:
                pending.extend(inside)
        elif isinstance(one, int):
            items += 1 + one.bit_length() // 32
        else:
            items += 1 if type(one) in SCALARS else OBJECT_ITEMS
    return items


def _inside(container: Any) -> Any:
    if isinstance(container, dict):
        return container.items()
    if isinstance(container, slice):
        return container.start, container.stop, container.step
    return container


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
    if len(sequence) * times > MAX_ITEMS:
        raise ExpressionError(f"a sequence of {len(sequence)} items, {times} times")


_CONVERSION = re.compile(r"%[-+ #0]*(\*|\d+)?(?:\.(\*|\d+))?")


def modulo(left: Any, right: Any) -> Any:
    """``left % right``; as a text format, without ``*`` and names, and with bounded widths."""
    if isinstance(left, _TEXT):
        text = left if isinstance(left, str) else left.decode("latin-1")
        if "%(" in text:  # a value could be printed many times
            raise ExpressionError(f"a format with names: {text[:40]!r}")
        if any(_is_too_wide(width) for pair in _CONVERSION.findall(text) for width in pair):
            raise ExpressionError(f"a format wider than {MAX_WIDTH}: {text[:40]!r}")
    return left % right


def _is_too_wide(width: str) -> bool:
    return width == "*" or len(width) > 4 or int(width or 0) > MAX_WIDTH


def rounded(number: Any, ndigits: Any = None) -> Any:
    """``round``, which for an integer would compute 10 to the power of -ndigits."""
    if _is_int(ndigits) and abs(ndigits) > MAX_WIDTH:
        raise ExpressionError(f"round() to {ndigits} digits")
    return round(number, ndigits)


def bounded_int(*arguments: Any, **keywords: Any) -> int:
    """``int``, of a text that holds no more than MAX_BITS."""
    if any(isinstance(one, _TEXT) and len(one) > MAX_BITS // 4 for one in arguments):
        raise ExpressionError(f"an integer of more than {MAX_BITS // 4} digits")
    return int(*arguments, **keywords)


CALLED: dict[str, Callable[..., Any]] = {"int": bounded_int}
"""The function that a call of a builtin calls instead; ``int`` is also a class for ``isinstance``."""


def bounded_range(*bounds: Any) -> range:
    """``range`` of at most MAX_RANGE numbers below 2**60, none of which share a hash."""
    numbers = range(*bounds)
    if len(numbers) > MAX_RANGE or max(abs(numbers.start), abs(numbers.stop)) > 2**60:
        raise ExpressionError(f"a range of more than {MAX_RANGE} numbers, or beyond 2**60")
    return numbers


def bounded_sum(values: Iterable[Any], /, start: Any = 0) -> Any:
    """The builtin ``sum``, which takes the square of the time to join sequences."""
    if isinstance(start, _SEQUENCES):
        raise ExpressionError("builtin_sum() of sequences")
    return sum(values, start)


BINARY_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "Add": operator.add,
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
