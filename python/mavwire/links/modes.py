"""Flight modes: the numbers that autopilots send, the names that people use.

ArduPilot numbers its modes per vehicle kind; PX4 packs a main and a sub mode into `custom_mode`.
A user's `~/.pymavlink/custom_mode_map.json` replaces the table of the vehicle types it names.
"""

from __future__ import annotations

import os

from . import Any, warn

mode_mapping_apm = {
    0: "MANUAL", 1: "CIRCLE", 2: "STABILIZE", 3: "TRAINING", 4: "ACRO", 5: "FBWA", 6: "FBWB",
    7: "CRUISE", 8: "AUTOTUNE", 10: "AUTO", 11: "RTL", 12: "LOITER", 13: "TAKEOFF",
    14: "AVOID_ADSB", 15: "GUIDED", 16: "INITIALISING", 17: "QSTABILIZE", 18: "QHOVER",
    19: "QLOITER", 20: "QLAND", 21: "QRTL", 22: "QAUTOTUNE", 23: "QACRO", 24: "THERMAL",
    25: "LOITERALTQLAND", 26: "AUTOLAND",
}  # fmt: skip

mode_mapping_acm = {
    0: "STABILIZE", 1: "ACRO", 2: "ALT_HOLD", 3: "AUTO", 4: "GUIDED", 5: "LOITER", 6: "RTL",
    7: "CIRCLE", 8: "POSITION", 9: "LAND", 10: "OF_LOITER", 11: "DRIFT", 13: "SPORT", 14: "FLIP",
    15: "AUTOTUNE", 16: "POSHOLD", 17: "BRAKE", 18: "THROW", 19: "AVOID_ADSB",
    20: "GUIDED_NOGPS", 21: "SMART_RTL", 22: "FLOWHOLD", 23: "FOLLOW", 24: "ZIGZAG",
    25: "SYSTEMID", 26: "AUTOROTATE", 27: "AUTO_RTL", 28: "TURTLE", 29: "RATE_ACRO",
}  # fmt: skip

mode_mapping_rover = {
    0: "MANUAL", 1: "ACRO", 2: "LEARNING", 3: "STEERING", 4: "HOLD", 5: "LOITER", 6: "FOLLOW",
    7: "SIMPLE", 8: "DOCK", 9: "CIRCLE", 10: "AUTO", 11: "RTL", 12: "SMART_RTL", 15: "GUIDED",
    16: "INITIALISING",
}  # fmt: skip

mode_mapping_tracker = {
    0: "MANUAL", 1: "STOP", 2: "SCAN", 4: "GUIDED", 10: "AUTO", 16: "INITIALISING",
}  # fmt: skip

mode_mapping_sub = {
    0: "STABILIZE", 1: "ACRO", 2: "ALT_HOLD", 3: "AUTO", 4: "GUIDED", 7: "CIRCLE", 9: "SURFACE",
    16: "POSHOLD", 19: "MANUAL",
}  # fmt: skip

mode_mapping_blimp = {
    0: "LAND", 1: "MANUAL", 2: "VELOCITY", 3: "LOITER", 4: "RTL", 5: "AUTO", 6: "HOLD",
}  # fmt: skip

# MAV_TYPE -> vehicle of ArduPilot. The numbers are those of the MAV_TYPE enum.
VEHICLES = {
    **dict.fromkeys((2, 3, 4, 13, 14, 15, 29, 35), "Copter"),  # rotary wings
    **dict.fromkeys((1, 19, 20, 21), "Plane"),  # fixed wing, tailsitters, tiltrotor
    **dict.fromkeys((10, 11), "Rover"),  # ground rover, surface boat
    5: "Tracker",
    7: "Blimp",
    12: "Sub",
}
_MODES = {
    "Copter": mode_mapping_acm, "Plane": mode_mapping_apm, "Rover": mode_mapping_rover,
    "Tracker": mode_mapping_tracker, "Blimp": mode_mapping_blimp, "Sub": mode_mapping_sub,
}  # fmt: skip
# MAV_TYPE -> mode table.
AP_MAV_TYPE_MODE_MAP_DEFAULT = {number: _MODES[name] for number, name in VEHICLES.items()}

