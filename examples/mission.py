#!/usr/bin/env python3
"""A mission: upload a take-off, a square and a return, read it back, compare."""

from __future__ import annotations

import sys
from typing import Any

from mavwire import mavutil
from mavwire.dialects.v20 import common as mavlink

device = sys.argv[1] if len(sys.argv) > 1 else "udpin:127.0.0.1:14550"
HEIGHT = 20.0
SIDE = 4e-4  # degrees
TRIES = 10
WAIT = 2.0  # seconds after which what was sent may be lost


def item(seq: int, command: int, lat: float, lon: float, height: float) -> Any:
    """A mission item; degrees travel as integers, times ten million."""
    return mavlink.MAVLink_mission_item_int_message(
        target_system=1, target_component=1, seq=seq, current=0, autocontinue=1,
        frame=mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, command=command,
        param1=0, param2=0, param3=0, param4=0,
        x=round(lat * 1e7), y=round(lon * 1e7), z=height,
    )  # fmt: skip


def square(lat: float, lon: float) -> list[Any]:
    """Up, around, and home. ArduPilot keeps home as item 0."""
    corners = [(SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE), (0.0, 0.0)]
    items = [item(0, mavlink.MAV_CMD_NAV_WAYPOINT, lat, lon, 0)]
    items.append(item(1, mavlink.MAV_CMD_NAV_TAKEOFF, lat, lon, HEIGHT))
    for north, east in corners:
        items.append(
            item(len(items), mavlink.MAV_CMD_NAV_WAYPOINT, lat + north, lon + east, HEIGHT)
        )
    return [*items, item(len(items), mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, 0, 0, 0)]


def upload(link: Any, items: list[Any]) -> str:
    """Announce the number, again if that gets lost, and hand out what the vehicle asks for; the name of
    the result.
    """
    asked = ["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"]
    for _ in range(TRIES):
        link.waypoint_count_send(len(items))
        while (msg := link.recv_match(type=asked, blocking=True, timeout=WAIT)) is not None:
            if msg.get_type() == "MISSION_ACK":
                return mavlink.enums["MAV_MISSION_RESULT"][msg.type].name
            link.mav.send(items[msg.seq])
    return "no answer"


def item_count(link: Any) -> int:
    """Ask for the number of items, again if that gets lost."""
    for _ in range(TRIES):
        link.waypoint_request_list_send()
        msg = link.recv_match(type="MISSION_COUNT", blocking=True, timeout=WAIT)
        if msg is not None:
            return int(msg.count)
    raise SystemExit("the vehicle does not say how many items it has")


def download(link: Any) -> list[Any]:
    """Ask for the number, and for one item after the other."""
    items = [download_item(link, seq) for seq in range(item_count(link))]
    link.mav.mission_ack_send(
        link.target_system, link.target_component, mavlink.MAV_MISSION_ACCEPTED
    )
    return items


def download_item(link: Any, seq: int) -> Any:
    """Ask for an item, again if that gets lost."""
    for _ in range(TRIES):
        link.mav.mission_request_int_send(link.target_system, link.target_component, seq)
        condition = f"MISSION_ITEM_INT.seq=={seq}"
        msg = link.recv_match(condition, "MISSION_ITEM_INT", blocking=True, timeout=WAIT)
        if msg is not None:
            return msg
    raise SystemExit(f"the vehicle does not send item {seq}")


with mavutil.mavlink_connection(device) as link:
    link.wait_heartbeat()
    here = link.recv_match("GPS_RAW_INT.fix_type>=3", "GPS_RAW_INT", blocking=True)
    sent = square(here.lat / 1e7, here.lon / 1e7)
    result = upload(link, sent)
    print("upload:", result)
    if result != "MAV_MISSION_ACCEPTED":
        raise SystemExit("the vehicle did not take the mission")
    back = download(link)
    for one in back:
        name = mavlink.enums["MAV_CMD"][one.command].name
        print(f"{one.seq}  {name:<28} {one.x / 1e7:.6f} {one.y / 1e7:.6f} {one.z:.0f} m")
    ours, theirs = (
        [(one.command, one.x, one.y, one.z) for one in items[1:]] for items in (sent, back)
    )
    print("the same" if ours == theirs else "different")
