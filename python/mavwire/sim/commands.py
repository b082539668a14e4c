"""The command protocol: COMMAND_LONG and COMMAND_INT come in, one COMMAND_ACK goes out for each."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink

from .autopilot import RefusedError
from .geo import Local, Place, within_world
from .plans import LOCAL_NED, scale_of
from .service import Address, Handler, Service, sender

if TYPE_CHECKING:
    from .vehicle import Vehicle

ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
DENIED = mavlink.MAV_RESULT_DENIED
UNSUPPORTED = mavlink.MAV_RESULT_UNSUPPORTED


@dataclass(frozen=True)
class Command:
    """A command of either message; `x` and `y` in degrees or metres, `frame` None if not given."""

    number: int
    params: tuple[float, float, float, float]
    x: float
    y: float
    z: float
    frame: int | None
    origin: Address

    @classmethod
    def received(cls, msg: Any) -> Command:
        """From a COMMAND_LONG or a COMMAND_INT."""
        params = (msg.param1, msg.param2, msg.param3, msg.param4)
        if msg.get_type() == "COMMAND_LONG":
            place = (msg.param5, msg.param6, msg.param7)
            return cls(msg.command, params, *place, None, sender(msg))
        scale = scale_of(msg.frame)
        place = (msg.x / scale, msg.y / scale, msg.z)
        return cls(msg.command, params, *place, msg.frame, sender(msg))

    def param(self, number: int, default: float = 0.0) -> float:
        """Parameter 1 to 7; `default` where it is not a number."""
        value = (*self.params, self.x, self.y, self.z)[number - 1]
        return value if math.isfinite(value) else default

    def integer(self, number: int) -> int:
        """The same as an integer."""
        return int(self.param(number))


Action = Callable[["Vehicle", Command], int | None]


class Commands(Service):
    """Runs commands that the personality knows and answers all."""

    def __init__(self, vehicle: Vehicle, actions: Mapping[int, Action]) -> None:
        super().__init__(vehicle)
        self._actions = {
            number: actions[number] for number in vehicle.personality.commands if number in actions
        }

    def handlers(self) -> Mapping[str, Handler]:
        return {
            "COMMAND_LONG": self._on_command,
            "COMMAND_INT": self._on_command,
            "SET_MODE": self._on_set_mode,
        }

    def _on_command(self, msg: Any) -> None:
        command = Command.received(msg)
        self._ack(command.number, self.run(command), command.origin)

    def run(self, command: Command) -> int:
        """Do a command; MAV_RESULT. A refusal is also put into words."""
        action = self._actions.get(command.number)
        if action is None:
            return UNSUPPORTED
        return self._attempt(lambda: action(self.vehicle, command))

    def _attempt(self, action: Callable[[], int | None]) -> int:
        try:
            result = action()
        except RefusedError as error:
            self.vehicle.text(mavlink.MAV_SEVERITY_CRITICAL, str(error))
            return self.vehicle.personality.refusal
        return ACCEPTED if result is None else result

    def _ack(self, number: int, result: int, to: Address) -> None:
        self.vehicle.send(mavlink.MAVLink_command_ack_message(number, result, 0, 0, *to))

    def _on_set_mode(self, msg: Any) -> None:
        """The older message; PX4 answers as to the command, ArduPilot with the message's id."""
        personality = self.vehicle.personality
        mode = personality.mode_by_custom(msg.custom_mode)
        result = DENIED
        if mode is not None and msg.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            result = self._attempt(lambda: self.vehicle.autopilot.set_mode(mode))
        self._ack(personality.set_mode_ack, result, sender(msg))


def destination(vehicle: Vehicle, command: Command) -> Local:
    """Where a command leads; what it does not say is as it is now."""
    pilot, here = vehicle.autopilot, vehicle.copter.place
    if command.frame == LOCAL_NED:
        return within_world(Local(command.x, command.y, -command.z))
    lat, lon = command.x, command.y
    unsaid = not (math.isfinite(lat) and math.isfinite(lon)) or (lat == 0 and lon == 0)
    # COMMAND_INT has no NaN. An integer outside the globe means the same.
    if unsaid or abs(lat) > 90 or abs(lon) > 180:
        lat, lon = here.lat, here.lon
    alt = vehicle.personality.command_altitude(pilot, command.z, command.frame)
    return vehicle.copter.origin.local(Place(lat, lon, alt))
