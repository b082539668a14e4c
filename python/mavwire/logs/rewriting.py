"""Telemetry logs made of others: `cut`, `repair`, `anonymize`, `merge`.

The records are found and written natively, in blocks, so that memory does not depend on the size of
a log. A log that is damaged gives all its good records. The output appears when it is complete, and
is refused where it is one of the inputs. gzip and zstd are decompressed on the way.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any, Unpack

from mavwire._native import LogRewrite
from mavwire._text import naming
from mavwire.dialects import UPSTREAM

from .dialect import Dialects
from .format_error import LogFormatError
from .no_records import check_records
from .query import Records, Types, takes
from .reading import check_readable, logs_of, native_dialect
from .selection import Selection
from .sources import check_has_records, is_dataflash
from .targets import file_to_write

MOST_NORTH = 8.0
MOST_EAST = 180.0
"""Degrees that positions are shifted by at most where nobody says how far. More to the north would
bend what was flown far from the equator.
"""


@dataclass(frozen=True)
class Rewritten:
    """The result of rewriting logs."""

    bytes: int
    """Read, decompressed."""
    records: int
    """Good ones in them."""
    written: int
    bad_bytes: int
    """Bytes that belong to no record and are left out."""
    bad_places: int
    restamped: int
    """Records behind damage whose time was days off and is now that of the last good one."""
    damage: str | None
    """The damage of compressed files, with the name of each if there are several. Everything in front
    of it was read.
    """


@takes(Records, "systems", "start", "end")
def cut(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str],
    types: Types = None,
    *positional: Any,
    dialect: Dialects = UPSTREAM,
    progress: Callable[[int], object] | None = None,
    **query: Unpack[Records],
) -> Rewritten:
    """Write the records of some types and systems with `start <= time < end` to a log of their own.

    The arguments are those of `TelemetryLog.messages`; ids that the dialect lacks are kept unless
    `types` says otherwise. A raw stream gives a raw stream. `progress` is told the bytes read.
    ValueError for an argument that makes no sense, LogFormatError for what is no telemetry log.
    """
    module, native = native_dialect(dialect)
    inputs, target = _checked([path], out, dialect)
    selection = Selection.of(module, types, **query)
    selection.check_telemetry()
    return _run(LogRewrite(inputs, native, target, selection), inputs, progress)


def repair(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    dialect: Dialects = UPSTREAM,
    progress: Callable[[int], object] | None = None,
) -> Rewritten:
    """Write all good records of a damaged log, which any reader then finds.

    A record is good if its checksum is. Times that damage made implausible are replaced: behind
    bytes of no record, and single ones days from the times in front and behind. Ids that the
    dialect lacks have no checksum that could be told, and are kept where they stand in line.
    """
    return cut(path, out, dialect=dialect, progress=progress)


def anonymize(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    shift: tuple[float, float] | None = None,
    dialect: Dialects = UPSTREAM,
    progress: Callable[[int], object] | None = None,
) -> Rewritten:
    """Write a log without what tells who flew where; docs/columns.md lists what that is.

    Positions are moved by `shift`, degrees to the north and to the east, which is made up where it
    is None. ValueError where it is not finite or beyond 90 and 360 degrees.
    """
    if shift is None:
        random = secrets.SystemRandom()
        shift = (random.uniform(-MOST_NORTH, MOST_NORTH), random.uniform(-MOST_EAST, MOST_EAST))
    try:
        north, east = shift
        valid = abs(north) <= 90 and abs(east) <= 360
    except (TypeError, ValueError):
        valid = False
    if not valid:
        raise ValueError(f"a shift is degrees to the north and east, not {shift!r}")
    _, native = native_dialect(dialect)
    inputs, target = _checked([path], out, dialect)
    return _run(LogRewrite(inputs, native, target, Selection(), shift), inputs, progress)


def merge(
    paths: Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    dialect: Dialects = UPSTREAM,
    progress: Callable[[int], object] | None = None,
) -> Rewritten:
    """Write the good records of several logs as one, in the order of time.

    Each log is read in its own order; of records of one time those of the first log come first.
    ValueError for a raw stream, which has no time stamps, LogFormatError for what is no telemetry log.
    """
    _, native = native_dialect(dialect)
    inputs, target = _checked(paths, out, dialect)
    rewrite = LogRewrite(inputs, native, target)
    return _run(rewrite, inputs, progress, is_damage_named=True)


def _checked(
    paths: Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    dialect: Dialects,
) -> tuple[list[str], str]:
    """The names as texts; raises what tells why they cannot be read or written."""
    inputs, out = logs_of(paths), file_to_write(out)
    for path in inputs:
        check_readable(path)
        if os.path.exists(out) and os.path.samefile(path, out):
            raise ValueError(f"{out!r} is the log itself: choose another file to write")
        if is_dataflash(path):
            check_records(path, dialect)
            raise LogFormatError(
                f"a dataflash log, not a telemetry log; mavwire convert reads those: {path!r}"
            )
    if out.lower().endswith((".gz", ".zst")):
        raise ValueError(
            f"logs are written uncompressed: another name than {out!r}, or compress it"
        )
    return inputs, out


def _run(
    rewrite: Any,
    paths: list[str],
    progress: Callable[[int], object] | None,
    is_damage_named: bool = False,
) -> Rewritten:
    try:
        with naming(paths[0]) if len(paths) == 1 else nullcontext():
            while rewrite.step():
                if progress is not None:
                    progress(rewrite.outcome()["bytes"])
        damages = []
        for path, (is_empty, damage) in zip(paths, rewrite.faults(), strict=True):
            if damage is not None:
                damages.append(f"{path!r}: {damage}" if is_damage_named else damage)
            if is_empty:
                check_has_records(path, path, damage)
        done = Rewritten(**rewrite.outcome(), damage="; ".join(damages) or None)
        rewrite.commit()
    finally:
        rewrite.abandon()
    return done
