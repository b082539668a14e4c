#!/usr/bin/env python3
"""Receive what matters: by type, by condition, with a time limit, or just the newest of each."""

from __future__ import annotations

import math
import sys

from mavwire import mavutil

device = sys.argv[1] if len(sys.argv) > 1 else "udpin:127.0.0.1:14550"

link = mavutil.mavlink_connection(device)
link.wait_heartbeat()

# One type. `blocking` waits for it; the messages in between are read and remembered.
msg = link.recv_match(type="ATTITUDE", blocking=True)
print(f"heading {math.degrees(msg.yaw) % 360:.0f}")

# Several types, and not for ever: None when the time is over.
msg = link.recv_match(type=["GPS_RAW_INT", "GPS2_RAW"], blocking=True, timeout=10)
print("no GPS" if msg is None else f"{msg.satellites_visible} satellites")

# A condition is an expression over the newest messages of the sender.
msg = link.recv_match("GPS_RAW_INT.fix_type>=3", "GPS_RAW_INT", blocking=True)
print(f"position {msg.lat / 1e7:.6f}, {msg.lon / 1e7:.6f}")

# Everything that was read is still there: the newest of each type, and its age in seconds.
altitude = link.messages["VFR_HUD"].alt
print(f"altitude {altitude:.1f} m, known for {link.time_since('VFR_HUD'):.1f} s")
print(f"system status: {link.field('SYS_STATUS', 'battery_remaining', -1)}% battery")
link.close()
