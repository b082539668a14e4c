"""Lists of mission items: what a ground station edits, draws, sends and keeps in files."""

from __future__ import annotations

import copy
import time
from bisect import bisect_right, insort
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

from mavwire import mavutil
from mavwire._atomic_file import replace_text

from . import MAVWPError, files

if TYPE_CHECKING:
    from mavwire._native import Message
    from mavwire._stubs.mavutil import ReceivedMessage

DO_JUMP = 177
DO_RETURN_PATH_START, DO_LAND_START = 188, 189
VTOL_LAND = 85
FENCE_RETURN_POINT = 5000
FENCE_VERTEX_INCLUSION, FENCE_VERTEX_EXCLUSION = 5001, 5002
RALLY_POINT = 5100
# Ways into these items are drawn on their own.
_STARTS = frozenset((DO_RETURN_PATH_START, DO_LAND_START))
_ENDS = frozenset((files.LAND, VTOL_LAND))
_COLOURS = {
    FENCE_VERTEX_EXCLUSION: (255, 0, 0),
    FENCE_VERTEX_INCLUSION: (0, 255, 0),
    DO_LAND_START: (255, 127, 0),
    DO_RETURN_PATH_START: (127, 255, 0),
}

_NO_PROTOBUF = "Mission files in protobuf format (QGC WPL PB 110) are not supported"

Point = tuple[Any, ...]
Indexes = set[int]


