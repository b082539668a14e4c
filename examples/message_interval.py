#!/usr/bin/env python3
"""Ask a vehicle for messages: a type at a rate, a single message, and the rate that it has."""

from __future__ import annotations

import sys
from typing import Any

from mavwire import mavutil
from mavwire.dialects.v20 import common as mavlink

device = sys.argv[1] if len(sys.argv) > 1 else "udpin:127.0.0.1:14550"


def command(link: Any, number: int, *params: float) -> str:
    """COMMAND_LONG to the vehicle; the name of the result."""
    padded = [*params, *[0.0] * (7 - len(params))]
    for confirmation in range(5):  # either way may get lost: ask again
        link.mav.command_long_send(
            link.target_system, link.target_component, number, confirmation, *padded
        )
        ack = link.recv_match(
            f"COMMAND_ACK.command=={number}", "COMMAND_ACK", blocking=True, timeout=2
        )
        if ack is not None:
            return mavlink.enums["MAV_RESULT"][ack.result].name
    return "no answer"


def answer(link: Any, kind: str, number: int, *params: float) -> Any:
    """The message that a command asks for; None if it never comes. It may come before the COMMAND_ACK."""
    for _ in range(5):
        before = link.messages.get(kind)
        command(link, number, *params)
        newest = link.messages.get(kind)
        msg = (
            newest if newest is not before else link.recv_match(type=kind, blocking=True, timeout=2)
        )
        if msg is not None:
            return msg
    return None


with mavutil.mavlink_connection(device) as link:
    link.wait_heartbeat()

    # ATTITUDE twenty times a second: the interval is in microseconds.
    attitude = mavlink.MAVLINK_MSG_ID_ATTITUDE
    print("set:", command(link, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, attitude, 1e6 / 20))

    # Measured by the vehicle's own clock.
    times = [link.recv_match(type="ATTITUDE", blocking=True).time_boot_ms for _ in range(41)]
    print(f"measured: {40e3 / (times[-1] - times[0]):.0f} a second")

    # The vehicle reports its interval; the answer is a message of its own.
    msg = answer(link, "MESSAGE_INTERVAL", mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, attitude)
    print("interval:", None if msg is None else f"{msg.interval_us} us")

    # One message, once.
    version = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    msg = answer(link, "AUTOPILOT_VERSION", mavlink.MAV_CMD_REQUEST_MESSAGE, version)
    print("capabilities:", None if msg is None else hex(msg.capabilities))
