"""From the text of an expression to a closure over the messages.

Each kind of syntax node that is allowed has one function here that returns a closure for it; a
kind without one is refused. A closure takes the mapping of messages and the budget of the
evaluation, and returns the value, so an evaluation is a few Python calls. The usual shapes of
conditions, ``NAME.field`` and a comparison with a constant, are single closures.

A value is charged to the budget where an operation, a call or a list makes it, unless it is a number
or None. In a loop, where the variables are a `Scope`, each use of a value is charged too.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any

from mavwire.expression.attributes import METHOD_OWNERS, check_name
from mavwire.expression.comprehension import Clause, Closure, Scope, collect
from mavwire.expression.limits import (
    BINARY_OPERATORS,
    CALLED,
    MAX_DEPTH,
    MAX_LENGTH,
    MAX_NODES,
    NUMBERS,
    SCALARS,
    STEP_ITEMS,
    Budget,
    ExpressionError,
    charge,
)
from mavwire.expression.names import known_names, lookup


def compile_text(text: str) -> Closure:
    """The closure of an expression without a condition in braces.

    Raises SyntaxError for what is no Python expression and ExpressionError for what is refused.
    """
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"{len(text)} characters, more than {MAX_LENGTH}")
    try:
        tree = ast.parse(text.lstrip(" \t"), "<string>", "eval")
    except (MemoryError, RecursionError):
        raise ExpressionError("nested too deeply to be parsed") from None
    except ValueError as error:  # a NUL character, before Python 3.12
        raise SyntaxError(str(error)) from None
    _check_size(tree.body)
    return build(tree.body)


def _check_size(root: ast.AST) -> None:
    """Refuse a tree too deep or too large."""
    pending, nodes = [(root, 1)], 0
    while pending:
        node, depth = pending.pop()
        nodes += 1
        if depth > MAX_DEPTH or nodes > MAX_NODES:
            raise ExpressionError(f"deeper than {MAX_DEPTH} or larger than {MAX_NODES} constructs")
        pending.extend((child, depth + 1) for child in ast.iter_child_nodes(node))


def build(node: ast.AST) -> Closure:
    """The closure of one node."""
    builder = _BUILDERS.get(type(node))
    if builder is None:
        raise _refused(node, f"{_in_words(node)} is not allowed")
    return builder(node)


_WORDS: dict[type[ast.AST], str] = {
    ast.Await: "await",
    ast.JoinedStr: "an f-string",
    ast.Lambda: "lambda",
    ast.NamedExpr: "an assignment",
    ast.Starred: "unpacking with *",
    ast.Yield: "yield",
    ast.YieldFrom: "yield",
    ast.Attribute: "an attribute",
    ast.Subscript: "an item",
}


def _in_words(node: ast.AST) -> str:
    """A construct in words for users who do not know the names of Python's parser."""
    return _WORDS.get(type(node), "this")


def _refused(node: ast.AST, reason: str) -> ExpressionError:
    return ExpressionError(reason, getattr(node, "col_offset", None))


def _constant(node: ast.Constant) -> Closure:
    value = node.value
    return lambda variables, budget: value


def _name(node: ast.Name) -> Closure:
    name, column = node.id, node.col_offset
    check_name(name, column)

    def load(variables: Any, budget: Budget) -> Any:
        try:
            return variables[name]
        except KeyError:
            return lookup(name, column)

    return load


def _attribute(node: ast.Attribute) -> Closure:
    attribute = node.attr
    check_name(attribute, node.col_offset)
    if isinstance(node.value, ast.Name):
        return _message_field(node.value, attribute)
    value = build(node.value)
    return lambda variables, budget: getattr(value(variables, budget), attribute)


def _message_field(node: ast.Name, attribute: str) -> Closure:
    """``NAME.field``, the most frequent shape, in one closure."""
    name, column = node.id, node.col_offset
    check_name(name, column)

    def load(variables: Any, budget: Budget) -> Any:
        try:
            message = variables[name]
        except KeyError:
            message = lookup(name, column)
        return getattr(message, attribute)

    return load


