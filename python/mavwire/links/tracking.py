"""Flight modes, home and the radio's own messages.

The native `Link.post_message` keeps the rest. It calls the methods here for the few messages that need them.
"""

from __future__ import annotations

from . import Any, Callable
from .modes import mode_string_v10
from .target import Target
from .vehicle_state import mavfile_state, param_state

MAV_AUTOPILOT_ARDUPILOTMEGA = 3
MAV_AUTOPILOT_INVALID = 8
MAV_COMP_ID_GIMBAL = 154
MAV_MODE_FLAG_SAFETY_ARMED = 128
# GCS, onboard controller, gimbal, ADSB: they send heartbeats but are not the vehicle.
NOT_VEHICLES = frozenset((6, 18, 26, 27))
GPS_FIX_TYPE_3D_FIX = 3


class Tracking(Target):
    """The state-keeping methods of `mavfile`."""

    _fix_home: Callable[[int], None]

    def _new_state(self) -> mavfile_state:
        """The state of a system that is heard for the first time."""
        return mavfile_state()

    def _new_param_state(self) -> param_state:
        """The parameters of a component that tells one for the first time."""
        return param_state()

    def _post_radio(self, mtype: str, msg: Any) -> None:
        """Show a message of the radio itself to every system's state."""
        for system in self.sysid_state.values():
            system.messages[mtype] = msg

    def _update(self, mtype: str, msg: Any, sender: mavfile_state) -> None:
        """Changes that only a few types of messages bring."""
        _UPDATES[mtype](self, msg, sender)

    def probably_vehicle_heartbeat(self, msg: Any) -> bool:
        """Whether a HEARTBEAT comes from an autopilot rather than a gimbal, GCS or the like."""
        return (
            msg.get_srcComponent() != MAV_COMP_ID_GIMBAL
            and msg.type not in NOT_VEHICLES
            and msg.autopilot != MAV_AUTOPILOT_INVALID
        )

    def _on_heartbeat(self, msg: Any, sender: mavfile_state) -> None:
        if not self.probably_vehicle_heartbeat(msg):
            return
        if self.sysid == 0:
            self.sysid = msg.get_srcSystem()
        sender.flightmode = mode_string_v10(msg)
        sender.mav_type = msg.type
        sender.mav_autopilot = msg.autopilot
        sender.armed = msg.base_mode & MAV_MODE_FLAG_SAFETY_ARMED

    def _on_high_latency2(self, msg: Any, sender: mavfile_state) -> None:
        if self.sysid == 0:
            self.sysid = msg.get_srcSystem()
        sender.flightmode = mode_string_v10(msg)
        sender.mav_type = msg.type
        sender.mav_autopilot = msg.autopilot
        if msg.autopilot == MAV_AUTOPILOT_ARDUPILOTMEGA:
            sender.base_mode = msg.custom0
            sender.armed = msg.custom0 & MAV_MODE_FLAG_SAFETY_ARMED

    def _on_gps_raw_int(self, msg: Any, sender: mavfile_state) -> None:
        home = sender.messages.get("HOME")
        if home is not None and home.fix_type < GPS_FIX_TYPE_3D_FIX:
            sender.messages["HOME"] = home = msg
        if home is None or home.fix_type >= GPS_FIX_TYPE_3D_FIX:
            self._fix_home(msg.get_srcSystem())

    def _adopt_link_id(self, msg: Any) -> None:
        """Follow the target's link id while ours is 0, as a ground station should."""
        signing = self.mav.signing
        if signing.link_id == 0 and msg.get_link_id() and self._is_of_target(msg):
            signing.link_id = msg.get_link_id()

    def _is_of_target(self, msg: Any) -> bool:
        """Whether the target sent `msg`; any of its components while none is chosen."""
        components = (0, msg.get_srcComponent())
        return msg.get_srcSystem() == self.target_system and self.target_component in components


# Message types that change more than the table of newest messages.
_UPDATES: dict[str, Callable[[Tracking, Any, mavfile_state], None]] = {
    "HEARTBEAT": Tracking._on_heartbeat,
    "HIGH_LATENCY2": Tracking._on_high_latency2,
    "GPS_RAW_INT": Tracking._on_gps_raw_int,
}
