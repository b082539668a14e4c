"""The target of a link: which system the helpers address, and what is known of it.

The state of every system a link hears is kept apart in `sysid_state`, keyed by system id; the
properties here show the one that is the target.
"""

from __future__ import annotations

import math
import time

from mavwire._native import forget_states

from .conditions import evaluate_condition
from .modes import MAV_AUTOPILOT_PX4, mode_mapping_byname, px4_map
from .vehicle_state import mavfile_state, param_state

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from mavwire._stubs.mavutil import CurrentMAVLink, ReceivedMessage


def _of_target(name: str, doc: str) -> Any:
    """A property that is an attribute of the target's state."""
    return property(
        lambda self: getattr(self.sysid_state[self.sysid], name),
        lambda self, value: setattr(self.sysid_state[self.sysid], name, value),
        doc=doc,
    )


class Target:
    """The properties and look-ups of `mavfile` that concern its target."""

    mav: CurrentMAVLink
    param_sysid: tuple[int, int]
    sysid_state: dict[int, mavfile_state]
    param_state: dict[tuple[int, int], param_state]
    start_time: float
    mav_count: int
    mav_loss: int
    timestamp: float
    _timestamp: float | None

    @property
    def sysid(self) -> int:
        """The target's system id, 0 until the first vehicle heartbeat."""
        return self._sysid

    @sysid.setter
    def sysid(self, value: int) -> None:
        self._sysid = value
        # With a new target, or none, a heartbeat tells more than the equal one before it.
        forget_states()

    @property
    def target_system(self) -> int:
        """The system that the sending helpers address; locked by the first vehicle heartbeat."""
        return self.sysid

    @target_system.setter
    def target_system(self, value: int) -> None:
        self.sysid = value
        if value not in self.sysid_state:
            self.sysid_state[value] = mavfile_state()
        self._select_params(value, self.param_sysid[1])

    @property
    def target_component(self) -> int:
        """The component that the sending helpers address; 0 is all of them."""
        return self.param_sysid[1]

    @target_component.setter
    def target_component(self, value: int) -> None:
        # The heartbeat that locked the target left param_sysid alone; follow it here.
        self._select_params(self.sysid or self.param_sysid[0], value)

    def _select_params(self, sysid: int, component: int) -> None:
        key = (sysid, component)
        if key not in self.param_state:  # before a thread that reads parameters looks for it
            self.param_state[key] = param_state()
        self.param_sysid = key

    @property
    def params(self) -> dict[str, float]:
        """The target's parameters; those of component 1 while the component is 0."""
        sysid, component = self.param_sysid
        target = self.sysid  # once: another thread may receive the first heartbeat
        if component == 0 and (target, 1) in self.param_state:
            return self.param_state[(target, 1)].params
        if sysid == 0 and (target, component) in self.param_state:
            sysid = target
        return self.param_state[(sysid, component)].params

    @property
    def messages(self) -> dict[str, Any]:
        """Message type -> newest message of the target system."""
        return self.sysid_state[self.sysid].messages

    def messages_of(self, sysid: int, compid: int | None = None) -> dict[str, Any]:
        """Message type -> newest message of a system, or of one of its components alone.

        Empty while it has not been heard.
        """
        system = self.sysid_state.get(sysid)
        if system is None:
            return {}
        return system.messages if compid is None else system.of_component(compid)

    def latest(
        self,
        type: str,
        sysid: int | None = None,
        compid: int | None = None,
        max_age: float | None = None,
    ) -> ReceivedMessage | None:
        """The newest message of `type` from a system (the target) or one of its components.

        None for a type that has not been received, or whose newest message is older than `max_age` seconds.
        Messages that other threads receive count too.
        """
        system = self.sysid_state.get(self.sysid if sysid is None else sysid)
        if system is None:
            return None
        newest: dict[str, ReceivedMessage] = (
            system.messages
            if compid is None
            else system.of_component(compid, type.partition("[")[0])
        )
        msg = newest.get(type)
        if msg is None or (max_age is not None and self._age(msg) > max_age):
            return None
        return msg

    def age(self, type: str, sysid: int | None = None, compid: int | None = None) -> float:
        """Seconds since the newest message of `type`; infinite while there is none.

        In a log, seconds before the record that was read last.
        """
        msg = self.latest(type, sysid, compid)
        return math.inf if msg is None else self._age(msg)

    def _age(self, msg: Any) -> float:
        now = time.time() if self._timestamp is None else self.timestamp
        # A clock that was set back must not make messages younger than new.
        return max(now - float(msg._timestamp), 0.0)

    flightmode: str = _of_target("flightmode", "The target's flight mode by name.")
    vehicle_type: str = _of_target("vehicle_type", "A free text that programs keep per system.")
    mav_type: int = _of_target("mav_type", "The target's MAV_TYPE; at first fixed wing.")
    base_mode: int = _of_target("base_mode", "The base mode that `set_mode_flag` starts from.")

    def param(self, name: str, default: Any = None) -> Any:
        """The target's parameter `name`, or `default` while it is unknown."""
        return self.params.get(name, default)

    def field(self, type: str, field: str, default: Any = None) -> Any:
        """A field of the newest message of `type`, or `default`."""
        return getattr(self.messages.get(type), field, default)

    def time_since(self, mtype: str) -> float:
        """Seconds since the newest message of `mtype`, or since the link was opened."""
        msg = self.messages.get(mtype)
        return time.time() - (self.start_time if msg is None else msg._timestamp)

    def packet_loss(self) -> float:
        """Percent of the packets that sequence numbers say are missing."""
        if self.mav_count == 0:
            return 0
        return (100.0 * self.mav_loss) / (self.mav_count + self.mav_loss)

    def mode_mapping(self) -> dict[str, Any] | None:
        """Mode name -> what `set_mode` sends for it, for the target's autopilot and type."""
        target = self.sysid_state[self.sysid]
        if target.mav_autopilot == MAV_AUTOPILOT_PX4:
            return px4_map
        return mode_mapping_byname(target.mav_type)

    def check_condition(self, condition: str | None) -> Any:
        """Whether `condition` holds over the target's messages."""
        return evaluate_condition(condition, self.messages)