mainstate_mapping_px4 = {
    0: "MANUAL", 1: "ALTCTL", 2: "POSCTL", 3: "AUTO_MISSION", 4: "AUTO_LOITER", 5: "AUTO_RTL",
    6: "ACRO", 7: "OFFBOARD", 8: "STAB", 9: "RATTITUDE", 10: "AUTO_TAKEOFF", 11: "AUTO_LAND",
    12: "AUTO_FOLLOW_TARGET", 13: "MAX",
}  # fmt: skip

PX4_CUSTOM_MAIN_MODE_MANUAL = 1
PX4_CUSTOM_MAIN_MODE_ALTCTL = 2
PX4_CUSTOM_MAIN_MODE_POSCTL = 3
PX4_CUSTOM_MAIN_MODE_AUTO = 4
PX4_CUSTOM_MAIN_MODE_ACRO = 5
PX4_CUSTOM_MAIN_MODE_OFFBOARD = 6
PX4_CUSTOM_MAIN_MODE_STABILIZED = 7
PX4_CUSTOM_MAIN_MODE_RATTITUDE = 8

PX4_CUSTOM_SUB_MODE_OFFBOARD = 0
PX4_CUSTOM_SUB_MODE_AUTO_READY = 1
PX4_CUSTOM_SUB_MODE_AUTO_TAKEOFF = 2
PX4_CUSTOM_SUB_MODE_AUTO_LOITER = 3
PX4_CUSTOM_SUB_MODE_AUTO_MISSION = 4
PX4_CUSTOM_SUB_MODE_AUTO_RTL = 5
PX4_CUSTOM_SUB_MODE_AUTO_LAND = 6
PX4_CUSTOM_SUB_MODE_AUTO_RTGS = 7
PX4_CUSTOM_SUB_MODE_AUTO_FOLLOW_TARGET = 8

# MAV_MODE_FLAG: stabilize 16, guided 8, auto 4, custom mode 1, manual input 64.
auto_mode_flags = 16 | 8 | 4
_CUSTOM_MODE_ENABLED = 1
_MANUAL = 64 | 16 | _CUSTOM_MODE_ENABLED
_ACRO = 64 | _CUSTOM_MODE_ENABLED
_AUTO = auto_mode_flags | _CUSTOM_MODE_ENABLED

# Mode name -> (base_mode, main mode, sub mode), as DO_SET_MODE takes them.
px4_map = {
    "MANUAL": (_MANUAL, PX4_CUSTOM_MAIN_MODE_MANUAL, 0),
    "STABILIZED": (_MANUAL, PX4_CUSTOM_MAIN_MODE_STABILIZED, 0),
    "ACRO": (_ACRO, PX4_CUSTOM_MAIN_MODE_ACRO, 0),
    "RATTITUDE": (_ACRO, PX4_CUSTOM_MAIN_MODE_RATTITUDE, 0),
    "ALTCTL": (_MANUAL, PX4_CUSTOM_MAIN_MODE_ALTCTL, 0),
    "POSCTL": (_MANUAL, PX4_CUSTOM_MAIN_MODE_POSCTL, 0),
    "LOITER": (_AUTO, PX4_CUSTOM_MAIN_MODE_AUTO, PX4_CUSTOM_SUB_MODE_AUTO_LOITER),
    "MISSION": (_AUTO, PX4_CUSTOM_MAIN_MODE_AUTO, PX4_CUSTOM_SUB_MODE_AUTO_MISSION),
    "RTL": (_AUTO, PX4_CUSTOM_MAIN_MODE_AUTO, PX4_CUSTOM_SUB_MODE_AUTO_RTL),
    "LAND": (_AUTO, PX4_CUSTOM_MAIN_MODE_AUTO, PX4_CUSTOM_SUB_MODE_AUTO_LAND),
    "RTGS": (_AUTO, PX4_CUSTOM_MAIN_MODE_AUTO, PX4_CUSTOM_SUB_MODE_AUTO_RTGS),
    "FOLLOWME": (_AUTO, PX4_CUSTOM_MAIN_MODE_AUTO, PX4_CUSTOM_SUB_MODE_AUTO_FOLLOW_TARGET),
    "OFFBOARD": (_AUTO, PX4_CUSTOM_MAIN_MODE_OFFBOARD, 0),
    "TAKEOFF": (_AUTO, PX4_CUSTOM_MAIN_MODE_AUTO, PX4_CUSTOM_SUB_MODE_AUTO_TAKEOFF),
}

