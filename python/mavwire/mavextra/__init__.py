"""The functions that conditions and graph expressions may use, with pymavlink's names.

They take messages or their fields and compute what a log does not hold: distances, headings,
airspeeds, filtered values. Angles are in degrees unless a function says otherwise. This module
only gathers them; the modules beside it are one topic each. As in pymavlink the names of ``math``
are here too, and ``sum`` and ``mode`` are not the builtin ones.
"""

import builtins as _builtins
import math as _math
import sys as _sys
from math import *
from types import ModuleType as _ModuleType
from typing import Any as _Any

from mavwire._hooks import (
    IN_STANDARD_MODULE as _IN_STANDARD_MODULE,
    ReplaceableModule as _ReplaceableModule,
    make_replaceable as _make_replaceable,
)
from mavwire.mavextra import earth_field as _earth_field
from mavwire.mavextra import state as _state
from mavwire.mavextra.attitude import *
from mavwire.mavextra.compass import *
from mavwire.mavextra.earth_field import *
from mavwire.mavextra.estimators import *
from mavwire.mavextra.filters import *
from mavwire.mavextra.inertial import *
from mavwire.mavextra.position import *
from mavwire.mavextra.pressure import *
from mavwire.mavextra.state import *
from mavwire.mavextra.terrain import *
from mavwire.mavextra.units import *
from mavwire.mavextra.vehicle import *
from mavwire.quaternion import Quaternion as Quaternion
from mavwire.rotmat import Matrix3 as Matrix3
from mavwire.rotmat import Vector3 as Vector3

builtin_sum = _builtins.sum

_STATE = frozenset(name for name in vars(_state) if not name.startswith("_"))

EXPRESSION_NAMES: tuple[str, ...] = (
    *_earth_field.TABLES,
    *(
        name
        for name in sorted(globals())
        if not (name.startswith("_") or hasattr(_math, name) or name in _STATE)
        and not isinstance(globals()[name], _ModuleType)
    ),
)
"""The names of this module that an expression knows: all but what is remembered."""

__all__ = [
    name
    for name in (*globals(), *_earth_field.TABLES, *_state.SCALARS)
    if not (name.startswith("_") or isinstance(globals().get(name), _ModuleType))
]


class _Mavextra(_ReplaceableModule):
    _users = ("mavwire.mavextra",)
    _not_called = dict.fromkeys(
        (name for name in vars(_math) if name[0] != "_"), _IN_STANDARD_MODULE
    )


_make_replaceable(_sys.modules[__name__], _Mavextra)


def __getattr__(name: str) -> _Any:
    """The tables, read from their file on first use, and what is remembered, as it is now."""
    if name in _earth_field.TABLES:
        return _earth_field.table(name)
    if name in _state.SCALARS:
        return _state.SCALARS[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_earth_field.TABLES, *_state.SCALARS})