def _subscript(node: ast.Subscript) -> Closure:
    value, index = build(node.value), build(node.slice)
    if isinstance(node.slice, ast.Slice):
        return lambda variables, budget: charge(
            value(variables, budget)[index(variables, budget)], budget, node
        )

    def load(variables: Any, budget: Budget) -> Any:
        owner, key = value(variables, budget), index(variables, budget)
        if type(variables) is Scope and type(key) not in SCALARS:
            charge(key, budget, node)
        try:
            return owner[key]
        except IndexError as error:
            if error.args or not hasattr(owner, "get_type"):
                raise
            # A message's, which is without words for the sake of those who know pymavlink's.
            raise IndexError(f"{owner.get_type()} has no instance {key!r}") from None

    return load


def _slice(node: ast.Slice) -> Closure:
    parts = [build(part or ast.Constant(None)) for part in (node.lower, node.upper, node.step)]
    lower, upper, step = parts
    return lambda variables, budget: slice(
        lower(variables, budget), upper(variables, budget), step(variables, budget)
    )


_UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Invert: operator.invert,
    ast.Not: operator.not_,
}


def _unary(node: ast.UnaryOp) -> Closure:
    folded = _signed_number(node)
    if isinstance(folded, ast.Constant):
        return _constant(folded)
    apply, operand = _UNARY[type(node.op)], build(node.operand)
    return lambda variables, budget: apply(operand(variables, budget))


def _signed_number(node: ast.expr) -> ast.expr:
    """``-1`` as the constant that it is, so that ``x > -1`` is as fast as ``x > 1``."""
    if not isinstance(node, ast.UnaryOp) or not isinstance(node.op, ast.USub | ast.UAdd):
        return node
    number = node.operand
    if not isinstance(number, ast.Constant) or not isinstance(number.value, int | float):
        return node
    return ast.Constant(_UNARY[type(node.op)](number.value))


def _binary(node: ast.BinOp) -> Closure:
    apply = BINARY_OPERATORS[type(node.op).__name__]
    left, second = build(node.left), _signed_number(node.right)
    if isinstance(second, ast.Constant) and type(second.value) in NUMBERS:
        return _binary_with(apply, left, second.value, node)
    right = build(second)

    def run(variables: Any, budget: Budget) -> Any:
        first, second = left(variables, budget), right(variables, budget)
        if type(first) in NUMBERS and type(second) in NUMBERS:
            return apply(first, second)
        if type(variables) is Scope:
            charge(first, budget, node)
            charge(second, budget, node)
        return charge(apply(first, second), budget, node)

    return run


def _boolean(node: ast.BoolOp) -> Closure:
    operands = [build(value) for value in node.values]
    *first, last = operands
    stop_at = isinstance(node.op, ast.Or)

    def run(variables: Any, budget: Budget) -> Any:
        for operand in first:
            value = operand(variables, budget)
            if bool(value) is stop_at:
                return value
        return last(variables, budget)

    return run


def _conditional(node: ast.IfExp) -> Closure:
    test, body, otherwise = build(node.test), build(node.body), build(node.orelse)
    return lambda variables, budget: (
        body(variables, budget) if test(variables, budget) else otherwise(variables, budget)
    )


_COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda item, items: item in items,
    ast.NotIn: lambda item, items: item not in items,
}


def _binary_with(
    apply: Callable[[Any, Any], Any], left: Closure, constant: Any, node: ast.BinOp
) -> Closure:
    def run(variables: Any, budget: Budget) -> Any:
        first = left(variables, budget)
        if type(first) in NUMBERS:
            return apply(first, constant)
        if type(variables) is Scope:
            charge(first, budget, node)
        return charge(apply(first, constant), budget, node)

    return run


def _compare(node: ast.Compare) -> Closure:
    if len(node.ops) > 1:
        return _chained(node)
    holds = _COMPARISONS[type(node.ops[0])]
    left, second = build(node.left), _signed_number(node.comparators[0])
    if isinstance(second, ast.Constant):
        constant = second.value
        return lambda variables, budget: holds(left(variables, budget), constant)
    right = build(second)
    if isinstance(second, ast.List | ast.Tuple) and _are_constants(second.elts):
        return lambda variables, budget: holds(left(variables, budget), right(variables, budget))

    def run(variables: Any, budget: Budget) -> Any:
        first, second = left(variables, budget), right(variables, budget)
        if type(variables) is Scope:
            _charge_compared(first, second, budget, node)
        return holds(first, second)

    return run


