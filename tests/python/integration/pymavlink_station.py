"""A ground station made of pymavlink alone: what it finds out is printed as one line of JSON.

python pymavlink_station.py pymavlink DEVICE TASK [ARGUMENT]
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import time
from typing import Any

os.environ["MAVLINK20"] = "1"
WAIT = 60.0
TAKEOFF, ARM_DISARM, REQUEST = 22, 400, 512


def receive(link: Any, name: str, condition: str | None = None) -> Any:
    msg = link.recv_match(type=name, condition=condition, blocking=True, timeout=WAIT)
    if msg is None:
        raise SystemExit(f"no {name} within {WAIT} s")
    return msg


def ask(link: Any, send: Any, name: Any, condition: str | None = None) -> Any:
    """The answer to what `send()` sends, again and again: a busy reader may lose some."""
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        send()
        msg = link.recv_match(type=name, condition=condition, blocking=True, timeout=5)
        if msg is not None:
            return msg
    raise SystemExit(f"no {name} within {WAIT} s")


def fly(link: Any) -> dict[str, Any]:
    receive(link, "EKF_STATUS_REPORT", "EKF_STATUS_REPORT.flags==831")
    link.set_mode("GUIDED")
    receive(link, "HEARTBEAT", "HEARTBEAT.custom_mode==4")
    mode = link.flightmode
    link.arducopter_arm()
    link.motors_armed_wait()
    link.mav.command_long_send(1, 1, TAKEOFF, 0, 0, 0, 0, 0, 0, 0, 10)
    highest = 0.0
    while highest < 9.8:
        highest = max(highest, receive(link, "GLOBAL_POSITION_INT").relative_alt / 1e3)
    link.set_mode("LAND")
    link.motors_disarmed_wait()
    landed = not link.motors_armed()
    return {
        "mode": mode, "highest": highest, "landed": landed,
        "bad": link.mav.total_receive_errors,
    }  # fmt: skip


def params(link: Any) -> dict[str, Any]:
    names: set[str] = set()
    msg = ask(link, link.param_fetch_all, "PARAM_VALUE")
    while len(names) < msg.param_count:
        msg = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=5)
        msg = msg or ask(link, link.param_fetch_all, "PARAM_VALUE")
        if msg.param_id != "_HASH_CHECK":
            names.add(msg.param_id)
    return {"names": sorted(names)}


def mission(link: Any) -> dict[str, Any]:
    link.waypoint_count_send(4)
    while True:
        msg = receive(link, ["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"])  # type: ignore
        if msg.get_type() == "MISSION_ACK":
            break
        link.mav.mission_item_int_send(
            1, 1, msg.seq, 6, 16, 0, 1, 0, 0, 0, 0, 473977420, 85455940, 10 + 10 * msg.seq
        )
    items = []
    for seq in range(ask(link, link.waypoint_request_list_send, "MISSION_COUNT").count):
        item = ask(
            link, lambda seq=seq: link.mav.mission_request_int_send(1, 1, seq),
            "MISSION_ITEM_INT", f"MISSION_ITEM_INT.seq=={seq}",
        )  # fmt: skip
        items.append({"z": item.z})
    return {"result": msg.type, "items": items}


def listen(link: Any) -> dict[str, Any]:
    types, count, end = set(), 0, time.monotonic() + WAIT
    while count < 1000 and time.monotonic() < end:
        msg = link.recv_match(blocking=True, timeout=0.2)
        if msg is not None:
            types.add(msg.get_type())
            count += 1
    return {
        "types": sorted(types), "bad": link.mav.total_receive_errors, "loss": link.packet_loss(),
    }  # fmt: skip


def signed(link: Any, key: str) -> dict[str, Any]:
    link.setup_signing(bytes.fromhex(key))
    beat = receive(link, "HEARTBEAT")
    version = ask(
        link, lambda: link.mav.command_long_send(1, 1, REQUEST, 0, 148, 0, 0, 0, 0, 0, 0),
        "AUTOPILOT_VERSION",
    )  # fmt: skip
    return {"signed": beat.get_signed() and version.get_signed(), "answered": True}


def ftp(link: Any) -> dict[str, Any]:
    mavftp = importlib.import_module(f"{link.__class__.__module__.split('.')[0]}.mavftp")
    client = mavftp.MAVFTP(link, 1, 1)
    client.cmd_list(["/"])
    client.process_ftp_reply("ListDirectory", timeout=WAIT)
    names = [entry.name for entry in client.list_result]
    data = bytearray()
    client.cmd_get(["@PARAM/param.pck", "-"], callback=lambda file: data.extend(file.read()))
    client.process_ftp_reply("OpenFileRO", timeout=WAIT)
    return {"names": names, "size": len(data)}


def main() -> None:
    package, device, task, *arguments = sys.argv[1:]
    mavutil = importlib.import_module(f"{package}.mavutil")
    link = mavutil.mavlink_connection(device)
    if device.startswith("udpout"):
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
    if link.wait_heartbeat(timeout=WAIT) is None and task != "signed":
        raise SystemExit("no heartbeat")
    print(json.dumps(globals()[task](link, *arguments)))


if __name__ == "__main__":
    main()
