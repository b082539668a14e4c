"""Flight modes of a vehicle over a log, and colours for them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import isfinite
from types import SimpleNamespace
from typing import Any

from mavwire.links.modes import mode_string_v10
from mavwire.links.tracking import MAV_AUTOPILOT_INVALID, MAV_COMP_ID_GIMBAL, NOT_VEHICLES
from mavwire.logs.table import Table

COLOURS = (
    "#4c78a8", "#f58518", "#54a24b", "#e45756", "#b279a2", "#72b7b2", "#eeca3b", "#9d755d",
    "#ff9da6", "#79706e",
)  # fmt: skip
MOST_SPANS = 10_000
"""Limit of the changes of mode that are shown: a forged log may have any number."""
UNKNOWN = "UNKNOWN"
EQUIPMENT = NOT_VEHICLES | {5, *range(30, 35), *range(36, 43), 44, 48}
"""Values of MAV_TYPE for equipment that may have an autopilot: antenna trackers, cameras, winches
and the like.
"""


@dataclass(frozen=True)
class Span:
    """A stretch of time in one mode, seconds since 1970."""

    mode: str
    start: float
    end: float


def vehicle_rows(heartbeats: Table) -> Any:
    """Which HEARTBEAT rows come from an autopilot: a mask."""
    import numpy as np

    others = np.isin(heartbeats["type"], list(NOT_VEHICLES))
    gimbal = heartbeats["compid"] == MAV_COMP_ID_GIMBAL
    return ~others & ~gimbal & (heartbeats["autopilot"] != MAV_AUTOPILOT_INVALID)


def vehicle_of(heartbeats: Table, tables: Iterable[Table]) -> int | None:
    """The system id of the vehicle: that of the first autopilot. Vehicles are preferred to equipment
    such as antenna trackers, and then systems with rows in `tables` to others.
    """
    import numpy as np

    rows = vehicle_rows(heartbeats)
    systems = heartbeats["sysid"][rows]
    if not len(systems):
        return None
    equipment = np.isin(heartbeats["type"][rows], list(EQUIPMENT))
    heard = [table["sysid"] for table in tables]
    silent = ~np.isin(systems, np.concatenate(heard) if heard else [])
    return int(systems[np.argmin(2 * equipment + silent)])


def mode_changes(
    heartbeats: Table, system: int | None, autopilot: int | None = None
) -> list[tuple[float, str]]:
    """When a system went into which mode; as `autopilot` calls them, or else as itself does."""
    import numpy as np

    rows = vehicle_rows(heartbeats) & (heartbeats["sysid"] == (system or 0))
    rows &= ~np.isnat(heartbeats["timestamp"])  # messages of a raw stream before its first time
    names = ("type", "autopilot", "base_mode", "custom_mode")
    columns = [heartbeats[name][rows] for name in names]
    times = heartbeats["timestamp"][rows].astype("int64") * 1e-6
    if not len(times):
        return []
    differs = np.zeros(len(times), bool)
    differs[0] = True
    for column in columns:
        differs[1:] |= column[1:] != column[:-1]
    found: list[tuple[float, str]] = []
    for row in np.flatnonzero(differs):
        values = {name: int(column[row]) for name, column in zip(names, columns, strict=True)}
        if autopilot is not None:
            values["autopilot"] = autopilot
        mode = mode_string_v10(SimpleNamespace(get_msgId=lambda: 0, **values))
        found.append((float(times[row]), mode))
    return found


def spans(changes: Iterable[tuple[float, str]], end: float | None) -> list[Span]:
    """Stretches of time, each to the next change of mode, the last to `end`. Changes at a damaged
    time, which is no number, are left out.
    """
    distinct: list[tuple[float, str]] = []
    for time, mode in changes:
        if isfinite(time) and mode != UNKNOWN and (not distinct or distinct[-1][1] != mode):
            distinct.append((time, mode))
    distinct = distinct[:MOST_SPANS]
    ends = [time for time, _ in distinct[1:]]
    if distinct:
        ends.append(max(distinct[-1][0], end if end is not None else distinct[-1][0]))
    return [Span(mode, t, after) for (t, mode), after in zip(distinct, ends, strict=True)]


def colours_of(modes: Iterable[str]) -> dict[str, str]:
    """A colour for each mode, in the order they first come."""
    return {mode: COLOURS[n % len(COLOURS)] for n, mode in enumerate(dict.fromkeys(modes))}