class MissionItemProtocol:
    """A list of MISSION_ITEM or MISSION_ITEM_INT messages for one vehicle.

    `wpoints` are the items, `last_change` is when they changed (a time, 0 before the first change).
    """

    def __init__(self, target_system: int = 0, target_component: int = 0) -> None:
        self.wpoints: list[ReceivedMessage] = []
        self.target_system = target_system
        self.target_component = target_component
        self.last_change: float = 0
        self.colour_for_polygon = dict(_COLOURS)

    def mav_mission_type(self) -> int:
        """The MAV_MISSION_TYPE of the items."""
        return 0

    # -- the list

    def count(self) -> int:
        """How many items there are."""
        return len(self.wpoints)

    def wp(self, i: int) -> ReceivedMessage | Any:
        """Item `i`, or None when there is none."""
        try:
            return self.wpoints[i]
        except (IndexError, TypeError):
            return None

    def item(self, i: int) -> ReceivedMessage | Any:
        """Item `i`, or None when there is none."""
        return self.wp(i)

    def _changed(self) -> None:
        self.last_change = time.time()

    def add(self, w: Message | list[Any], comment: str = "") -> None:
        """Append a copy of an item, or of each item of a list; `comment` goes with a single one."""
        self._put(len(self.wpoints), w, comment)

    def insert(self, idx: int, w: Message | list[Any], comment: str = "") -> None:
        """Put a copy of an item, or of each item of a list, before item `idx`.

        Beyond the end it is appended; a negative `idx` is no place and nothing happens.
        """
        if idx >= len(self.wpoints):
            self.add(w, comment)
        elif idx >= 0:
            self._put(idx, w, comment)
            self.reindex()

    def _put(self, idx: int, w: Any, comment: str) -> None:
        if isinstance(w, list):
            fresh = copy.deepcopy(w)
        else:
            fresh = [copy.copy(w)]
            if comment:
                fresh[0].comment = comment
        for seq, one in enumerate(fresh, start=idx):
            one.seq = seq
        self.wpoints[idx:idx] = fresh
        self._changed()

    def reindex(self) -> None:
        """Number the items from 0."""
        for seq, w in enumerate(self.wpoints):
            w.seq = seq
        self._changed()

    def set(self, w: Message, idx: int) -> None:
        """Replace item `idx`; `idx` may be the number of items, which appends."""
        item: Any = w
        item.seq = idx
        if idx == len(self.wpoints):
            self.wpoints.append(item)
        elif idx < len(self.wpoints):
            self.wpoints[idx] = item
        else:
            count = len(self.wpoints)
            raise MAVWPError(f"adding waypoint at idx={idx} past end of list (count={count})")
        self._changed()

    def remove(self, w: Message | list[Any]) -> None:
        """Remove an item, or each item of a list; ValueError when there is no equal item."""
        items: list[Any] = w if isinstance(w, list) else [w]
        for one in items:
            self.wpoints.remove(one)
        self.reindex()

    def clear(self) -> None:
        """Remove all items."""
        self.wpoints = []
        self._changed()

    # -- files

    def load(self, filename: str) -> int | None:
        """Read a file in the place of the items; how many there are.

        After an error in a line there are no items: half a mission is not one.
        """
        lines = files.read_lines(filename)
        header = lines[0].text if lines else ""
        if header == "QGC WPL PB 110":
            raise MAVWPError(_NO_PROTOBUF, filename)
        read = self._reader(header)
        if read is None:
            raise MAVWPError(f"Unsupported waypoint format '{header}'", filename)
        self.clear()
        items = list(read(lines[1:]))
        for one in items:
            self.add(self._new_item(*one.values), one.comment)
        return len(self.wpoints)

    def _reader(self, header: str) -> Callable[[list[files.Line]], Iterable[files.ItemLine]] | None:
        """The reader of a file with this first line."""
        if header == "QGC WPL 110":
            return files.items_v110
        return None

    def _new_item(self, *values: Any) -> Any:
        """A MISSION_ITEM for the vehicle; `values` are its fields from `seq` on."""
        kind = (self.mav_mission_type(),) if mavutil.mavlink20() else ()
        message = mavutil.mavlink.MAVLink_mission_item_message
        return message(self.target_system, self.target_component, *values, *kind)

    def save(self, filename: str) -> None:
        """Write the items as a QGC WPL 110 file; after an error the file is as it was."""
        lines = [
            files.comment_lines(getattr(w, "comment", "")) + files.item_line(w)
            for w in self.wpoints
        ]
        replace_text(filename, "QGC WPL 110\n" + "".join(lines))

    def save_as_pb(self, filename: str) -> None:
        """Raise MAVWPError: the protobuf format has no public definition."""
        raise MAVWPError(_NO_PROTOBUF, filename)

    # -- where a vehicle flies

    def is_location_command(self, cmd: int) -> bool:
        """Whether the command has a position."""
        return True

    def is_location_wp(self, w: ReceivedMessage) -> bool:
        """Whether a vehicle flies to the item: its command has a position, and that is not 0, 0."""
        if w.command == DO_LAND_START or (w.x == 0 and w.y == 0):
            return False
        return self.is_location_command(w.command)

    def view_indexes(self, done: Indexes | None = None) -> list[int]:
        """Indexes of the items that a vehicle passes from the first one that is not in `done`.

        Follows each DO_JUMP once, ends behind a landing, and at an item that was passed already.
        The indexes of what was looked at are added to `done`.
        """
        done = Indexes() if done is None else done
        start = next((i for i in range(len(self.wpoints)) if i not in done), len(self.wpoints))
        return self._path(start, done, _Starts(self.wpoints, done))

    def _path(self, idx: int, done: Indexes, starts: _Starts) -> list[int]:
        path: list[int] = []
        while 0 <= idx < len(self.wpoints):
            w = self.wpoints[idx]
            if idx in done:
                if self.is_location_wp(w):
                    path.append(idx)
                break
            if w.command in _STARTS and path:  # drawn on its own
                idx = starts.skip(idx)
                continue
            done.add(idx)
            if w.command in _STARTS:
                starts.add(idx)
            if w.command == DO_JUMP:
                idx = self._jump_target(w)
                if idx >= 0 and self.is_location_wp(self.wpoints[idx]):
                    path.append(idx)
                continue
            if w.command in _STARTS or self.is_location_wp(w):
                path.append(idx)
            if w.command in _ENDS:
                break
            idx += 1
        return path

    def _jump_target(self, w: Any) -> int:
        """Where a DO_JUMP leads to; -1 when that is no item."""
        return int(w.param1) if 0 <= w.param1 < len(self.wpoints) else -1

    def view_list(self) -> list[list[int]]:
        """All paths through the items, as lists of indexes."""
        return [path for path in self._paths() if path]

    def _paths(self) -> Iterator[list[int]]:
        done: Indexes = Indexes()
        starts = _Starts(self.wpoints, done)
        for start in range(len(self.wpoints)):
            if start not in done:
                yield self._path(start, done, starts)

    def polygon(self, done: Indexes | None = None) -> list[Point]:
        """Like `view_indexes`, but the positions: x, y and for some commands a colour."""
        return [self._point(index) for index in self.view_indexes(done)]

    def _point(self, index: int) -> Point:
        w = self.wpoints[index]
        if w.command in self.colour_for_polygon:
            return w.x, w.y, self.colour_for_polygon[w.command]
        return w.x, w.y

    def polygon_list(self) -> list[list[Point]]:
        """All paths through the items, as lists of positions."""
        return [[self._point(index) for index in path] for path in self.view_list()]


