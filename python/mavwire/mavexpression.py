"""Evaluation of expressions over messages, under pymavlink's name.

The evaluator is :mod:`mavwire.expression`; like pymavlink's module this one also holds every name
that an expression knows. pymavlink runs the file ``extra`` when it is imported and evaluates with
``eval``; mavwire does neither: see :func:`mavwire.expression.load_user_functions`.
"""

import os
import sys
from typing import Any

from mavwire import expression as _expression
from mavwire import mavextra as _mavextra
from mavwire._hooks import ReplaceableModule, make_replaceable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from mavwire.mavextra import *  # noqa: F403

ExpressionError = _expression.ExpressionError
evaluate_expression = _expression.evaluate_expression

home = os.path.expanduser("~")
extra = os.path.join(home, ".pymavlink", "mavextra.py")

__all__ = [*_mavextra.__all__, "evaluate_expression", "extra", "home"]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    """The names that expressions know: those of mavextra."""
    return getattr(_mavextra, name)


class _Mavexpression(ReplaceableModule):
    """Expressions can use the names that a program sets here, as in pymavlink."""

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        if not name.startswith("_") and (name in _KNOWN or callable(value)):
            _expression.register(name, value)


_KNOWN = frozenset(_mavextra.__all__)
make_replaceable(sys.modules[__name__], _Mavexpression)


def __dir__() -> list[str]:
    return sorted({*globals(), *dir(_mavextra)})
