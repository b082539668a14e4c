#!/usr/bin/env python3
"""The output of a bad link: broken frames, lost frames, and text between the frames.

mavwire sim --corrupt 10% --loss 5%
python examples/bad_data.py
"""

from __future__ import annotations

import sys

from mavwire import mavutil

device = sys.argv[1] if len(sys.argv) > 1 else "udpin:127.0.0.1:14550"
SHOWN = 10  # pieces of junk; the others are only counted

good = unknown = pieces = junk = 0

link = mavutil.mavlink_connection(device)
link.wait_heartbeat()
while good < 300:
    msg = link.recv_msg()
    if msg is None:
        link.select(0.1)
    elif msg.get_type() == "BAD_DATA":
        # Bytes that are not a frame with a right checksum. A console's text may be among them.
        pieces += 1
        junk += len(msg.data)
        if mavutil.all_printable(msg.data):
            print("text:", bytes(msg.data).decode("ascii"))
        elif pieces <= SHOWN:
            print(f"{len(msg.data)} bytes: {msg.reason}")
    elif msg.get_type().startswith("UNKNOWN_"):
        unknown += 1  # intact as far as one can see, but not in this dialect
    else:
        good += 1

print(f"{good} messages, {unknown} unknown, {junk} bad bytes in {pieces} pieces")
print(f"{link.mav_loss} messages lost, {link.packet_loss():.1f}% by their sequence numbers")
link.close()
