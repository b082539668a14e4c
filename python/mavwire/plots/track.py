"""Where a vehicle was, in which mode, and where it was to go."""

from __future__ import annotations

import os
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from mavwire.dialects import UPSTREAM
from mavwire.logs.no_records import check_records
from mavwire.logs.selection import system_of
from mavwire.logs.sources import decompressed
from mavwire.logs.table import Table

from .modes import Span, colours_of, mode_changes, spans, vehicle_of
from .series import busiest_system, is_telemetry, vehicle_messages

FIX_2D = 2
MISSION = 0
GLOBAL_FRAMES = frozenset((0, 3, 5, 6, 10, 11))
"""Values of MAV_FRAME in which positions are latitude and longitude."""
ARDUPILOT = 3
ORIGIN_OF_HOME = 1
MOST_WAYPOINTS = 65_536
NO_MODE = "#555555"
"""The colour of points in no known mode."""


@dataclass(frozen=True)
class Place:
    """A position in degrees, and metres."""

    name: str
    lat: float
    lon: float
    alt: float


@dataclass
class Track:
    """Positions over time: arrays of seconds since 1970, degrees, and metres above the sea."""

    path: str
    times: Any
    lat: Any
    lon: Any
    alt: Any
    modes: list[Span] = field(default_factory=list)
    home: Place | None = None
    waypoints: list[Place] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The name of the log."""
        return os.path.basename(self.path)

    def colours(self) -> dict[str, str]:
        """A colour for each mode, and for none ("")."""
        return {"": NO_MODE, **colours_of(span.mode for span in self.modes)}

    def stretches(self) -> Iterator[tuple[str, int, int]]:
        """Points in one mode: its name, "" where none is known, the first and behind the last."""
        import numpy as np

        starts = np.array([span.start for span in self.modes])
        which = np.searchsorted(starts, self.times, side="right") - 1
        edges = np.flatnonzero(np.diff(which)) + 1
        bounds = [0, *edges.tolist(), len(which)]
        for first, end in pairwise(bounds):
            if end > first:
                yield (self.modes[which[first]].mode if which[first] >= 0 else ""), first, end


def read_track(
    path: str, *, system: int | None = None, dialect: str | os.PathLike[str] = UPSTREAM
) -> Track:
    """The track of a log. `system` is the vehicle's, by default the first autopilot that is heard.

    Raises OSError for a log that cannot be read, ValueError for one that is none, or without a
    single position.
    """
    system = None if system is None else system_of(system)
    if is_telemetry(path):
        track = _from_tables(path, system, dialect)
    else:
        track = _from_messages(path, path)
    if not len(track.times):
        check_records(path, dialect)
        raise ValueError(f"there is no position in {path!r}")
    return track


def _track(
    path: str, columns: tuple[Any, Any, Any, Any], changes: list[tuple[float, str]]
) -> Track:
    """A track of the positions that are some."""
    import numpy as np

    times, lat, lon, alt = columns
    good = (np.abs(lat) <= 90) & (np.abs(lon) <= 180) & ((lat != 0) | (lon != 0))
    times, lat, lon = times[good], lat[good], lon[good]
    alt = np.nan_to_num(alt[good], posinf=0, neginf=0)
    end = float(times.max()) if len(times) else None
    return Track(path, times, lat, lon, alt, spans(changes, end))


# -- telemetry


def _from_tables(path: str, system: int | None, dialect: str | os.PathLike[str]) -> Track:
    import numpy as np

    from mavwire.logs import DataflashLog, open_log, read

    log = open_log(path, dialect=dialect)  # says what the file is, if it is no telemetry log
    if isinstance(log, DataflashLog):  # compressed, or under a name of another kind
        with decompressed(path) as copy:
            return _from_messages(copy, path)
    names = "GLOBAL_POSITION_INT GPS_RAW_INT HEARTBEAT HOME_POSITION".split()
    names += "MISSION_COUNT MISSION_ITEM MISSION_ITEM_INT".split()
    tables = read(path, names, invalid="null", dialect=dialect)
    if system is None:
        positions = (tables["GLOBAL_POSITION_INT"], tables["GPS_RAW_INT"])
        system = vehicle_of(tables["HEARTBEAT"], positions) or busiest_system(path, dialect)
    columns = _positions(tables["GLOBAL_POSITION_INT"], system)
    if not np.nan_to_num(columns[1]).any():
        columns = _positions(tables["GPS_RAW_INT"], system)
    track = _track(path, columns, mode_changes(tables["HEARTBEAT"], system))
    items = _mission(tables, system)
    track.home = _home(tables["HOME_POSITION"], system)
    autopilots = set(tables["HEARTBEAT"]["autopilot"][tables["HEARTBEAT"]["sysid"] == system])
    if ARDUPILOT in autopilots and 0 in items:  # there the first item is home
        first = items.pop(0)
        track.home = track.home or Place("home", first.lat, first.lon, first.alt)
    track.waypoints = [items[seq] for seq in sorted(items)]
    return track


def _home(homes: Table, system: int | None) -> Place | None:
    """The last home of a system that is a place."""
    rows = homes["sysid"] == system
    columns = (homes[name][rows].tolist() for name in ("latitude", "longitude", "altitude"))
    for lat, lon, alt in reversed(list(zip(*columns, strict=True))):
        if _is_place(home := Place("home", lat / 1e7, lon / 1e7, alt / 1e3)):
            return home
    return None


def _positions(table: Table, system: int | None) -> tuple[Any, Any, Any, Any]:
    rows = table["sysid"] == system
    if "fix_type" in table.columns:
        rows &= table["fix_type"] >= FIX_2D
    import numpy as np

    stamps = table["timestamp"][rows]
    unknown = np.isnat(stamps)
    # The first messages of a raw stream have no time, and some streams have no times at all.
    micros = np.where(unknown, np.arange(len(stamps)) if unknown.all() else 0, stamps.view("int64"))
    lat, lon, alt = (table[name][rows] for name in ("lat", "lon", "alt"))
    return micros * 1e-6, lat / 1e7, lon / 1e7, alt / 1e3


def _mission(tables: dict[str, Table], system: int | None) -> dict[int, Place]:
    """The items of the vehicle's mission as it was last sent or fetched."""
    import numpy as np

    events = []
    for name in ("MISSION_COUNT", "MISSION_ITEM", "MISSION_ITEM_INT"):
        table = tables[name]
        ours = (table["sysid"] == system) | (table["target_system"] == system)
        ours &= table["mission_type"] == MISSION
        ours &= ~np.isnat(table["timestamp"])  # in a raw stream nothing tells which came last
        stamps = table["timestamp"].astype("int64")
        events += [(int(stamps[row]), name, int(row)) for row in ours.nonzero()[0]]
    items: dict[int, Place] = {}
    known: set[int] = set()
    least = MOST_WAYPOINTS
    # From the last one on: the newest item of a number counts, if no count behind it leaves it out.
    for _, name, row in sorted(events, reverse=True):
        table = tables[name]
        if name == "MISSION_COUNT":
            least = min(least, int(table["count"][row]))
            continue
        seq = int(table["seq_"][row])
        if seq in known or seq >= least:
            continue
        known.add(seq)
        scale = 1e7 if name == "MISSION_ITEM_INT" else 1.0
        lat, lon, alt = (float(table[axis][row]) for axis in "xyz")
        place = Place(f"{seq}", lat / scale, lon / scale, alt)
        if int(table["frame"][row]) in GLOBAL_FRAMES and _is_place(place):
            items[seq] = place
    return items