def _charge_compared(first: Any, second: Any, budget: Budget, node: ast.Compare) -> None:
    if type(first) not in SCALARS:
        charge(first, budget, node)
    if type(second) not in SCALARS and not isinstance(second, dict):  # which ``in`` looks up
        charge(second, budget, node)


def _chained(node: ast.Compare) -> Closure:
    """``a < b < c``: each operand is evaluated once, and none after a comparison that fails."""
    left = build(node.left)
    links = [
        (_COMPARISONS[type(op)], build(c)) for op, c in zip(node.ops, node.comparators, strict=True)
    ]

    def run(variables: Any, budget: Budget) -> Any:
        value, result = left(variables, budget), True
        for holds, operand in links:
            following = operand(variables, budget)
            if type(variables) is Scope:
                _charge_compared(value, following, budget, node)
            result = holds(value, following)
            if not result:
                break
            value = following
        return result

    return run


def _elements(nodes: list[ast.expr]) -> Closure:
    """A closure for the list of the values of ``nodes``, with ``*items`` spread out."""
    if any(isinstance(node, ast.Starred) for node in nodes):
        return _spread(nodes)
    if _are_constants(nodes):
        constants = [node.value for node in nodes]  # type: ignore[attr-defined]
        return lambda variables, budget: constants.copy()
    parts = [(build(node), node) for node in nodes]

    def run(variables: Any, budget: Budget) -> list[Any]:
        result: list[Any] = []
        for value, node in parts:
            item = value(variables, budget)
            if type(variables) is Scope and type(item) not in SCALARS:
                charge(item, budget, node)
            result.append(item)
        return result

    return run


def _are_constants(nodes: list[ast.expr]) -> bool:
    return all(isinstance(node, ast.Constant) for node in nodes)


def _spread(nodes: list[ast.expr]) -> Closure:
    spread = [
        (node, build(node.value)) if isinstance(node, ast.Starred) else (None, build(node))
        for node in nodes
    ]

    def run(variables: Any, budget: Budget) -> Any:
        result: list[Any] = []
        for starred, value in spread:
            item = value(variables, budget)
            if starred:
                if type(variables) is Scope:
                    charge(item, budget, starred)
                result.extend(item)
            else:
                result.append(item)
        return charge(result, budget, nodes[0])

    return run


def _list(node: ast.List) -> Closure:
    return _elements(node.elts)


def _tuple(node: ast.Tuple) -> Closure:
    elements = _elements(node.elts)
    return lambda variables, budget: tuple(elements(variables, budget))


def _set(node: ast.Set) -> Closure:
    elements = _elements(node.elts)
    return lambda variables, budget: set(elements(variables, budget))


def _dict(node: ast.Dict) -> Closure:
    if None in node.keys:
        raise _refused(node, "** is not allowed")
    keys, values = _elements([key for key in node.keys if key]), _elements(node.values)
    return lambda variables, budget: dict(
        zip(keys(variables, budget), values(variables, budget), strict=True)
    )


def _call(node: ast.Call) -> Closure:
    function = _function(node.func)
    for keyword in node.keywords:
        if keyword.arg is None or keyword.arg == "key":
            raise _refused(node, f"the argument {keyword.arg or '**'!r} is not allowed")
    if len(node.args) == 1 and not node.keywords and not isinstance(node.args[0], ast.Starred):
        return _call_of_one(node, function)
    arguments = _elements(node.args)
    keywords = {str(keyword.arg): build(keyword.value) for keyword in node.keywords}

    def run(variables: Any, budget: Budget) -> Any:
        called, positional = function(variables, budget), arguments(variables, budget)
        named = {name: value(variables, budget) for name, value in keywords.items()}
        if type(variables) is Scope:
            charge(list(named.values()), budget, node)
        result = called(*positional, **named)
        return result if type(result) in SCALARS else charge(result, budget, node)

    return run


