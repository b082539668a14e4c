"""The attributes that an expression may read and the methods that it may call.

Python reaches everything from anything through attributes, so names with a leading ``_`` and the
handles of frames and code objects are refused. A method is called only if it is listed here: those
of the message classes that read, and those of plain values that neither change nor grow them.
"""

from __future__ import annotations

from typing import Any

from mavwire.expression.limits import ExpressionError
from mavwire.quaternion import QuaternionBase
from mavwire.rotmat import Matrix3, Vector3

_INTROSPECTION = frozenset(
    f"{owner}_{part}"
    for owner in ("gi", "cr", "ag", "tb", "f", "func")
    for part in ("frame", "code", "back", "builtins", "globals", "locals", "next", "await")
)


_READABLE = frozenset({"_timestamp"})  # a number that every received message carries


def check_name(name: str, column: int | None = None) -> None:
    """Raise ExpressionError for a name or an attribute out of reach."""
    if (name.startswith("_") and name not in _READABLE) or name in _INTROSPECTION:
        raise ExpressionError(f"the name {name!r} is out of reach", column)


def safe_getattr(value: Any, name: str, *default: Any) -> Any:
    """``getattr`` within reach."""
    check_name(str(name))
    return getattr(value, str(name), *default)


def safe_hasattr(value: Any, name: str) -> bool:
    """``hasattr`` within reach."""
    check_name(str(name))
    return hasattr(value, str(name))


_ANY = (object,)  # messages and links, which have many classes

_METHODS: tuple[tuple[tuple[type, ...], str], ...] = (
    (_ANY, "get_type get_msgId get_fieldnames get_header get_payload get_msgbuf get_crc get_seq"),
    (_ANY, "get_srcSystem get_srcComponent get_link_id get_signed to_dict to_json"),
    (_ANY, "get_incompatFlags get_compatFlags"),
    (_ANY, "param field time_since packet_loss"),
    ((str, bytes), "startswith endswith lower upper strip lstrip rstrip find rfind split"),
    ((str, bytes), "isdigit isalpha isalnum isupper islower isspace"),
    ((str, bytes, bytearray, list, tuple, range), "index count"),
    ((bytes, bytearray), "decode hex"),
    ((str,), "encode"),
    ((dict,), "get keys values items"),
    ((int, float), "is_integer bit_length bit_count conjugate as_integer_ratio"),
    ((Vector3,), "length angle normalized close copy rotate_by_id rotate_by_inverse_id"),
    ((Matrix3,), "transposed to_euler to_euler312 determinant invert trace close copy"),
    ((QuaternionBase,), "transform close"),
)


def _owners() -> dict[str, tuple[type, ...]]:
    owners: dict[str, tuple[type, ...]] = {}
    for types, names in _METHODS:
        for name in names.split():
            owners[name] = owners.get(name, ()) + types
    return owners


METHOD_OWNERS: dict[str, tuple[type, ...]] = _owners()
"""The types whose method of this name may be called."""
