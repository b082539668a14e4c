"""Files of waypoints, fence points and rally points, line by line.

`QGC WPL 110` has twelve columns: seq, current, frame, command, four parameters, x, y, z and
autocontinue. `QGC WPL 100` has thirteen, with commands of its own and the longitude first. A line
that starts with # is a comment on the item that follows.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from math import isfinite
from typing import Any, NamedTuple, TypeVar

from . import MAVFenceError, MAVRallyError, MAVWPError, PlanError

WAYPOINT, LOITER, LAND, TAKEOFF, RTL = 16, 17, 21, 22, 20
# Action of a QGC WPL 100 file -> MAV_CMD.
_ACTIONS_V100 = {2: TAKEOFF, 3: RTL, 4: LAND, 24: TAKEOFF, 25: WAYPOINT, 26: LAND, 27: LOITER}
_FENCE_START = re.compile(r"[-+.0-9]+\s+[-+.0-9]+")
# Frames in which an item's x and y are degrees.
_GLOBAL_FRAMES = frozenset((0, 3, 5, 6, 10, 11))
_LOCAL_FRAMES = frozenset((1, 4, 7, 8, 9, 12, 20, 21))

# The range of degrees times 1e7 in a message.
_PLACES = range(-(2**31), 2**31)

T = TypeVar("T")


class Line(NamedTuple):
    """A line of a file, without the space around it, and where it is."""

    text: str
    where: str


class ItemLine(NamedTuple):
    """An item as its line says; the fields are those of MISSION_ITEM from `seq` on."""

    values: tuple[Any, ...]
    comment: str
    where: str


def read_lines(filename: str) -> list[Line]:
    """All lines of a file; what is no UTF-8 can only be in comments, and is replaced."""
    with open(filename, encoding="utf-8-sig", errors="replace") as file:
        return [Line(text.strip(), f"{filename}:{n}") for n, text in enumerate(file, start=1)]


def get_first_line_from_file(filename: str) -> str | None:
    """The first line that is no comment, without the space around it; None if it is empty."""
    for line in read_lines(filename):
        if not line.text.startswith("#"):
            return line.text or None
    return None


def _meant(lines: Sequence[Line]) -> Iterator[Line]:
    """Lines that are neither empty nor a comment."""
    return (line for line in lines if line.text and not line.text.startswith("#"))


def _numbers(line: Line, error: type[PlanError], read: Callable[[list[str]], T]) -> T:
    """The result of `read` for a line's words; a word that is no number is an `error`."""
    try:
        return read(line.text.split())
    except (ValueError, OverflowError) as wrong:
        raise error(str(wrong), line.where) from wrong


def _check_place(lat: float, lng: float) -> None:
    if not all(isfinite(one) and int(one * 1e7) in _PLACES for one in (lat, lng)):
        raise ValueError(f"no place: {lat} {lng}")


# -- QGC WPL


def _item_lines(lines: Sequence[Line], columns: int) -> Iterator[tuple[Line, str]]:
    """The lines of items, each with the comment before it, which keeps its end of line."""
    comment = ""
    for line in lines:
        if line.text.startswith("#"):
            comment = line.text[1:].lstrip() + "\n"
        elif line.text:
            count = len(line.text.split())
            if count != columns:
                raise MAVWPError(f"invalid waypoint line with {count} values", line.where)
            yield line, comment
            comment = ""


def _items(
    lines: Sequence[Line], columns: int, read: Callable[[list[str]], tuple[Any, ...]]
) -> Iterator[ItemLine]:
    for line, comment in _item_lines(lines, columns):
        yield ItemLine(_numbers(line, MAVWPError, read), comment, line.where)


def items_v110(lines: Sequence[Line]) -> Iterator[ItemLine]:
    """Items of a QGC WPL 110 file, without its header."""

    def read(words: list[str]) -> tuple[Any, ...]:
        seq, current, frame, command = map(int, words[:4])
        if command == 0 and seq == 0:  # home, as some programs write it
            command = WAYPOINT
        return seq, frame, command, current, int(words[11]), *map(float, words[4:11])

    return _items(lines, 12, read)


