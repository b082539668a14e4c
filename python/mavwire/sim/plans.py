"""Missions, fences and rally points as a vehicle stores them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mavwire.dialects.v20 import all as mavlink

from .geo import Place

MAX_ITEMS = 1000
# Frames in which x and y are degrees, by what the altitude is measured from.
ABSOLUTE = frozenset((mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT))
RELATIVE = frozenset((
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
    mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT,
    mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT,
))  # fmt: skip
GLOBAL = ABSOLUTE | RELATIVE
MISSION_FRAMES = GLOBAL | {mavlink.MAV_FRAME_MISSION}
LOCAL_NED = mavlink.MAV_FRAME_LOCAL_NED
E7 = 1e7
E4 = 1e4


@dataclass(frozen=True)
class Item:
    """One item: `x` and `y` as MISSION_ITEM_INT carries them, degrees times 1e7 in a global frame."""

    command: int
    frame: int = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
    x: int = 0
    y: int = 0
    z: float = 0.0
    autocontinue: int = 1

    @classmethod
    def received(cls, msg: Any) -> Item:
        """From a MISSION_ITEM or a MISSION_ITEM_INT."""
        x, y = msg.x, msg.y
        if msg.get_type() == "MISSION_ITEM":
            x, y = (_integer(value * scale_of(msg.frame)) for value in (x, y))
        params = (msg.param1, msg.param2, msg.param3, msg.param4)
        return cls(msg.command, msg.frame, *params, x, y, msg.z, msg.autocontinue)

    def place(self, home: Place, here: Place) -> Place:
        """Where it is; 0, 0 means here."""
        lat, lon = self.x / E7, self.y / E7
        if self.x == 0 and self.y == 0:
            lat, lon = here.lat, here.lon
        return Place(lat, lon, self.z + (home.alt if self.frame in RELATIVE else 0.0))


def scale_of(frame: int) -> float:
    """The factor of `x` and `y` on the wire."""
    return E7 if frame in GLOBAL else E4 if frame == LOCAL_NED else 1.0


def _integer(value: float) -> int:
    """A float as an int32 of the wire; what does not fit (NaN among it) becomes 0."""
    return round(value) if abs(value) < 2**31 else 0


class Plan:
    """The items of one mission type."""

    def __init__(self, mission_type: int) -> None:
        self.mission_type = mission_type
        self.items: list[Item] = []
        self.current = 0
        self.complete = False

    def __len__(self) -> int:
        return len(self.items)

    def store(self, items: Sequence[Item], start: int | None = None) -> None:
        """Replace all items, or those from `start` on; a new mission begins at its beginning."""
        if start is None:
            self.items = list(items)
            self.current = 0
        else:
            self.items[start : start + len(items)] = items
        self.complete = False

    @staticmethod
    def home_item(home: Place) -> Item:
        """Home as an ArduPilot shows it: item 0 of its mission."""
        x, y = _integer(home.lat * E7), _integer(home.lon * E7)
        frame = mavlink.MAV_FRAME_GLOBAL
        return Item(mavlink.MAV_CMD_NAV_WAYPOINT, frame, x=x, y=y, z=home.alt)

    def set_home(self, home: Place) -> None:
        """Put home into item 0."""
        if self.items:
            self.items[0] = self.home_item(home)
