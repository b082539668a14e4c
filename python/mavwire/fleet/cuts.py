"""Finds cuts of a large log, so that its parts give exactly the rows of the whole log.

The records at a position depend on the bytes before it: on damage, on the last believed time, and on
unknown ids. So the log is read once without making tables, and cut between good records, far from
damage. A log with unknown ids is not cut, and a log without such positions stays whole. A raw stream
stays whole, too: its times depend on all frames before. Each part is given the kind of the log, so it
need not be recognised by the bytes of the part.
"""

from __future__ import annotations

import os

from mavwire.dialects import UPSTREAM
from mavwire.logs.reading import native_dialect
from mavwire.logs.selection import UNKNOWN
from mavwire.logs.sources import is_compressed, is_dataflash
from mavwire.logs.summary import LogInfo, summarise

from .places import Part

CLEAN = 64 << 10
"""Bytes without damage in front of a cut: more than a frame may claim to reach."""


def find_cuts(path: str, part_bytes: int, dialect: str | os.PathLike[str] = UPSTREAM) -> list[Part]:
    """The parts of a local log, of at least `part_bytes` each; none where it has to stay whole."""
    if is_compressed(path) or is_dataflash(path):
        return []
    places: list[int] = []
    info = summarise(path, native_dialect(dialect)[1], places.append)
    if not info.stamped or any(name.startswith(UNKNOWN) for name in info.types):
        return []
    cuts = [0]
    for place in places:
        far = place - cuts[-1] >= part_bytes and info.bytes - place >= part_bytes
        if far and _is_clean(place, info):
            cuts.append(place)
    ranges = [(start, end, True) for start, end in zip(cuts, [*cuts[1:], info.bytes], strict=True)]
    return ranges if len(ranges) > 1 else []


def _is_clean(place: int, info: LogInfo) -> bool:
    """Whether good records stand on both sides of a place, and nothing else for a while before."""
    if info.bad_count > len(info.bad) and place >= info.bad[-1][0]:
        return False  # not all damage is listed
    return not any(start <= place and start + length > place - CLEAN for start, length in info.bad)