def items_v100(lines: Sequence[Line]) -> Iterator[ItemLine]:
    """Items of a QGC WPL 100 file, without its header."""

    def read(words: list[str]) -> tuple[Any, ...]:
        seq, frame, action = map(int, words[:3])
        command = _ACTIONS_V100.get(action)
        if command is None:
            raise ValueError(f"Unknown v100 waypoint action {action}")
        p3, p4, p1, p2 = map(float, words[3:7])
        current, autocontinue = int(words[7]), int(words[12])
        y, x, z = map(float, words[8:11])
        return seq, frame, command, current, autocontinue, p1, p2, p3, p4, x, y, z

    return _items(lines, 13, read)


def comment_lines(comment: str) -> str:
    """The comment of an item as lines of a file; the end of line that it came with stays."""
    if not comment:
        return ""
    text = comment.rstrip("\n")
    return "# " + text.replace("\n", "\n# ") + comment[len(text) :] + "\n"


def item_line(item: Any) -> str:
    """An item as a line of a QGC WPL 110 file.

    A MISSION_ITEM_INT is written in degrees or metres too, with the digits that it has.
    """
    place = f"{item.x:f}\t{item.y:f}"
    if item.get_type() == "MISSION_ITEM_INT":
        if item.frame in _GLOBAL_FRAMES:
            place = f"{item.x / 1e7:.7f}\t{item.y / 1e7:.7f}"
        elif item.frame in _LOCAL_FRAMES:
            place = f"{item.x / 1e4:f}\t{item.y / 1e4:f}"
    head = f"{item.seq}\t{item.current}\t{item.frame}\t{item.command}"
    parameters = f"{item.param1:f}\t{item.param2:f}\t{item.param3:f}\t{item.param4:f}"
    return f"{head}\t{parameters}\t{place}\t{item.z:f}\t{item.autocontinue}\n"


# -- fences and rally points


def is_fence_file(lines: Sequence[Line]) -> bool:
    """Whether the first line that says something is a latitude and a longitude."""
    first = next(_meant(lines), Line("", "")).text
    return _FENCE_START.match(first) is not None or all(map(_is_number, [*first.split(), ""][:2]))


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def is_rally_file(lines: Sequence[Line]) -> bool:
    """Whether the first line that says something is a rally point."""
    return next(_meant(lines), Line("", "")).text.split()[:1] == ["RALLY"]


def fence_points(lines: Sequence[Line]) -> Iterator[tuple[float, float]]:
    """Latitude and longitude of each line, in degrees."""

    def read(words: list[str]) -> tuple[float, float]:
        lat, lng = float(words[0]), float(words[1])
        _check_place(lat, lng)
        return lat, lng

    for line in _meant(lines):
        if len(line.text.split()) != 2:
            raise MAVFenceError(f"invalid fence point line: {line.text}", line.where)
        yield _numbers(line, MAVFenceError, read)


class RallyLine(NamedTuple):
    """A rally point: degrees times 1e7, metres, hundredths of a degree."""

    lat: int
    lng: int
    alt: float
    break_alt: float
    land_dir: int
    flags: int


def rally_points(lines: Sequence[Line], for_messages: bool = False) -> Iterator[RallyLine]:
    """Rally points of a file; other lines of seven words are passed over, as pymavlink does.

    RALLY_POINT messages have whole metres, and flags, in which a fraction is a mistake.
    """

    def read(words: list[str]) -> RallyLine:
        lat, lng, alt, break_alt, land_dir = map(float, words[1:6])
        flags = int(words[6]) if for_messages else int(float(words[6]))
        _check_place(lat, lng)
        if not isfinite(alt):
            raise ValueError(f"no altitude: {alt}")
        if for_messages:
            alt, break_alt = int(alt), int(break_alt)
        place = int(lat * 1e7), int(lng * 1e7)
        return RallyLine(*place, alt, break_alt, int(land_dir * 100), flags)

    for line in _meant(lines):
        words = line.text.split()
        if len(words) != 7:
            raise MAVRallyError(f"invalid rally file line: {line.text}", line.where)
        if words[0].upper() == "RALLY":
            yield _numbers(line, MAVRallyError, read)
