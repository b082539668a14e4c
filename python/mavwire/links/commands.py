"""The sending helpers of a link: parameters, missions, modes, arming, and waiting for effects.

All address (target_system, target_component) and go through `self.mav`, so they are signed,
numbered and recorded like any other message. The command numbers are those of MAV_CMD.
"""

from __future__ import annotations

import time

from .helpers import location
from .modes import MAV_AUTOPILOT_PX4, px4_map
from .target import Target

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any

    from mavwire._stubs.mavutil import ReceivedMessage

MAV_CMD_NAV_LOITER_UNLIM = 17
MAV_CMD_NAV_RETURN_TO_LAUNCH = 20
MAV_CMD_DO_SET_MODE = 176
MAV_CMD_DO_SET_RELAY = 181
MAV_CMD_DO_SET_SERVO = 183
MAV_CMD_PREFLIGHT_CALIBRATION = 241
MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN = 246
MAV_CMD_MISSION_START = 300
MAV_CMD_COMPONENT_ARM_DISARM = 400

MAV_MODE_FLAG_CUSTOM_MODE_ENABLED = 1
MAV_MODE_MANUAL_ARMED = 192
MAV_MODE_STABILIZE_ARMED = 208
MAVLINK_TYPE_FLOAT = 9
GPS_FIX_TYPE_3D_FIX = 3
# The magic number that makes an autopilot reboot although it is flying.
FORCE_REBOOT = 20190226
# A second request within this time would only flood the link with the same list.
PARAM_FETCH_INTERVAL = 2.0


