"""Sending to peers that take little at a time."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    import socket

# A peer that takes nothing for so many seconds is given up.
PATIENCE = 30.0
PIECE = 16 * 1024


def send_all(connection: socket.socket, data: bytes) -> None:
    """Send `data` piece by piece; TimeoutError if a piece is not taken in time."""
    connection.settimeout(PATIENCE)
    view = memoryview(data)
    for start in range(0, len(view), PIECE):
        connection.sendall(view[start : start + PIECE])
