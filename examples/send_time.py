#!/usr/bin/env python3
"""Send: the time once, and then a heartbeat every second, as a companion computer does.

A system that sends no heartbeats is taken for lost: vehicles stop streaming to it, or come home.
"""

from __future__ import annotations

import sys
import time

from mavwire import mavutil
from mavwire.dialects.v20 import common as mavlink

device = sys.argv[1] if len(sys.argv) > 1 else "udpin:127.0.0.1:14550"
began = time.monotonic()

link = mavutil.mavlink_connection(
    device, source_system=1, source_component=mavlink.MAV_COMP_ID_ONBOARD_COMPUTER
)
link.wait_heartbeat()  # a listening UDP link knows where to send to after the first message

boot_ms = int((time.monotonic() - began) * 1e3)
link.mav.system_time_send(int(time.time() * 1e6), boot_ms)

for _ in range(3):
    # With x_encode the message can be looked at, or sent on several links.
    beat = link.mav.heartbeat_encode(
        mavlink.MAV_TYPE_ONBOARD_CONTROLLER,
        mavlink.MAV_AUTOPILOT_INVALID,
        base_mode=0,
        custom_mode=0,
        system_status=mavlink.MAV_STATE_ACTIVE,
    )
    link.mav.send(beat)
    print("sent", beat)
    time.sleep(1)
link.close()
