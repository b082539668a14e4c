#!/usr/bin/env python3
"""Typed use of a dialect: what a type checker knows about messages, constants and links.

The stubs of the dialect modules say which fields a message has and of which types, what its
constructor and `<message>_send` take, and what the constants are. `mypy --strict examples/typed.py`
is part of the tests.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Iterator

from mavwire.dialects.v20 import ardupilotmega as mavlink


def heading(msg: mavlink.MAVLink_attitude_message) -> float:
    """Degrees clockwise from north."""
    return math.degrees(msg.yaw) % 360.0


def texts(messages: Iterable[mavlink.MAVLink_message]) -> Iterator[str]:
    """One line for each message that has something to say."""
    for msg in messages:
        if isinstance(msg, mavlink.MAVLink_statustext_message):
            yield f"{mavlink.enums['MAV_SEVERITY'][msg.severity].name}: {msg.text}"
        elif isinstance(msg, mavlink.MAVLink_battery_status_message):
            cells = [volts for volts in msg.voltages if volts != 0xFFFF]
            yield f"battery {msg.id}: {sum(cells) / 1000:.1f} V"
        elif isinstance(msg, mavlink.MAVLink_attitude_message):
            yield f"heading {heading(msg):.0f}"
        elif isinstance(msg, mavlink.MAVLink_bad_data):
            yield f"{len(msg.data)} bad bytes: {msg.reason}"


def main() -> None:
    """Sends to a file in memory and reads it back."""
    file = io.BytesIO()
    out = mavlink.MAVLink(file, srcSystem=1, srcComponent=mavlink.MAV_COMP_ID_AUTOPILOT1)
    out.statustext_send(mavlink.MAV_SEVERITY_INFO, b"ready")
    out.attitude_send(1000, 0.0, 0.1, math.pi / 2, 0.0, 0.0, 0.0)
    cells = [4100, 4090, 4110, *[0xFFFF] * 7]
    out.send(out.battery_status_encode(0, 0, 0, 2500, cells, 150, 20, -1, 98))
    file.write(b"?")
    link = mavlink.MAVLink(None)
    link.robust_parsing = True
    for line in texts(link.parse_buffer(file.getvalue()) or []):
        print(line)


if __name__ == "__main__":
    main()