class Commands(Target):
    """The sending and waiting methods of `mavfile`."""

    param_fetch_start: float

    def _command_long(self, command: int, *params: float) -> None:
        """COMMAND_LONG to the target; parameters left out are 0."""
        padded = (*params, *[0] * (7 - len(params)))
        self.mav.command_long_send(self.target_system, self.target_component, command, 0, *padded)

    # -- parameters

    def param_fetch_all(self) -> None:
        """Request the parameter list, at most once in two seconds."""
        now = time.time()
        if 0 <= now - self.param_fetch_start < PARAM_FETCH_INTERVAL:
            return
        self.param_fetch_start = now
        self.mav.param_request_list_send(self.target_system, self.target_component)

    def param_fetch_one(self, name: str | bytes | int) -> None:
        """Request one parameter: by index if `name` reads as an integer, else by name."""
        try:
            param_id, index = b"", int(name)
        except ValueError:
            param_id = name if isinstance(name, bytes) else bytes(name, "ascii")  # type: ignore
            index = -1
        self.mav.param_request_read_send(self.target_system, self.target_component, param_id, index)

    def param_set_send(
        self, parm_name: str | bytes, parm_value: float, parm_type: int | None = None
    ) -> None:
        """PARAM_SET with `parm_type` of MAV_PARAM_TYPE, float if not given."""
        if isinstance(parm_name, str):
            parm_name = parm_name.encode("utf8")
        if parm_type is None:
            parm_type = MAVLINK_TYPE_FLOAT
        self.mav.param_set_send(
            self.target_system, self.target_component, parm_name, parm_value, parm_type
        )

    # -- missions

    def waypoint_request_list_send(self) -> None:
        """Ask for the number of mission items."""
        self.mav.mission_request_list_send(self.target_system, self.target_component)

    def waypoint_clear_all_send(self) -> None:
        """Delete the mission."""
        self.mav.mission_clear_all_send(self.target_system, self.target_component)

    def waypoint_request_send(self, seq: int) -> None:
        """Ask for mission item `seq`."""
        self.mav.mission_request_send(self.target_system, self.target_component, seq)

    def waypoint_set_current_send(self, seq: int) -> None:
        """Continue the mission at item `seq`."""
        self.mav.mission_set_current_send(self.target_system, self.target_component, seq)

    def waypoint_count_send(self, seq: int) -> None:
        """Announce a mission of `seq` items."""
        self.mav.mission_count_send(self.target_system, self.target_component, seq)

    def waypoint_current(self) -> int:
        """The number of the target's current mission item; waits for the next MISSION_CURRENT."""
        return int(self._next_of_target("MISSION_CURRENT").seq)

    # -- modes

    def set_mode_flag(self, flag: int, enable: bool) -> None:
        """Set or clear bits of the base mode."""
        mode = self.base_mode
        mode = mode | flag if enable else mode & ~flag
        self._command_long(MAV_CMD_DO_SET_MODE, mode)

    def set_mode_auto(self) -> None:
        """Start the mission."""
        self._command_long(MAV_CMD_MISSION_START)

    def set_mode_apm(self, mode: Any) -> None:
        """Set an ArduPilot mode by name or number; an unknown name is printed, nothing sent."""
        if isinstance(mode, str):
            mapping = self.mode_mapping()
            if mapping is None or mode not in mapping:
                print(f"Unknown mode '{mode}'")
                return
            mode = mapping[mode]
        self._command_long(MAV_CMD_DO_SET_MODE, MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, mode)

    def set_mode_px4(self, mode: Any, custom_mode: int, custom_sub_mode: int) -> None:
        """Set a PX4 mode by name, or by base mode, main and sub mode."""
        if isinstance(mode, str):
            mapping = self.mode_mapping()
            if mapping is None or mode not in mapping or mode not in px4_map:
                print(f"Unknown mode '{mode}'")
                return
            mode, custom_mode, custom_sub_mode = px4_map[mode]
        self._command_long(MAV_CMD_DO_SET_MODE, mode, custom_mode, custom_sub_mode)

    def set_mode(self, mode: str | int, custom_mode: int = 0, custom_sub_mode: int = 0) -> None:
        """Set a mode in the way of the target's autopilot, as its heartbeat names it."""
        # The newest HEARTBEAT may be a camera's; this is the autopilot's own.
        if self.sysid_state[self.sysid].mav_autopilot == MAV_AUTOPILOT_PX4:
            self.set_mode_px4(mode, custom_mode, custom_sub_mode)
        else:
            self.set_mode_apm(mode)

    def set_mode_rtl(self) -> None:
        """Return to launch."""
        self._command_long(MAV_CMD_NAV_RETURN_TO_LAUNCH)

    def set_mode_manual(self) -> None:
        """Manual control, armed."""
        self._command_long(MAV_CMD_DO_SET_MODE, MAV_MODE_MANUAL_ARMED)

    def set_mode_fbwa(self) -> None:
        """Stabilised control, armed."""
        self._command_long(MAV_CMD_DO_SET_MODE, MAV_MODE_STABILIZE_ARMED)

    def set_mode_loiter(self) -> None:
        """Loiter without limit."""
        self._command_long(MAV_CMD_NAV_LOITER_UNLIM)

    # -- actuators and calibration

    def set_servo(self, channel: int, pwm: int) -> None:
        """Drive servo `channel` with a pulse of `pwm` microseconds."""
        self._command_long(MAV_CMD_DO_SET_SERVO, channel, pwm)

    def set_relay(self, relay_pin: int = 0, state: bool = True) -> None:
        """Switch a relay."""
        self._command_long(MAV_CMD_DO_SET_RELAY, relay_pin, 1 if state else 0)

    def calibrate_level(self) -> None:
        """Calibrate gyroscopes and magnetometer with the vehicle level."""
        self._command_long(MAV_CMD_PREFLIGHT_CALIBRATION, 1, 1)

    def calibrate_pressure(self) -> None:
        """Calibrate the pressure sensors."""
        self._command_long(MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 1)

    def reboot_autopilot(self, hold_in_bootloader: bool = False, force: bool = False) -> None:
        """Reboot, into the boot loader if asked; `force` does so even in flight."""
        stay = 3 if hold_in_bootloader else 1
        magic = FORCE_REBOOT if force else 0
        self._command_long(MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, stay, 0, 0, 0, 0, magic)

    def arducopter_arm(self) -> None:
        """Arm the motors."""
        self._command_long(MAV_CMD_COMPONENT_ARM_DISARM, 1)

    def arducopter_disarm(self) -> None:
        """Disarm the motors."""
        self._command_long(MAV_CMD_COMPONENT_ARM_DISARM, 0)

    # -- waiting

    def wait_heartbeat(
        self, blocking: bool = True, timeout: float | None = None
    ) -> ReceivedMessage | None:
        """The next HEARTBEAT of anyone, ground stations included; None after `timeout`."""
        return self.recv_match(type="HEARTBEAT", blocking=blocking, timeout=timeout)

    def _next_of_target(self, type: str) -> ReceivedMessage:
        """The next message of a type from the target, or from anyone while there is none."""
        while True:
            msg = self.recv_match(type=type, blocking=True)
            if msg is not None and self.target_system in (0, msg.get_srcSystem()):
                return msg

    def wait_gps_fix(self) -> None:
        """Wait for the target's position: a VFR_HUD, then a GPS_RAW_INT with a 3D fix."""
        self._next_of_target("VFR_HUD")
        while True:
            gps = self._next_of_target("GPS_RAW_INT")
            if gps.fix_type >= GPS_FIX_TYPE_3D_FIX and gps.lat != 0:
                return

    def location(self, relative_alt: bool = False) -> location:
        """Where the target is, from fresh messages; altitude above home if `relative_alt`."""
        self.wait_gps_fix()
        self._next_of_target("VFR_HUD")
        self._next_of_target("GLOBAL_POSITION_INT")
        gps, hud = self.messages["GPS_RAW_INT"], self.messages["VFR_HUD"]
        alt = hud.alt
        if relative_alt:
            alt = self.messages["GLOBAL_POSITION_INT"].relative_alt * 0.001
        return location(gps.lat * 1.0e-7, gps.lon * 1.0e-7, alt, hud.heading)

    def motors_armed(self) -> int:
        """The target's armed bit: true while its motors are armed."""
        return self.sysid_state[self.sysid].armed

    def motors_armed_wait(self) -> None:
        """Wait until a heartbeat says that the motors are armed: the next one, or a later one."""
        self.wait_heartbeat()
        while not self.motors_armed():
            self.wait_heartbeat()

    def motors_disarmed_wait(self) -> None:
        """Wait until a heartbeat says that the motors are disarmed: the next one, or a later one."""
        self.wait_heartbeat()
        while self.motors_armed():
            self.wait_heartbeat()

    if TYPE_CHECKING:

        def recv_match(
            self,
            condition: str | None = None,
            type: str | Iterable[str] | None = None,
            blocking: bool = False,
            timeout: float | None = None,
        ) -> ReceivedMessage | None: ...
