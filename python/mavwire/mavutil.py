"""Connections to MAVLink systems and logs, with the names and behaviour of pymavlink's mavutil.

The work is in `mavwire.links`; this module is the face of it. `mavlink`, `current_dialect`,
`mavfile_global` and `global_link_id` are the process-wide state in `links.state`, shown here as
attributes that can be read and assigned. Names that few programs use load on first access.
"""

from __future__ import annotations

import os
import sys
from types import ModuleType

from ._hooks import IN_STANDARD_MODULE, ReplaceableModule, make_replaceable
from ._native import replace_function
from .links import state
from .links.conditions import evaluate_condition, evaluate_expression
from .links.helpers import (
    FakeSerial,
    all_printable,
    is_printable,
    location,
    periodic_event,
    u_ord,
)
from .links.mavfile import mavfile
from .links.modes import (
    AP_MAV_TYPE_MODE_MAP,
    AP_MAV_TYPE_MODE_MAP_DEFAULT,
    PX4_CUSTOM_MAIN_MODE_ACRO,
    PX4_CUSTOM_MAIN_MODE_ALTCTL,
    PX4_CUSTOM_MAIN_MODE_AUTO,
    PX4_CUSTOM_MAIN_MODE_MANUAL,
    PX4_CUSTOM_MAIN_MODE_OFFBOARD,
    PX4_CUSTOM_MAIN_MODE_POSCTL,
    PX4_CUSTOM_MAIN_MODE_RATTITUDE,
    PX4_CUSTOM_MAIN_MODE_STABILIZED,
    PX4_CUSTOM_SUB_MODE_AUTO_FOLLOW_TARGET,
    PX4_CUSTOM_SUB_MODE_AUTO_LAND,
    PX4_CUSTOM_SUB_MODE_AUTO_LOITER,
    PX4_CUSTOM_SUB_MODE_AUTO_MISSION,
    PX4_CUSTOM_SUB_MODE_AUTO_READY,
    PX4_CUSTOM_SUB_MODE_AUTO_RTGS,
    PX4_CUSTOM_SUB_MODE_AUTO_RTL,
    PX4_CUSTOM_SUB_MODE_AUTO_TAKEOFF,
    PX4_CUSTOM_SUB_MODE_OFFBOARD,
    auto_mode_flags,
    interpret_px4_mode,
    mainstate_mapping_px4,
    mode_mapping_acm,
    mode_mapping_apm,
    mode_mapping_blimp,
    mode_mapping_byname,
    mode_mapping_bynumber,
    mode_mapping_rover,
    mode_mapping_sub,
    mode_mapping_tracker,
    mode_string_acm,
    mode_string_apm,
    mode_string_px4,
    mode_string_v10,
    px4_map,
)
from .links.state import mavlink20, set_wire_protocol
from .links.vehicle_state import add_message, mavfile_state, param_state
from .links.waiting import set_close_on_exec