_PX4_MAIN_NAMES = {
    1: "MANUAL", 2: "ALTCTL", 3: "POSCTL", 5: "ACRO", 6: "OFFBOARD", 7: "STABILIZED",
    8: "RATTITUDE",
}  # fmt: skip
_PX4_AUTO_NAMES = {
    2: "TAKEOFF", 3: "LOITER", 4: "MISSION", 5: "RTL", 6: "LAND", 7: "RTGS", 8: "FOLLOWME",
}  # fmt: skip

MAV_AUTOPILOT_PX4 = 12
_MSG_ID_HIGH_LATENCY2 = 235


def dot_pymavlink(*args: str) -> str:
    """A path in the user's settings directory."""
    home = os.environ.get("LOCALAPPDATA") if os.name == "nt" else None
    return os.path.join(home or os.path.expanduser("~"), ".pymavlink", *args)


def _read_custom_modes(path: str) -> dict[int, dict[int, str]] | None:
    """The user's mode tables, or None where there are none; a broken file is reported once."""
    if not os.path.exists(path):
        return None
    import json

    try:
        with open(path, encoding="utf-8") as source:
            tables = json.load(source)
        return {
            int(mav_type): {int(number): str(name) for number, name in modes.items()}
            for mav_type, modes in tables.items()
        }
    except (OSError, ValueError, AttributeError, RecursionError) as error:
        warn("ignoring %s: %s", path, error)
        return None


def _mode_map() -> dict[int, dict[int, str]]:
    custom = _read_custom_modes(_custom_mode_map_path)
    if custom is None:
        return AP_MAV_TYPE_MODE_MAP_DEFAULT
    return {**AP_MAV_TYPE_MODE_MAP_DEFAULT, **custom}


_custom_mode_map_path = dot_pymavlink("custom_mode_map.json")
AP_MAV_TYPE_MODE_MAP = _mode_map()


def mode_mapping_byname(mav_type: int) -> dict[str, int] | None:
    """Mode name -> number for an ArduPilot vehicle of `mav_type`; None for unmapped types."""
    modes = AP_MAV_TYPE_MODE_MAP.get(mav_type)
    return None if modes is None else {name: number for number, name in modes.items()}


def mode_mapping_bynumber(mav_type: int) -> dict[int, str] | None:
    """Mode number -> name for an ArduPilot vehicle of `mav_type`; None for unmapped types."""
    return AP_MAV_TYPE_MODE_MAP.get(mav_type)


def interpret_px4_mode(base_mode: int, custom_mode: int) -> str:
    """The name of a PX4 mode: main mode in bits 16-23 of `custom_mode`, sub mode in 24-31."""
    main = (custom_mode >> 16) & 0xFF
    if main == PX4_CUSTOM_MAIN_MODE_AUTO:
        return _PX4_AUTO_NAMES.get((custom_mode >> 24) & 0xFF, "UNKNOWN")
    return _PX4_MAIN_NAMES.get(main, "UNKNOWN")


def mode_string_v10(msg: Any) -> str:
    """The mode that a HEARTBEAT or HIGH_LATENCY2 reports."""
    heartbeat = msg.get_msgId() != _MSG_ID_HIGH_LATENCY2
    if msg.autopilot == MAV_AUTOPILOT_PX4:
        if heartbeat:
            return interpret_px4_mode(msg.base_mode, msg.custom_mode)
        return f"Mode({msg.custom_mode})"
    if heartbeat and not msg.base_mode & _CUSTOM_MODE_ENABLED:
        return f"Mode(0x{msg.base_mode:08x})"
    return _name_or_number(mode_mapping_bynumber(msg.type) or {}, msg.custom_mode)


def mode_string_apm(mode_number: int) -> str:
    """The name of a plane's mode."""
    return _name_or_number(mode_mapping_apm, mode_number)


def mode_string_acm(mode_number: int) -> str:
    """The name of a copter's mode."""
    return _name_or_number(mode_mapping_acm, mode_number)


def mode_string_px4(MainState: int) -> str:
    """The name of a PX4 main state, as its dataflash logs number them."""
    return mainstate_mapping_px4.get(MainState, "Unknown")


def _name_or_number(modes: dict[int, str], number: int) -> str:
    name = modes.get(number)
    return "Mode(%u)" % number if name is None else name  # noqa: UP031 - TypeError for no number
