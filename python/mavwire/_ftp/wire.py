"""The layout of a packet, for the client, the simulated vehicle and programs alike."""

from __future__ import annotations

import struct

# Number, session, opcode, size, the request's opcode, burst complete, padding, offset; then data.
HEADER = struct.Struct("<HBBBBBBI")
# Bytes of data in a packet.
MAX_PAYLOAD = 239
