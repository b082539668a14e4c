"""A ground station for a drone of one's own making: arms it, watches it, changes its mode, disarms
it, and prints what it saw as JSON.

python drone_station.py PACKAGE DEVICE
"""

from __future__ import annotations

import importlib
import json
import os
import sys

os.environ["MAVLINK20"] = "1"
WAIT = 30.0
LAND = 0x6040000


def main(package: str, device: str) -> None:
    mavutil = importlib.import_module(f"{package}.mavutil")
    link = mavutil.mavlink_connection(device)
    beat = link.wait_heartbeat(timeout=WAIT)
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    link.arducopter_arm()
    ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=WAIT)
    link.motors_armed_wait()
    attitude = link.recv_match(type="ATTITUDE", blocking=True, timeout=WAIT)
    link.mav.set_mode_send(link.target_system, 129, LAND)
    link.recv_match(f"HEARTBEAT.custom_mode=={LAND}", "HEARTBEAT", blocking=True, timeout=WAIT)
    mode = link.flightmode
    link.arducopter_disarm()
    link.motors_disarmed_wait()
    print(
        json.dumps(
            {
                "vehicle": [beat.type, beat.autopilot], "ack": [ack.command, ack.result],
                "rolls": abs(attitude.roll) <= 0.11, "mode": mode,
                "bad": link.mav.total_receive_errors, "loss": link.packet_loss(),
            }
        )
    )  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
