#!/usr/bin/env python3
"""Parameters: read them all, ask again for what got lost, change one, and see that it changed.

python examples/parameters.py [DEVICE [NAME VALUE]]

Without a name it is one that ArduPilot has.
"""

from __future__ import annotations

import math
import sys
from typing import Any

from mavwire import mavutil

device = sys.argv[1] if len(sys.argv) > 1 else "udpin:127.0.0.1:14550"
NAME, VALUE = sys.argv[2:] if len(sys.argv) > 2 else ("WPNAV_SPEED", "750")


def fetch_all(link: Any) -> dict[str, float]:
    """All parameters. The vehicle sends them once; what is missing is asked for by its index."""
    found: dict[int, str] = {}
    count = None
    link.param_fetch_all()
    while count is None or len(found) < count:
        msg = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=1)
        if msg is None and count is None:
            link.param_fetch_all()
        elif msg is None:
            for index in sorted(set(range(count or 0)) - set(found))[:20]:
                link.param_fetch_one(index)
        elif msg.param_index < msg.param_count:
            count = msg.param_count
            found[msg.param_index] = msg.param_id
    return {name: link.params[name] for name in found.values()}


def change(link: Any, name: str, value: float) -> float:
    """Set a parameter; the value that the vehicle has then, which may tell the old one meanwhile."""
    known = link.params[name]
    for _ in range(4):
        link.param_set_send(name, value)
        while msg := link.recv_match(
            f"PARAM_VALUE.param_id=='{name}'", "PARAM_VALUE", blocking=True, timeout=2
        ):
            known = float(msg.param_value)
            if math.isclose(known, value, rel_tol=1e-6):
                return known
    return known


with mavutil.mavlink_connection(device) as link:
    link.wait_heartbeat()
    params = fetch_all(link)
    print(f"{len(params)} parameters")
    if NAME not in params:
        raise SystemExit(f"{NAME} is not among them: name another one, and its new value")
    print(f"{NAME} is {params[NAME]:g}")
    print(f"{NAME} is now {change(link, NAME, float(VALUE)):g}")
