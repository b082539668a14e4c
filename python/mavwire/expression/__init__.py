"""Conditions and graph expressions, evaluated without ``eval``.

A text such as ``ATTITUDE.roll>0.5`` or ``mag_field(RAW_IMU){MAV.flightmode=="AUTO"}`` comes from
command lines, saved graphs and other people's files, so it must not be able to run code. It is
parsed once, every construct is checked against a whitelist, and the tree is turned into nested
closures that are kept for the next evaluation. A refused construct raises
:class:`ExpressionError`, which names it and its column.

An expression may hold: literals, tuples, lists, sets and dicts; the names of the messages
and of the functions of ``math``, ``mavextra`` and the harmless builtins; attributes, items and
slices; arithmetic, comparison, ``and``/``or``/``not``, ``a if b else c``; calls of those functions
and of a few methods that only read; comprehensions. Names and attributes that start with ``_``
are out of reach, and so are lambdas, assignments and f-strings. Size, nesting, integers,
sequences and loops are bounded (:mod:`mavwire.expression.limits`).
"""

from mavwire.expression.evaluate import evaluate_condition, evaluate_expression
from mavwire.expression.limits import ExpressionError
from mavwire.expression.names import load_user_functions, register

__all__ = [
    "ExpressionError",
    "evaluate_condition",
    "evaluate_expression",
    "load_user_functions",
    "register",
]