def _is_place(place: Place) -> bool:
    inside = abs(place.lat) <= 90 and abs(place.lon) <= 180 and abs(place.alt) < 1e6
    return inside and (place.lat != 0 or place.lon != 0)


# -- dataflash


def _from_messages(path: str, name: str) -> Track:
    """The track of a dataflash log, which is called `name`."""
    import numpy as np

    points = {"POS": array("d"), "GPS": array("d")}  # four numbers a position, hours of them
    changes: list[tuple[float, str]] = []
    items: dict[int, Place] = {}
    home = None
    for msg, log in vehicle_messages(path, ["POS", "GPS", "CMD", "ORGN", "MODE"], None, UPSTREAM):
        kind = msg.get_type()
        if not changes or changes[-1][1] != log.flightmode:
            changes.append((msg._timestamp, log.flightmode))
        if kind == "MODE" or not all(hasattr(msg, name) for name in ("Lat", "Lng", "Alt")):
            continue
        place = Place("home", float(msg.Lat), float(msg.Lng), float(msg.Alt))
        if kind == "GPS" and getattr(msg, "Status", FIX_2D) < FIX_2D:
            continue
        if kind in points:
            points[kind].extend((msg._timestamp, place.lat, place.lon, place.alt))
        elif not _is_place(place):
            continue
        elif kind == "ORGN" and getattr(msg, "Type", None) == ORIGIN_OF_HOME:
            home = place
        elif kind == "CMD" and len(items) < MOST_WAYPOINTS:
            number = int(getattr(msg, "CNum", 0))
            items[number] = Place(f"{number}", place.lat, place.lon, place.alt)
    rows = points["POS"] or points["GPS"]
    columns = tuple(np.array(rows).reshape(-1, 4).T)
    track = _track(name, columns, changes)  # type: ignore[arg-type]
    first = items.pop(0, None)
    if home is None and first is not None:
        home = Place("home", first.lat, first.lon, first.alt)
    track.home, track.waypoints = home, [items[number] for number in sorted(items)]
    return track
