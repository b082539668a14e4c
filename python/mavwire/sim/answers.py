"""Messages that are sent once when they are asked for, by command or by a message of their own."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink
from mavwire.dialects.v20 import upstream

from .personality.px4_events import GENERAL_PATH
from .service import Handler, Service, sender

if TYPE_CHECKING:
    from .vehicle import Vehicle

PROTOCOL_VERSION_ID = 300
COMPONENT_METADATA_ID = 397


class Answers(Service):
    """The messages that a vehicle sends on request."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self._special: dict[int, Callable[[int], None]] = {
            PROTOCOL_VERSION_ID: lambda _: self.send_protocol_version(),
            COMPONENT_METADATA_ID: self._send_metadata,
            mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES: self._send_modes,
            mavlink.MAVLINK_MSG_ID_MESSAGE_INTERVAL: self._send_interval,
        }

    def handlers(self) -> Mapping[str, Handler]:
        return {"LOG_REQUEST_LIST": self._on_log_list}

    def request(self, message_id: int, argument: int) -> bool:
        """Send a message, as MAV_CMD_REQUEST_MESSAGE asks for it; False when there is none."""
        special = self._special.get(message_id)
        if special is not None:
            special(argument)
            return True
        return self.vehicle.streams.send_by_id(message_id)

    def send_protocol_version(self) -> None:
        """PROTOCOL_VERSION: MAVLink 2, and 1 will do."""
        nothing = [0] * 8
        self.vehicle.send(
            upstream.MAVLink_protocol_version_message(200, 100, 200, nothing, nothing)
        )

    def _send_metadata(self, _: int) -> None:
        """COMPONENT_METADATA, with the checksum of the general file."""
        path = GENERAL_PATH
        data = self.vehicle.ftp.files.read(path, 0)
        if data is not None:
            milliseconds = round(self.vehicle.time * 1000) & 0xFFFFFFFF
            uri = f"mftp://{path}".encode()
            self.vehicle.send(
                upstream.MAVLink_component_metadata_message(milliseconds, zlib.crc32(data), uri)
            )

    def _send_interval(self, message_id: int) -> None:
        interval = self.vehicle.streams.interval(message_id)
        self.vehicle.send(mavlink.MAVLink_message_interval_message(message_id & 0xFFFF, interval))

    def _send_modes(self, index: int) -> None:
        """AVAILABLE_MODES number `index`, all for 0."""
        modes = list(self.vehicle.personality.modes.values())
        for number, mode in enumerate(modes, 1):
            if index in (0, number):
                hidden = 0 if mode.selectable else mavlink.MAV_MODE_PROPERTY_NOT_USER_SELECTABLE
                self.vehicle.send(
                    mavlink.MAVLink_available_modes_message(
                        len(modes), number, mode.standard, mode.custom_mode, hidden,
                        mode.name.encode(),
                    )
                )  # fmt: skip

    def _on_log_list(self, msg: Any) -> None:
        """It keeps no logs, and says so."""
        if sender(msg).system:
            self.vehicle.send(mavlink.MAVLink_log_entry_message(0, 0, 0, 0, 0))