# The names that `import *` brings. The state names are properties, and the lazy names load here.
__all__ = [
    "AP_MAV_TYPE_MODE_MAP", "AP_MAV_TYPE_MODE_MAP_DEFAULT", "PX4_CUSTOM_MAIN_MODE_ACRO",
    "PX4_CUSTOM_MAIN_MODE_ALTCTL", "PX4_CUSTOM_MAIN_MODE_AUTO", "PX4_CUSTOM_MAIN_MODE_MANUAL",
    "PX4_CUSTOM_MAIN_MODE_OFFBOARD", "PX4_CUSTOM_MAIN_MODE_POSCTL",
    "PX4_CUSTOM_MAIN_MODE_RATTITUDE", "PX4_CUSTOM_MAIN_MODE_STABILIZED",
    "PX4_CUSTOM_SUB_MODE_AUTO_FOLLOW_TARGET", "PX4_CUSTOM_SUB_MODE_AUTO_LAND",
    "PX4_CUSTOM_SUB_MODE_AUTO_LOITER", "PX4_CUSTOM_SUB_MODE_AUTO_MISSION",
    "PX4_CUSTOM_SUB_MODE_AUTO_READY", "PX4_CUSTOM_SUB_MODE_AUTO_RTGS",
    "PX4_CUSTOM_SUB_MODE_AUTO_RTL", "PX4_CUSTOM_SUB_MODE_AUTO_TAKEOFF",
    "PX4_CUSTOM_SUB_MODE_OFFBOARD", "UDP_MAX_PACKET_LEN", "FakeSerial", "MavlinkSerialPort",
    "SerialPort", "TimestampStore", "add_message", "all_printable", "allow_radio_status", "auto_detect_serial",
    "auto_detect_serial_unix", "auto_detect_serial_win32", "auto_mode_flags", "current_dialect",
    "decode_bitmask", "default_native", "dump_message_unit_decoder", "dump_message_verbose",
    "evaluate_condition", "evaluate_expression", "global_link_id", "have_ascii",
    "interpret_px4_mode", "is_printable", "location", "mainstate_mapping_px4", "mavchildexec",
    "mavexpression", "mavfile", "mavfile_global", "mavfile_state", "mavlink", "mavlink10",
    "mavlink20", "mavlink_connection", "mavlogfile", "mavmcast", "mavmmaplog", "mavserial",
    "mavtcp", "mavtcpin", "mavudp", "mavuds", "mavwebsocket", "mavwebsocket_client",
    "mode_mapping_acm", "mode_mapping_apm", "mode_mapping_blimp", "mode_mapping_byname",
    "mode_mapping_bynumber", "mode_mapping_rover", "mode_mapping_sub", "mode_mapping_tracker",
    "mode_string_acm", "mode_string_apm", "mode_string_px4", "mode_string_v10", "os", "param_state",
    "periodic_event", "px4_map", "set_close_on_exec", "set_dialect", "set_wire_protocol",
    "sys", "u_ord", "x25crc",
]  # fmt: skip

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, ClassVar, Literal

    from . import mavexpression
    from ._stubs.mavutil import Connection
    from .generator.mavcrc import x25crc
    from .links.child import mavchildexec
    from .links.inspect_message import (
        decode_bitmask,
        dump_message_unit_decoder,
        dump_message_verbose,
    )
    from .links.mcast import mavmcast
    from .links.mmaplog import mavmmaplog
    from .links.serial_control import MavlinkSerialPort
    from .links.serial_detect import (
        SerialPort,
        auto_detect_serial,
        auto_detect_serial_unix,
        auto_detect_serial_win32,
    )
    from .links.serial_port import mavserial
    from .links.signing import allow_radio_status
    from .links.tcp import mavtcp
    from .links.tcpin import mavtcpin
    from .links.timestamp_store import TimestampStore
    from .links.tlog import mavlogfile
    from .links.udp import mavudp
    from .links.uds import mavuds
    from .links.websocket import mavwebsocket, mavwebsocket_client

    mavlink: ModuleType
    current_dialect: str
    mavfile_global: mavfile | None
    global_link_id: int
    have_ascii: bool

UDP_MAX_PACKET_LEN = 65535
# There is one parser, and it is native.
default_native = False

# Public names that load on first access: where they are defined.
_LAZY = {
    name: module
    for module, names in {
        "mavwire.links.child": "mavchildexec",
        "mavwire.links.tlog": "mavlogfile",
        "mavwire.links.mcast": "mavmcast",
        "mavwire.links.mmaplog": "mavmmaplog",
        "mavwire.links.serial_port": "mavserial",
        "mavwire.links.tcp": "mavtcp",
        "mavwire.links.tcpin": "mavtcpin",
        "mavwire.links.udp": "mavudp",
        "mavwire.links.uds": "mavuds",
        "mavwire.links.websocket": "mavwebsocket mavwebsocket_client",
        "mavwire.links.serial_control": "MavlinkSerialPort",
        "mavwire.links.serial_detect": "SerialPort auto_detect_serial auto_detect_serial_unix "
        "auto_detect_serial_win32",
        "mavwire.links.inspect_message": "decode_bitmask dump_message_unit_decoder "
        "dump_message_verbose",
        "mavwire.links.signing": "allow_radio_status",
        "mavwire.links.timestamp_store": "TimestampStore",
        "mavwire.generator.mavcrc": "x25crc",
        "os.path": "expanduser",
        "typing": "Any",
    }.items()
    for name in names.split()
}
_STANDARD = "array copy errno fnmatch json math platform re select socket ssl struct".split()
# Modules that pymavlink's mavutil shows as attributes, which programs have come to use.
_LAZY_MODULES = {
    "all": "mavwire.dialects.v10.all",
    "ascii": "curses.ascii",
    "mavexpression": "mavwire.mavexpression",
    "time": "time",
    **{name: name for name in _STANDARD},
}
# Loops at the end of pymavlink's module leave these two names behind.
name = "MAV_TYPE_VTOL_TAILSITTER_QUADROTOR"
some_map = mode_mapping_apm


