"""The state that a link keeps of each system it hears: newest messages, flight mode, parameters.

Senders choose the keys of these tables, so a link limits how many keys it keeps. Beyond the limit,
known keys are updated and new ones are left out.
"""

from __future__ import annotations

from mavwire import _native
from mavwire._native import Message, SystemState, forget_states

from . import Any, Callable, state

MAV_TYPE_FIXED_WING = 1
MAV_AUTOPILOT_GENERIC = 0

__all__ = ["SystemStates", "add_message", "mavfile_state", "param_state"]


def add_message(messages: dict[str, Any], mtype: str, msg: Message) -> None:
    """Make `msg` the newest of its type in `messages`, and of its instance if the type has them."""
    _native.add_message(messages, mtype, msg)


class mavfile_state(SystemState):
    """The state of one system id; `messages` maps a message type to the newest message."""

    def __init__(self) -> None:
        self.messages: dict[str, Any] = {"MAV": self}
        self.flightmode = "UNKNOWN"
        self.vehicle_type = "UNKNOWN"
        self.mav_type = MAV_TYPE_FIXED_WING
        self.mav_autopilot = MAV_AUTOPILOT_GENERIC
        self.base_mode = 0
        # False until heard, then the armed bit itself: 0 or 128.
        self.armed: int = False
        mavlink = state.mavlink
        if (gps := getattr(mavlink, "MAVLink_gps_raw_int_message", None)) is not None:
            # Without a call of its constructor: that would be compiled, and a tool would wait for it.
            self.messages["HOME"] = home = gps.__new__(gps)
            _native.build(home, *[0] * len(gps.fieldnames))
        _name_waypoint_class(mavlink)


def _forgetting(name: str) -> Callable[..., Any]:
    """A method of dict that makes links look their states up again."""
    change = getattr(dict, name)

    def method(self: Any, *args: Any, **kwargs: Any) -> Any:
        result = change(self, *args, **kwargs)
        forget_states()
        return result

    return method


class SystemStates(dict[int, mavfile_state]):
    """`sysid_state` of a link: system id -> state. Links keep the states they found at hand, and
    are told when that may no longer be right."""


for _name in ("__setitem__", "__delitem__", "__ior__", "pop", "popitem", "clear", "update"):
    setattr(SystemStates, _name, _forgetting(_name))


class param_state:
    """The parameters of one (system, component): `params` maps the name to the raw value."""

    def __init__(self) -> None:
        self.params: dict[str, float] = {}


def _name_waypoint_class(mavlink: Any) -> None:
    """Keep the pre-2010 name of MISSION_ITEM's class alive in the dialect module."""
    if "MAVLink_waypoint_message" not in vars(mavlink):
        mission_item = getattr(mavlink, "MAVLink_mission_item_message", None)
        if mission_item is not None:
            mavlink.MAVLink_waypoint_message = mission_item
