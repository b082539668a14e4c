"""Where the records of a dataflash log begin: the interface of pymavlink's `dfindexer`.

mavwire's own readers do not need it; they lose no record behind one that is damaged.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

available = True
"""Whether there is an index; always."""

_HEADER = 3
_TYPES = 256


def build_offsets(
    data: bytes | bytearray | memoryview,
    fmt_type: int,
    fmt_length: int,
    type_offset: int,
    length_offset: int,
    head1: int,
    head2: int,
    progress_callback: Callable[[int], Any] | None = None,
) -> list[list[int]]:
    """256 lists, by type, of the offsets at which records begin; the last may be cut.

    `fmt_type` is the type of FMT records, `fmt_length` their length; `type_offset` and
    `length_offset` say where in them a type and its length stand; records begin with `head1` and
    `head2`. Bytes between records are passed over, and said on standard error as is where the search
    ends: at a type that no FMT describes, or an FMT with a length below 3. Raises ValueError for a
    type or a byte that is none.
    """
    for name, value in (("fmt_type", fmt_type), ("head1", head1), ("head2", head2)):
        if not 0 <= value < _TYPES:
            raise ValueError(f"{name} is a byte, not {value}")
    if min(fmt_length, type_offset, length_offset) < 0:
        raise ValueError("lengths and offsets are not below 0")
    offsets: list[list[int]] = [[] for _ in range(_TYPES)]
    lengths = [0] * _TYPES
    lengths[fmt_type] = fmt_length
    view = memoryview(data).cast("B")
    problem = _walk(view, offsets, lengths, fmt_type, (type_offset, length_offset), (head1, head2))
    if problem:
        print(problem, file=sys.stderr)
    if progress_callback is not None:
        progress_callback(100)
    return offsets


def _walk(
    data: memoryview,
    offsets: list[list[int]],
    lengths: list[int],
    fmt_type: int,
    places: tuple[int, int],
    head: tuple[int, int],
) -> str:
    """Fill the offsets; why the search ended before the end, if it did."""
    at, size = 0, len(data)
    while at + _HEADER < size:
        if (data[at], data[at + 1]) != head:
            print(f"bad header 0x{data[at]:02x}{data[at + 1]:02x} at {at}", file=sys.stderr)
            at += 1
            continue
        kind = data[at + 2]
        if kind == fmt_type and at + max(places) < size:
            described, length = (data[at + place] for place in places)
            if length < _HEADER:
                return f"Invalid length in FMT message at {at}"
            lengths[described] = length
        elif kind == fmt_type:
            return f"Invalid length in FMT message at {at}"
        if not lengths[kind]:
            return f"unknown msg type 0x{kind:02x} ({kind}) at {at}"
        offsets[kind].append(at)
        at += lengths[kind]
    return ""