def _of_state(name: str) -> property:
    """An attribute of `state`. It can be deleted, as `mock.patch` does before it puts back what it replaced."""
    return property(
        lambda self: getattr(state, name),
        lambda self, value: setattr(state, name, value),
        lambda self: state.delete_mavlink() if name == "mavlink" else delattr(state, name),
    )


def _replace_natively(name: str) -> Callable[[Any, bool], None]:
    return lambda value, is_original: replace_function(name, None if is_original else value)


class _Mavutil(ReplaceableModule):
    """This module's type: the process-wide state of the links as assignable attributes."""

    _users = ("mavwire.links", "mavwire._dataflash")
    _callbacks: ClassVar[dict[str, Callable[[Any, bool], None]]] = {
        name: _replace_natively(name) for name in ("time", "add_message")
    }
    _not_called: ClassVar[dict[str, str]] = {
        **dict.fromkeys((*_STANDARD, "ascii", "os", "sys"), IN_STANDARD_MODULE),
        "u_ord": "bytes are numbers already",
    }

    mavlink = _of_state("mavlink")
    current_dialect = _of_state("current_dialect")
    mavfile_global = _of_state("mavfile_global")
    global_link_id = _of_state("global_link_id")


_STATE = ("mavlink", "current_dialect", "mavfile_global", "global_link_id")


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        value = getattr(state.import_module(_LAZY[name]), name)
    elif name in _LAZY_MODULES:
        value = state.import_module(_LAZY_MODULES[name])
    elif name == "have_ascii":
        value = _have_ascii()
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_LAZY, *_LAZY_MODULES, *_STATE, "have_ascii"})


def _have_ascii() -> bool:
    """Whether curses is there; pymavlink's printable tests depend on it, ours do not."""
    try:
        import curses.ascii  # noqa: F401
    except ImportError:
        return False
    return True


def mavlink10() -> bool:
    """Always True: MAVLink 1 is always spoken."""
    return True


def set_dialect(
    dialect: str | os.PathLike[str] | ModuleType, with_type_annotations: bool | None = None
) -> None:
    """Make `dialect` current: a built-in name, a name found in $MDEF, a path to XML, or a module.

    FileNotFoundError says what there is in place of an unknown dialect; TypeError for anything
    else than a name, a path or a module.
    """
    if with_type_annotations is not None:
        print("with_type_annotations ignored; remove parameter")
    state.set_dialect(dialect)


def mavlink_connection(
    device: str | os.PathLike[str] | bytes,
    baud: int = 115200,
    source_system: int = 255,
    source_component: int = 0,
    planner_format: bool | None = None,
    write: bool = False,
    append: bool = False,
    robust_parsing: bool = True,
    notimestamps: bool = False,
    input: bool = True,
    dialect: str | os.PathLike[str] | ModuleType | None = None,
    autoreconnect: bool = False,
    zero_time_base: bool = False,
    retries: int = 3,
    reconnect_delay: float = 1,
    use_native: bool = default_native,
    force_connected: bool = False,
    progress_callback: Callable[[int], Any] | None = None,
    udp_timeout: float = 0,
    resync: Literal["skip", "rescan"] | None = None,
    **opts: Any,
) -> Connection:
    """Open a link or a log.

    `device` is tcp:, tcpin:, udpin:, udpout:, udpbcast: or udp: with HOST:PORT; uds:PATH;
    mcast:[[GROUP:]PORT]; ws:, wss: or wsserver: with HOST:PORT; exec:PROGRAM; csv:FILE; the
    path of a log; or a serial port with optional `,BAUD`. `dialect` is set process-wide first.
    `resync="rescan"` finds every good frame behind a damaged one; the default skips the whole
    of it, as pymavlink does. `retries` is how often a TCP or Unix domain link tries to connect at first,
    once at least, and `reconnect_delay` the seconds between attempts. Unknown keyword arguments go to the CSV reader.
    """
    arguments = locals() | {"autoreconnect": autoreconnect or force_connected}
    from .links.connection import Options, connect

    if resync not in (None, "skip", "rescan"):
        raise ValueError(f"resync must be 'skip' or 'rescan', not {resync!r}")
    module = None
    with state.choosing:
        if dialect is not None:
            set_dialect(dialect)
            module = state.mavlink
    options = Options(**arguments)
    before = state.asked_for.set(module)
    try:
        link: Connection = connect(device, options)
    finally:
        state.asked_for.reset(before)
    if resync is not None and hasattr(link, "mav"):
        link.mav.resync = resync
    return link


state.public = sys.modules[__name__]
make_replaceable(state.public, _Mavutil)
state.choose_dialect(os.environ.get("MAVLINK_DIALECT", state.DEFAULT_DIALECT))
