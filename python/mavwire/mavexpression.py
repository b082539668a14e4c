"""Evaluation of expressions over messages, under pymavlink's name.

The evaluator is :mod:`mavwire.expression`; like pymavlink's module this one also holds every name
that an expression knows. pymavlink runs the file ``extra`` when it is imported and evaluates with
``eval``; mavwire does neither: see :func:`mavwire.expression.load_user_functions`.
"""

import os
from math import *  # noqa: F403

from mavwire import expression as _expression
from mavwire import mavextra as _mavextra
from mavwire.mavextra import *  # noqa: F403

ExpressionError = _expression.ExpressionError
evaluate_expression = _expression.evaluate_expression

home = os.path.expanduser("~")
extra = os.path.join(home, ".pymavlink", "mavextra.py")


def __getattr__(name: str) -> object:
    """What mavextra makes on first use or changes: its tables and its state."""
    return getattr(_mavextra, name)