def _call_of_one(node: ast.Call, function: Closure) -> Closure:
    argument = build(node.args[0])
    free = SCALARS | {str} if isinstance(node.args[0], ast.Constant) else SCALARS

    def run(variables: Any, budget: Budget) -> Any:
        called, value = function(variables, budget), argument(variables, budget)
        if type(variables) is Scope and type(value) not in free:
            charge(value, budget, node)
        result = called(value)
        return result if type(result) in SCALARS else charge(result, budget, node)

    return run


def _function(node: ast.expr) -> Closure:
    """A closure for what is called: a known function, or a method that only reads."""
    if isinstance(node, ast.Name):
        return _known_function(node)
    if isinstance(node, ast.Attribute):
        return _method(node)
    raise _refused(node, "only functions and methods can be called by name")


def _known_function(node: ast.Name) -> Closure:
    name, column = node.id, node.col_offset
    check_name(name, column)
    bounded, known = CALLED.get(name), known_names()

    def load(variables: Any, budget: Budget) -> Any:
        if name not in variables:
            return bounded or known.get(name) or lookup(name, column)
        if callable(variables[name]):
            raise ExpressionError(f"{name!r} is no function registered for expressions", column)
        return variables[name]

    return load


def _method(node: ast.Attribute) -> Closure:
    name, column, value = node.attr, node.col_offset, build(node.value)
    if name not in METHOD_OWNERS:
        raise _refused(node, f"the method {name!r} is not available")
    owners = METHOD_OWNERS[name]
    looked_up = object in owners or dict in owners  # which takes no longer the more there is

    def load(variables: Any, budget: Budget) -> Any:
        owner = value(variables, budget)
        if not isinstance(owner, owners):
            raise ExpressionError(f"the method {name!r} of {type(owner).__name__}", column)
        if type(variables) is Scope and not looked_up:
            charge(owner, budget, node)
        return getattr(owner, name)

    return load


def _comprehension(
    node: ast.ListComp | ast.SetComp | ast.GeneratorExp, make: Callable[[Any], Any]
) -> Closure:
    return collect(_clauses(node, node.elt), build(node.elt), make, node)


def _dict_comprehension(node: ast.DictComp) -> Closure:
    pair = ast.Tuple([node.key, node.value], ast.Load())
    return collect(_clauses(node, pair), build(pair), dict, node)


def _clauses(node: Any, element: ast.AST) -> list[Clause]:
    clauses = []
    follows = [*(generator.iter for generator in node.generators[1:]), element]
    for generator, following in zip(node.generators, follows, strict=True):
        each_time = (generator.target, *generator.ifs, following)
        visits = sum(1 for part in each_time for _ in ast.walk(part))
        conditions = [build(condition) for condition in generator.ifs]
        bind, items = _target(generator.target), build(generator.iter)
        clauses.append(Clause(bind, items, conditions, visits * STEP_ITEMS, node))
    return clauses


def _target(node: ast.AST) -> Callable[[dict[str, Any], Any], None]:
    """A function that binds an item to a name or, like ``a, b``, to several."""
    if isinstance(node, ast.Name):
        name = node.id
        check_name(name, node.col_offset)
        return lambda bound, item: bound.__setitem__(name, item)
    if not isinstance(node, ast.Tuple | ast.List):
        raise _refused(node, f"{_in_words(node)} is not allowed as a variable")
    targets = [_target(part) for part in node.elts]

    def bind(bound: dict[str, Any], item: Any) -> None:
        for target, part in zip(targets, item, strict=True):
            target(bound, part)

    return bind


_BUILDERS: dict[type[ast.AST], Callable[[Any], Closure]] = {
    ast.Constant: _constant,
    ast.Name: _name,
    ast.Attribute: _attribute,
    ast.Subscript: _subscript,
    ast.Slice: _slice,
    ast.UnaryOp: _unary,
    ast.BinOp: _binary,
    ast.BoolOp: _boolean,
    ast.IfExp: _conditional,
    ast.Compare: _compare,
    ast.List: _list,
    ast.Tuple: _tuple,
    ast.Set: _set,
    ast.Dict: _dict,
    ast.Call: _call,
    ast.ListComp: lambda node: _comprehension(node, list),
    ast.GeneratorExp: lambda node: _comprehension(node, list),
    ast.SetComp: lambda node: _comprehension(node, set),
    ast.DictComp: _dict_comprehension,
}
