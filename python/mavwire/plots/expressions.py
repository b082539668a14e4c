"""Expressions to plot: `EXPR`, or `EXPR:2` for the axis on the right.

An expression over plain fields of one message type is computed over whole columns; every other one
is evaluated message by message, as conditions are.
"""

from __future__ import annotations

import ast
import builtins
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from mavwire._text import in_words
from mavwire.expression.compiler import compile_text
from mavwire.expression.evaluate import _split, evaluate_condition
from mavwire.expression.limits import MAX_ITEMS
from mavwire.expression.names import known_names
from mavwire.logs.selection import HEADER

MAX_CONSTANT = 1e300
"""Larger integers are no doubles."""
STATE_NAMES = frozenset(("MAV", "HOME"))
"""Names of the vehicle's state, which are no messages of the log."""

Places = frozenset[tuple[str, str, int | None]]
"""Fields of messages: type, field, and the index where one element is named."""
Columns = Callable[[str], Any]
"""A column of the message as doubles, by its name."""

_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_FUNCTIONS = {
    "abs": "abs", "fabs": "abs", "degrees": "degrees", "radians": "radians", "sin": "sin",
    "cos": "cos", "tan": "tan", "sqrt": "sqrt", "atan2": "arctan2", "hypot": "hypot",
}  # fmt: skip
"""Functions of `math`, and what NumPy calls them."""
_BINARY = ("atan2", "hypot")
"""Those of two arguments; the others have one. More would be places for results to NumPy."""


@dataclass(frozen=True)
class Expression:
    """One thing to plot."""

    text: str
    right: bool
    """On the axis on the right."""
    types: frozenset[str]
    """The messages at which it has a new value."""
    instances: dict[str, int] = field(default_factory=dict, hash=False)
    """Of types of which only one instance is named: which."""
    plain: bool = False
    """It can be computed over columns."""
    conditional: bool = False
    """It has a value only where its condition holds."""
    places: Places = frozenset()
    """The fields that it reads."""

    @property
    def type(self) -> str:
        """The message type of a plain expression."""
        return next(iter(self.types))

    def fits(self, known: set[str] | None) -> bool:
        """Whether a log of these types, which None leaves open, can have the fields that it names."""
        return known is None or {name for name, _, _ in self.places} <= known

    def fields(self) -> set[str]:
        """The fields of a plain expression."""
        nodes = ast.walk(ast.parse(self.text.strip(), mode="eval"))
        return {node.attr for node in nodes if isinstance(node, ast.Attribute)}

    def over(self, columns: Columns) -> Any:
        """The values of a plain expression; not finite where there is none."""
        import numpy as np

        with np.errstate(all="ignore"):
            return _value(ast.parse(self.text.strip(), mode="eval").body, columns)


def parse(text: str) -> Expression:
    """An expression as written; ValueError says what is wrong with it, ExpressionError among them."""
    if not isinstance(text, str):
        raise ValueError(f"an expression is a text, not {text!r}")
    right = text.endswith(":2")
    body = text[:-2] if right else text.removesuffix(":1")
    if not body.strip():
        raise ValueError(f"no expression: {text!r}")
    value, condition = _split(body)
    trees = []
    for part in [value] if condition is None else [value, condition]:
        try:
            compile_text(part)
        except SyntaxError as error:
            raise ValueError(f"no expression: {text!r}: {error.msg}") from error
        trees.append(ast.parse(part.lstrip(" \t"), mode="eval"))
    types = frozenset(_messages(trees))
    if not types:
        raise ValueError(f"no message is named in {text!r}: write TYPE.field, as in ATTITUDE.roll")
    plain = condition is None and len(types) == 1 and _is_plain(trees[0].body)
    return Expression(
        body, right, types, _instances(trees, types), plain, condition is not None,
        _places(trees, types),
    )  # fmt: skip


def read_by(condition: str | None) -> tuple[frozenset[str], Places]:
    """The messages and fields that a condition reads; none of one that is no expression, as evaluating
    it will say.
    """
    try:
        parsed = None if condition is None else parse(condition)
    except ValueError:
        parsed = None
    return (frozenset(), frozenset()) if parsed is None else (parsed.types, parsed.places)


def _messages(trees: list[ast.Expression]) -> set[str]:
    """The names that are neither functions nor variables of a comprehension."""
    nodes = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Name)]
    bound = {node.id for node in nodes if isinstance(node.ctx, ast.Store)}
    known = known_names()
    names = {node.id for node in nodes} - bound - STATE_NAMES
    return {name for name in names if name not in known}


