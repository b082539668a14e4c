"""The error that the shadow raises, and its warning."""

from __future__ import annotations

from typing import Any

VARIABLE = "MAVWIRE_SHADOW"
REFERENCE = "pymavlink"


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


_warned: set[str] = set()


def warn_no_counterpart(name: str) -> None:
    """Says once for each module that it is not compared."""
    import sys

    if name not in _warned:
        _warned.add(name)
        print(
            f"{VARIABLE}: {name} has no counterpart in {REFERENCE}, not compared", file=sys.stderr
        )
