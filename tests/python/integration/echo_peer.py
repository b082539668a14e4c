"""A MAVLink peer made of another package: heartbeats, and an ack for each command.

Run as a program: `echo_peer.py PACKAGE DEVICE SIGNED`, which ends with its standard input.
"""

from __future__ import annotations

import importlib
import os
import sys
import threading
import time

KEY = bytes(range(32))
INTERVAL = 0.05


def main(package: str, device: str, signed: str) -> None:
    mavutil = importlib.import_module(f"{package}.mavutil")
    link = mavutil.mavlink_connection(device, source_system=42, source_component=1)
    if signed == "1":
        link.setup_signing(KEY)
    threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
    print("ready", flush=True)
    due = 0.0
    while True:
        if time.monotonic() > due:
            due = time.monotonic() + INTERVAL
            link.mav.heartbeat_send(2, 3, 81, 4, 4)
        msg = link.recv_match(type="COMMAND_LONG", blocking=True, timeout=INTERVAL)
        if msg is not None:
            link.mav.command_ack_send(msg.command, int(msg.param1))


if __name__ == "__main__":
    main(*sys.argv[1:])
