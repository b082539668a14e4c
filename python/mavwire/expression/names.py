"""The functions and constants that an expression knows beside the messages.

As in pymavlink these are the names of ``math``, of ``mavextra`` and the builtins, where ``sum``,
``pow`` and ``mode`` are not the builtin ones. Builtins that reach further than the values in hand
(``open``, ``type``, ``vars``, ...) are left out, and so are combinatorics of ``math``. Others without a
bound are guarded.
"""

from __future__ import annotations

import builtins
import functools
import math
from os import PathLike
from typing import Any

from mavwire.expression import attributes, limits

_BUILTINS = (
    "abs all any ascii bin bool chr complex dict divmod enumerate float frozenset hex int "
    "isinstance len list max min oct ord repr reversed set slice sorted str tuple zip"
)

_ALL_BUILTINS = frozenset(vars(builtins))

_GUARDED: dict[str, Any] = {
    "round": limits.rounded,
    "range": limits.bounded_range,
    "getattr": attributes.safe_getattr,
    "hasattr": attributes.safe_hasattr,
    "builtin_sum": limits.bounded_sum,
}

_UNBOUNDED = frozenset({"comb", "factorial", "lcm", "perm", "prod"})
"""Functions of ``math`` whose results may be huge."""


@functools.cache
def known_names() -> dict[str, Any]:
    """Every name beside the messages and its value; built on first use."""
    from mavwire import mavextra

    names: dict[str, Any] = {name: getattr(builtins, name) for name in _BUILTINS.split()}
    names.update({n: v for n, v in _public(vars(math)).items() if n not in _UNBOUNDED})
    names.update({name: getattr(mavextra, name) for name in mavextra.EXPRESSION_NAMES})
    names.update(_GUARDED)
    return names


def _public(names: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in names.items() if not name.startswith("_")}


def register(name: str, value: Any) -> None:
    """Make ``value``, a function or a constant, known to expressions under ``name``.

    The caller vouches for it: an expression may call it with any values it can reach.
    Raises ExpressionError for a name out of reach, ValueError for one that is no identifier.
    """
    attributes.check_name(name)
    if not name.isidentifier():
        raise ValueError(f"not a name: {name!r}")
    known_names()[name] = value


def load_user_functions(path: str | PathLike[str]) -> list[str]:
    """Run the Python file at ``path`` and make its public functions known; returns their names.

    This executes the file. pymavlink does so with ``~/.pymavlink/mavextra.py`` whenever it is
    imported; mavwire does so only here. Raises OSError, and all errors of the file.
    """
    with open(path, encoding="utf-8") as source:
        text = source.read()
    namespace: dict[str, Any] = {"__name__": "mavwire.mavuser", "__file__": str(path)}
    exec(compile(text, str(path), "exec"), namespace)
    functions = {n: v for n, v in _public(namespace).items() if callable(v)}
    for name, function in functions.items():
        register(name, function)
    return sorted(functions)


def lookup(name: str, column: int) -> Any:
    """The value of a name that is no message.

    Raises ExpressionError for a function that is left out, NameError for an unknown name.
    """
    known = known_names()
    if name in known:
        return known[name]
    if name in _ALL_BUILTINS | _UNBOUNDED:
        raise limits.ExpressionError(f"{name!r} is not available", column)
    raise NameError(f"name {name!r} is not defined", name=name)