def _places(trees: list[ast.Expression], types: frozenset[str]) -> Places:
    """The fields that expressions read, and elements of them."""
    found = set()
    for node in (node for tree in trees for node in ast.walk(tree)):
        item = node.value if isinstance(node, ast.Subscript) else node
        index = _index(node.slice) if isinstance(node, ast.Subscript) else None
        if isinstance(item, ast.Attribute):
            owner = item.value.value if isinstance(item.value, ast.Subscript) else item.value
            if isinstance(owner, ast.Name) and owner.id in types:
                found.add((owner.id, item.attr, index))
    elements = {place[:2] for place in found if place[2] is not None}
    return frozenset(one for one in found if one[2] is not None or one[:2] not in elements)


def _instances(trees: list[ast.Expression], types: frozenset[str]) -> dict[str, int]:
    """Types that stand only as `TYPE[n]`, always with the same number."""
    found: dict[str, set[int | None]] = {name: set() for name in types}
    for tree in trees:
        inside = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
                inside.add(node.value)
                if node.value.id in types:
                    found[node.value.id].add(_index(node.slice))
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and node.id in types and node not in inside:
                found[node.id].add(None)
    single = {name: next(iter(some)) for name, some in found.items() if len(some) == 1}
    return {name: number for name, number in single.items() if number is not None}


def _index(node: ast.expr) -> int | None:
    number = node.value if isinstance(node, ast.Constant) else None
    return number if type(number) is int and number >= 0 else None


def _is_plain(node: ast.AST) -> bool:
    if isinstance(node, ast.Constant):
        number = node.value
        return type(number) in (int, float) and number < MAX_CONSTANT  # type: ignore[operator]
    if isinstance(node, ast.Attribute):
        owner = node.value
        return isinstance(owner, ast.Name) and owner.id not in (*known_names(), *STATE_NAMES)
    if isinstance(node, ast.Subscript):
        is_field = isinstance(node.value, ast.Attribute) and _is_plain(node.value)
        return is_field and _index(node.slice) is not None
    if isinstance(node, ast.UnaryOp):
        return type(node.op) in _OPERATORS and _is_plain(node.operand)
    if isinstance(node, ast.BinOp):
        return type(node.op) in _OPERATORS and _is_plain(node.left) and _is_plain(node.right)
    if isinstance(node, ast.Call):
        return _is_known(node) and all(map(_is_plain, node.args))
    return False


def _is_known(call: ast.Call) -> bool:
    """Whether it calls a function that NumPy has too, and that nobody has replaced, as one does."""
    name = call.func.id if isinstance(call.func, ast.Name) else ""
    if name not in _FUNCTIONS or call.keywords or len(call.args) != 1 + (name in _BINARY):
        return False
    original = getattr(math, name, None) or getattr(builtins, name)
    return known_names()[name] is original


def _value(node: ast.AST, columns: Columns) -> Any:
    import numpy as np

    match node:
        case ast.Constant():
            return np.float64(node.value)  # type: ignore[arg-type]
        case ast.Attribute():
            return columns(node.attr)
        case ast.Subscript():
            values, index = _value(node.value, columns), _index(node.slice)
            if values.ndim < 2 or index is None or index >= values.shape[1]:
                raise ValueError(f"{ast.unparse(node)}: there is no such element")
            return values[:, index]
        case ast.UnaryOp():
            return _OPERATORS[type(node.op)](_value(node.operand, columns))
        case ast.BinOp():
            left, right = _value(node.left, columns), _value(node.right, columns)
            return _OPERATORS[type(node.op)](left, right)
        case ast.Call(func=ast.Name(id=name)):
            return getattr(np, _FUNCTIONS[name])(*(_value(one, columns) for one in node.args))
    raise ValueError(f"{ast.unparse(node)} is no expression over columns")


def as_number(value: Any) -> float:
    """The value of an expression as a number. ValueError names any other value."""
    try:
        return float(value)
    except OverflowError:
        raise ValueError("a number is too large") from None
    except (TypeError, ValueError):
        if hasattr(value, "get_type"):
            raise ValueError(f"{value.get_type()} is a message: name a field of it") from None
        what = repr(value) if isinstance(value, str | bytes) else type(value).__name__
        raise ValueError(f"{what} is no number") from None


def why_nothing(text: str, messages: Mapping[str, Any], condition: str | None = None) -> str | None:
    """Why an expression has no value now, in words; None where it has one."""
    value, own = _split(text)
    for needed in (condition, own):
        if needed is not None and (why := why_nothing(needed, messages)):
            return why
        if not evaluate_condition(needed, messages):
            return f"{needed} does not hold"
    try:
        compile_text(value)(messages, [MAX_ITEMS])
    except Exception as error:  # functions of expressions raise errors of any type
        return in_words(error)
    return None


def column_of(name: str) -> str:
    """The column that holds a field."""
    return f"{name}_" if name in HEADER else name
