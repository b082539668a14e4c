"""Rally points and fence points in messages of their own, as autopilots took them before these became
mission items.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from mavwire import mavutil
from mavwire._atomic_file import replace_text

from . import files

if TYPE_CHECKING:
    from mavwire._stubs.mavutil import ReceivedMessage

MAX_RALLY_POINTS = 10


class MAVRallyLoader:
    """RALLY_POINT messages; `rally_points` is the list of them."""

    def __init__(self, target_system: int = 0, target_component: int = 0) -> None:
        self.rally_points: list[ReceivedMessage] = []
        self.target_system = target_system
        self.target_component = target_component
        self.last_change: float = 0

    def rally_count(self) -> int:
        """How many rally points there are."""
        return len(self.rally_points)

    def rally_point(self, i: int) -> ReceivedMessage:
        """Rally point `i`, counted from 0."""
        return self.rally_points[i]

    def reindex(self) -> None:
        """Number the points from 0."""
        for index, point in enumerate(self.rally_points):
            point.idx = index
            point.count = len(self.rally_points)
        self.last_change = time.time()

    def append_rally_point(self, p: Any) -> None:
        """Append a RALLY_POINT; an eleventh is refused with a text on standard output."""
        if len(self.rally_points) >= MAX_RALLY_POINTS:
            print(f"Can't have more than {MAX_RALLY_POINTS} rally points, not adding.")
            return
        self.rally_points.append(p)
        self.reindex()

    def create_and_append_rally_point(
        self, lat: int, lon: int, alt: int, break_alt: int, land_dir: int, flags: int
    ) -> None:
        """Append a rally point: degrees times 1e7, metres, hundredths of a degree."""
        target = self.target_system, self.target_component
        whole = [int(value) for value in (lat, lon, alt, break_alt, land_dir)]
        message = mavutil.mavlink.MAVLink_rally_point_message(*target, 0, 0, *whole, flags)
        self.append_rally_point(message)

    def clear(self) -> None:
        """Remove all points."""
        self.rally_points = []
        self.last_change = time.time()

    def _numbered(self, i: int) -> Any:
        """Point `i`, counted from 1; None, and a text on standard output, when there is none."""
        if 1 <= i <= len(self.rally_points):
            return self.rally_points[i - 1]
        print(f"Invalid rally point number {i}")
        return None

    def remove(self, i: int) -> None:
        """Remove point `i`, counted from 1."""
        if self._numbered(i) is not None:
            del self.rally_points[i - 1]
            self.reindex()

    def move(self, i: int, lat: float, lng: float, change_time: bool = True) -> None:
        """Move point `i`, counted from 1, to a place in degrees."""
        point = self._numbered(i)
        if point is not None:
            point.lat, point.lng = int(lat * 1e7), int(lng * 1e7)
            if change_time:
                self.last_change = time.time()

    def set_alt(
        self, i: int, alt: float, break_alt: float | None = None, change_time: bool = True
    ) -> None:
        """Set the altitude of point `i`, counted from 1, in metres, and where loitering ends."""
        point = self._numbered(i)
        if point is not None:
            point.alt = int(alt)
            if break_alt is not None:
                point.break_alt = break_alt
            if change_time:
                self.last_change = time.time()

    def load(self, filename: str) -> int:
        """Read a file of RALLY lines in the place of the points; how many there are."""
        points: list[Any] = list(files.rally_points(files.read_lines(filename), for_messages=True))
        self.clear()
        for p in points:
            self.create_and_append_rally_point(*p)
        return len(self.rally_points)

    def save(self, filename: str) -> None:
        """Write the points as RALLY lines."""
        lines = []
        for p in self.rally_points:
            place = f"{p.lat * 1e-7:f}\t{p.lng * 1e-7:f}"
            rest = f"{p.alt:f}\t{p.break_alt:f}\t{p.land_dir / 100:f}\t{p.flags}"
            lines.append(f"RALLY {place}\t{rest}\n")
        replace_text(filename, "".join(lines))


class MAVFenceLoader:
    """FENCE_POINT messages; the first is where the vehicle returns to, the others are the polygon."""

    def __init__(self, target_system: int = 0, target_component: int = 0) -> None:
        self._points: list[ReceivedMessage] = []
        self._grown = False
        self.target_system = target_system
        self.target_component = target_component
        self.last_change: float = 0

    @property
    def points(self) -> list[ReceivedMessage]:
        """The points, each with its number and how many there are."""
        if self._grown:
            self._number()
        return self._points

    @points.setter
    def points(self, points: list[ReceivedMessage]) -> None:
        self._points = points
        self._grown = False

    def count(self) -> int:
        """How many points there are."""
        return len(self._points)

    def point(self, i: int) -> ReceivedMessage:
        """Point `i`, counted from 0."""
        return self.points[i]

    def add(self, p: Any) -> None:
        """Append a FENCE_POINT."""
        self._points.append(p)
        self._address(p, len(self._points) - 1)
        self._grown = True  # all others are told when somebody looks: one by one it is quadratic
        self.last_change = time.time()

    def reindex(self) -> None:
        """Number the points from 0, and address them to the vehicle."""
        self._number()
        self.last_change = time.time()

    def _number(self) -> None:
        self._grown = False
        for index, point in enumerate(self._points):
            self._address(point, index)

    def _address(self, point: Any, index: int) -> None:
        point.target_system, point.target_component = self.target_system, self.target_component
        point.idx = index
        point.count = len(self._points)

    def add_latlon(self, lat: float, lon: float) -> None:
        """Append a point in degrees."""
        target = self.target_system, self.target_component
        self.add(mavutil.mavlink.MAVLink_fence_point_message(*target, 0, 0, lat, lon))

    def clear(self) -> None:
        """Remove all points."""
        self.points = []
        self.last_change = time.time()

    def load(self, filename: str) -> int:
        """Read a file with a latitude and a longitude a line; how many points there are."""
        points = list(files.fence_points(files.read_lines(filename)))
        self.clear()
        target = self.target_system, self.target_component
        message = mavutil.mavlink.MAVLink_fence_point_message
        self.points = [message(*target, 0, 0, lat, lng) for lat, lng in points]
        self.reindex()
        return len(self.points)

    def save(self, filename: str) -> None:
        """Write a latitude and a longitude a line."""
        replace_text(filename, "".join(f"{p.lat:f}\t{p.lng:f}\n" for p in self.points))

    def _exists(self, i: int) -> bool:
        if 0 <= i < len(self.points):
            return True
        print(f"Invalid fence point number {i}")
        return False

    def move(self, i: int, lat: float, lng: float, change_time: bool = True) -> None:
        """Move point `i`; the first and the last of the polygon are one, and move together."""
        if not self._exists(i):
            return
        moved = {i, *((1, len(self.points) - 1) if i in (1, len(self.points) - 1) else ())}
        for index in moved:
            self.points[index].lat, self.points[index].lng = lat, lng
        if change_time:
            self.last_change = time.time()

    def remove(self, i: int, change_time: bool = True) -> None:
        """Remove point `i`; without the first of the polygon the next one closes it.

        The others keep their numbers until `reindex`.
        """
        if not self._exists(i):
            return
        del self.points[i]
        if i == 1 and len(self.points) > 1:
            first, last = self.points[1], self.points[-1]
            last.lat, last.lng = first.lat, first.lng
        if change_time:
            self.last_change = time.time()

    def polygon(self) -> list[tuple[float, float]]:
        """Latitude and longitude of all but the return point."""
        return [(point.lat, point.lng) for point in self.points[1:]]
