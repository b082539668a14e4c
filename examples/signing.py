#!/usr/bin/env python3
"""Signed messages: a key, and nothing is believed that was not signed with it.

python -c "import secrets; print(secrets.token_hex(32))" > key.txt
mavwire sim --signing-key key.txt
python examples/signing.py udpin:127.0.0.1:14550 key.txt
"""

from __future__ import annotations

import sys
from pathlib import Path

from mavwire import mavutil
from mavwire.dialects.v20 import common as mavlink

if len(sys.argv) != 3:
    raise SystemExit("usage: signing.py DEVICE KEY_FILE")
device, key_file = sys.argv[1:]
key = bytes.fromhex(Path(key_file).read_text())

with mavutil.mavlink_connection(device, dialect="common") as link:
    link.setup_signing(
        key,
        # A telemetry radio reports its own state and has no key: only that may be unsigned.
        allow_unsigned_callback=mavutil.allow_radio_status,
        # A timestamp must never be used twice, not even by the next run of this program.
        timestamp_store=key_file + ".timestamp",
    )
    beat = link.wait_heartbeat(timeout=10)
    if beat is None:
        counts = link.mav.signing
        raise SystemExit(
            f"no heartbeat signed with this key; {counts.badsig_count} bad signatures, "
            f"{counts.reject_count} messages refused"
        )
    print(f"system {link.target_system}: signed {beat.get_signed()}, link id {beat.get_link_id()}")

    # Outgoing messages are signed too, or the vehicle would not answer.
    version = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    link.mav.command_long_send(
        link.target_system, link.target_component, mavlink.MAV_CMD_REQUEST_MESSAGE,
        0, version, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip
    msg = link.recv_match(type="AUTOPILOT_VERSION", blocking=True, timeout=10)
    print("no answer" if msg is None else f"answered, signed {msg.get_signed()}")
