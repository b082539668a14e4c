"""The differences between autopilots, as data and a few decisions.

Two families dominate and disagree about nearly everything a ground station notices: how modes are
numbered, how integers travel in parameters, which commands exist, what refuses to arm and what is
said about it. A personality holds all of that; the rest of the simulation asks it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, ClassVar

from mavwire.dialects.v20 import all as mavlink

from ..geo import Place
from ..steering import Tuning

if TYPE_CHECKING:
    from ..autopilot import Autopilot
    from ..vehicle import Vehicle


class Role(Enum):
    """The job of a mode, which autopilots give different names."""

    MANUAL = auto()
    HOLD = auto()
    GUIDED = auto()
    OFFBOARD = auto()
    MISSION = auto()
    RETURN = auto()
    LAND = auto()
    TAKEOFF = auto()
    CIRCLE = auto()


@dataclass(frozen=True)
class Mode:
    """A flight mode. `flags` are those of base_mode; `position` means that it needs one."""

    name: str
    custom_mode: int
    role: Role
    flags: int
    position: bool = True
    armable: bool = True
    standard: int = mavlink.MAV_STANDARD_MODE_NON_STANDARD
    selectable: bool = True


@dataclass(frozen=True)
class Param:
    """A parameter as it is delivered: MAV_PARAM_TYPE and default."""

    name: str
    type: int
    default: float


# Severity and text of what a vehicle says; {} are filled in.
Phrases = Mapping[str, tuple[int, str]]

INT8 = mavlink.MAV_PARAM_TYPE_INT8
INT16 = mavlink.MAV_PARAM_TYPE_INT16
INT32 = mavlink.MAV_PARAM_TYPE_INT32
REAL32 = mavlink.MAV_PARAM_TYPE_REAL32


def table(kind: int, text: str) -> list[Param]:
    """Parameters of one type from "NAME=value ..."."""
    pairs = (entry.split("=") for entry in text.split())
    return [Param(name, kind, float(value)) for name, value in pairs]


class Personality:
    """One family of autopilots. Constants are set by the subclasses."""

    name: ClassVar[str]
    autopilot: ClassVar[int]
    home: ClassVar[Place]
    initial_mode: ClassVar[str]
    modes: ClassVar[dict[str, Mode]]
    roles: ClassVar[dict[Role, str]]
    phrases: ClassVar[Phrases]
    sends_events: ClassVar = False
    params: ClassVar[list[Param]]
    bytewise_params: ClassVar[bool]
    sysid_param: ClassVar[str]
    capabilities: ClassVar[int]
    version: ClassVar[tuple[int, int, int]]
    version_text: ClassVar[str]
    commands: ClassVar[frozenset[int]]
    mission_commands: ClassVar[frozenset[int]]
    streams: ClassVar[dict[str, float]]
    # Message group of REQUEST_DATA_STREAM -> messages; empty where it is not understood.
    stream_groups: ClassVar[dict[int, tuple[str, ...]]] = {}
    stream_params: ClassVar[dict[int, str]] = {}
    # 1 where home is item 0 of every mission.
    first_mission_item: ClassVar[int]
    # Whether a single mission item means "go there now".
    guided_items: ClassVar[bool]
    # Whether a mission must be armed to be started.
    mission_needs_arming: ClassVar[bool]
    # Whether a position target lifts it off the ground.
    targets_lift: ClassVar[bool]
    # Whether MAV_CMD_DO_REPOSITION changes the mode without being asked to.
    reposition_changes_mode: ClassVar[bool]
    # COMMAND_ACK for SET_MODE carries this number: that of a command, or the message's id.
    set_mode_ack: ClassVar[int]
    # Whether FTP offers all parameters in one file.
    packed_params: ClassVar[bool]
    mission_request_int: ClassVar[bool]
    waypoint_yaw: ClassVar[bool]
    # Whether FTP sessions have the number that the client chose.
    ftp_client_sessions: ClassVar[bool]
    # COMMAND_ACK result for what it will not do now, and for an interval of an unknown message.
    refusal: ClassVar[int]
    unknown_interval: ClassVar[int]

    # -- modes

    def mode_of(self, role: Role) -> Mode:
        """The mode that does `role`."""
        return self.modes[self.roles[role]]

    def mode_by_custom(self, custom_mode: int) -> Mode | None:
        """The selectable mode with that number."""
        found = (mode for mode in self.modes.values() if mode.custom_mode == custom_mode)
        return next((mode for mode in found if mode.selectable), None)

    def requested_mode(self, base_mode: int, custom: int, sub: int) -> Mode | None:
        """The mode that MAV_CMD_DO_SET_MODE means with its three parameters."""
        raise NotImplementedError

    def system_status(self, autopilot: Autopilot) -> int:
        """MAV_STATE of the heartbeat."""
        raise NotImplementedError

    # -- rules of flight

    def after(self, role: Role, landed: bool) -> Role | None:
        """The role after the task of a mode is done."""
        return None

    def after_disarming(self, role: Role) -> Role | None:
        """The role after the motors stop."""
        return None

    def prepare_takeoff(self, autopilot: Autopilot) -> None:
        """Get ready to take off on command; raises RefusedError."""

    def mission_refusal(self, autopilot: Autopilot) -> str | None:
        """Why the mission cannot be flown now."""
        return None

    def mission_waits(self, autopilot: Autopilot) -> bool:
        """Whether a mission on the ground waits for a start command."""
        return False

    def arming_failures(self, autopilot: Autopilot) -> list[str]:
        """Failed checks, in the autopilot's words."""
        raise NotImplementedError

    def command_altitude(self, autopilot: Autopilot, altitude: float, frame: int | None) -> float:
        """Metres above sea level of the altitude of a command; `frame` is None for COMMAND_LONG."""
        raise NotImplementedError

    # -- parameters and files

    def tuning(self, params: Mapping[str, float], tuning: Tuning) -> None:
        """Set `tuning` as the parameters say."""
        raise NotImplementedError

    def files(self, vehicle: Vehicle) -> Mapping[str, bytes]:
        """Files that FTP shows at first, by path."""
        raise NotImplementedError

    def banner(self, vehicle: Vehicle) -> Iterable[str]:
        """The texts that introduce it to a ground station."""
        raise NotImplementedError
