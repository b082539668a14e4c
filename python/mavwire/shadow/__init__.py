"""Shadow mode: mavwire and pymavlink side by side, on the user's own traffic.

``MAVWIRE_SHADOW=pymavlink`` in the environment changes the ``MAVLink`` class of every built-in
dialect. It passes all data also to the installed pymavlink, and raises :class:`ShadowMismatch` at
the first answer that differs. Programs need no change. Intended differences
(docs/compatibility.md) are not reported. Without the variable nothing of this is imported.
"""

from __future__ import annotations

from typing import Any

from ._mismatch import REFERENCE, VARIABLE, ShadowMismatch, warn_no_counterpart

__all__ = ["ShadowMismatch", "attach"]

_BUILT_IN = ("mavwire.dialects.v10", "mavwire.dialects.v20")


def attach(namespace: dict[str, Any]) -> None:
    """Puts the shadow around ``MAVLink`` of a dialect module, whose globals are ``namespace``.

    ValueError if the variable names anything but pymavlink. Dialects that are not built in have no
    counterpart; a line on stderr says so, and they stay as they are.
    """
    import os

    from mavwire.shadow import _link

    chosen = os.environ[VARIABLE]
    if chosen != REFERENCE:
        raise ValueError(f"{VARIABLE} must be {REFERENCE!r} or unset, not {chosen!r}")
    name = namespace["__name__"]
    if name.rpartition(".")[0] in _BUILT_IN:
        namespace["MAVLink"] = _link.shadow_class(namespace["MAVLink"], namespace)
    else:
        warn_no_counterpart(name)