class _Starts:
    """Where runs of starts end, so that no path walks over each of them."""

    def __init__(self, items: list[ReceivedMessage], done: Indexes) -> None:
        self._behind = list(range(1, len(items) + 1))
        for idx in range(len(items) - 2, -1, -1):
            if items[idx + 1].command in _STARTS:
                self._behind[idx] = self._behind[idx + 1]
        self._done = sorted(
            idx for idx in done if 0 <= idx < len(items) and items[idx].command in _STARTS
        )

    def add(self, idx: int) -> None:
        """A start was passed: paths end there."""
        insort(self._done, idx)

    def skip(self, idx: int) -> int:
        """The next item behind a start that is no start or was passed."""
        place = bisect_right(self._done, idx)
        return min([self._behind[idx], *self._done[place : place + 1]])


class MAVWPLoader(MissionItemProtocol):
    """The items of a mission."""

    if TYPE_CHECKING:

        def load(self, filename: str) -> int: ...  # None is for fences

    def wp_is_loiter(self, i: int) -> bool:
        """Whether item `i` loiters; without end, for turns, for a time or to an altitude."""
        return self.wpoints[i].command in (17, 18, 19, 31)

    def add_latlonalt(
        self, lat: float, lon: float, altitude: float, terrain_alt: bool = False
    ) -> None:
        """Append a waypoint; `altitude` is above home, or above ground."""
        frame = 10 if terrain_alt else 3
        head = 0, frame, files.WAYPOINT, 0, 0, 0, 0, 0, 0
        self.add(self._new_item(*head, lat, lon, altitude))

    def _reader(self, header: str) -> Callable[[list[files.Line]], Iterable[files.ItemLine]] | None:
        return files.items_v100 if header == "QGC WPL 100" else super()._reader(header)

    def is_location_command(self, cmd: int) -> bool:
        """Whether the definition of the command says that it has a position."""
        entry = mavutil.mavlink.enums["MAV_CMD"].get(cmd)
        return bool(entry is not None and entry.has_location)


def _item_int(loader: MissionItemProtocol, frame: int, command: int, **fields: Any) -> Any:
    """A MISSION_ITEM_INT for the loader's vehicle."""
    values = {"param1": 0, "param2": 0, "param3": 0, "param4": 0, "z": 0} | fields
    return mavutil.mavlink.MAVLink_mission_item_int_message(
        loader.target_system, loader.target_component, seq=0, frame=frame, command=command,
        current=0, autocontinue=0, mission_type=loader.mav_mission_type(), **values,
    )  # fmt: skip


def _needs_mavlink2() -> None:
    if not mavutil.mavlink20():
        raise ValueError("Must be using mavlink2")


class MissionItemProtocol_Fence(MissionItemProtocol):
    """The items of a fence."""

    def mav_mission_type(self) -> int:
        """The MAV_MISSION_TYPE of the items."""
        return 1

    def load(self, filename: str) -> int | None:
        """Read a QGC WPL file, or one with a latitude and a longitude a line.

        Of the latter the first is the return point and the last, which closes the polygon, is left
        out; None is returned. With fewer than five nothing is changed.
        """
        _needs_mavlink2()
        lines = files.read_lines(filename)
        if not files.is_fence_file(lines):
            return super().load(filename)
        points = [(int(lat * 1e7), int(lng * 1e7)) for lat, lng in files.fence_points(lines)]
        if len(points) < 5:
            print("Insufficient points in file")
            return None
        home, *vertices = points[:-1]
        self.clear()
        self.add(_item_int(self, 0, FENCE_RETURN_POINT, x=home[0], y=home[1]))
        for x, y in vertices:
            self.add(_item_int(self, 0, FENCE_VERTEX_INCLUSION, param1=len(vertices), x=x, y=y))
        return None


class MissionItemProtocol_Rally(MissionItemProtocol):
    """Rally points as items."""

    def mav_mission_type(self) -> int:
        """The MAV_MISSION_TYPE of the items."""
        return 2

    def load(self, filename: str) -> int | None:
        """Read a QGC WPL file, or one with RALLY lines, for which None is returned."""
        _needs_mavlink2()
        lines = files.read_lines(filename)
        if not files.is_rally_file(lines):
            return super().load(filename)
        points = list(files.rally_points(lines))
        self.clear()
        for point in points:
            self.add(_item_int(self, 3, RALLY_POINT, x=point.lat, y=point.lng, z=point.alt))
        return None
