"""The file transfer protocol, client side; `mavwire.mavftp` offers it under pymavlink's names.

The other end is not trusted: what it answers ends in no path, no unbounded memory and no endless loop.
"""

import logging
import struct

log = logging.getLogger("mavwire.mavftp")

# Number, session, opcode, size, the request's opcode, burst complete, padding, offset; then data.
HEADER = struct.Struct("<HBBBBBBI")
# Bytes of data in a packet.
MAX_PAYLOAD = 239
