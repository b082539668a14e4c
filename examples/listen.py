#!/usr/bin/env python3
"""Listen for a vehicle on UDP, and say who is there.

mavwire sim                      # in one terminal
python examples/listen.py        # in another
"""

from __future__ import annotations

import sys

from mavwire import mavutil

device = sys.argv[1] if len(sys.argv) > 1 else "udpin:127.0.0.1:14550"

with mavutil.mavlink_connection(device) as link:
    # The first heartbeat says who is there. From then on `link.target_system` is that system.
    beat = link.wait_heartbeat()
    print(f"Heartbeat from system {beat.get_srcSystem()}, component {beat.get_srcComponent()}")
    print(f"It is in mode {link.flightmode}, motors {'armed' if link.motors_armed() else 'off'}")

    for _ in range(10):
        msg = link.recv_match(blocking=True)
        print(msg.get_type(), msg.to_dict())
