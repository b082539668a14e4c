"""A vehicle that flies by itself: something to look at without a ground station."""

from __future__ import annotations

from mavwire.dialects.v20 import all as mavlink

from .geo import Local, e7
from .plans import Item
from .vehicle import Vehicle

HEIGHT = 20.0
SIDE = 60.0
ROUNDS = 30


def circuit(vehicle: Vehicle) -> list[Item]:
    """A mission: up, round a square, home and down."""
    origin = vehicle.copter.origin
    items = [Item(mavlink.MAV_CMD_NAV_TAKEOFF, z=HEIGHT)]
    for north, east in ((SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE), (0.0, 0.0)):
        place = origin.globe(Local(north, east, 0.0))
        items.append(Item(mavlink.MAV_CMD_NAV_WAYPOINT, x=e7(place.lat), y=e7(place.lon), z=HEIGHT))
    first = vehicle.personality.first_mission_item
    if first:
        items.insert(0, Item(mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_FRAME_GLOBAL))
    items.append(Item(mavlink.MAV_CMD_DO_JUMP, param1=first + 1, param2=ROUNDS))
    items.append(Item(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH))
    return items


def start_circuit(vehicle: Vehicle) -> None:
    """Give it the mission, and start as soon as it knows where it is."""
    vehicle.mission.store(circuit(vehicle))
    vehicle.when_ready = _start


def _start(vehicle: Vehicle) -> None:
    vehicle.mission_changed()
    vehicle.autopilot.arm(force=True)
    vehicle.autopilot.start_mission()
