"""Shadow mode: mavwire and pymavlink side by side, on the user's own traffic.

With ``MAVWIRE_SHADOW=pymavlink`` in the environment, the ``MAVLink`` class of every built-in dialect
gives what it parses, decodes and sends to the installed pymavlink as well, and raises
:class:`ShadowMismatch` at the first answer that differs. Programs need no change. What differs on
purpose (docs/compatibility.md) is not reported. Without the variable nothing of this is imported.
"""

from __future__ import annotations

from typing import Any

__all__ = ["ShadowMismatch", "attach"]

VARIABLE = "MAVWIRE_SHADOW"
REFERENCE = "pymavlink"
_BUILT_IN = ("mavwire.dialects.v10", "mavwire.dialects.v20")


class ShadowMismatch(AssertionError):
    """mavwire and pymavlink answered differently.

    ``operation`` is the method, ``part`` what differs about its answer, ``ours`` and ``theirs``
    the two values; ``offset`` counts the bytes that this ``MAVLink`` was given before the frame
    (None for what is sent or decoded singly), ``frame`` are the bytes concerned.
    """

    def __init__(
        self, operation: str, part: str, ours: Any, theirs: Any, offset: int | None, frame: bytes
    ) -> None:
        super().__init__(operation, part, ours, theirs, offset, frame)
        self.operation = operation
        self.part = part
        self.ours = ours
        self.theirs = theirs
        self.offset = offset
        self.frame = frame

    def __str__(self) -> str:
        place = "" if self.offset is None else f" at byte {self.offset} of the stream"
        return (
            f"mavwire and {REFERENCE} differ in {self.operation}{place}: {self.part}\n"
            f"  mavwire    {self.ours!r}\n"
            f"  {REFERENCE}  {self.theirs!r}\n"
            f"  frame      {self.frame.hex()}"
        )


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


_warned: set[str] = set()


def warn_no_counterpart(name: str) -> None:
    """Says once for each module that it is not compared."""
    import sys

    if name not in _warned:
        _warned.add(name)
        print(
            f"{VARIABLE}: {name} has no counterpart in {REFERENCE}, not compared", file=sys.stderr
        )
