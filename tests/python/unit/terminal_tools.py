"""What a program shows on a terminal of its own."""

from __future__ import annotations

import os


def read_terminal(fd: int) -> str:
    """What a program writes to its terminal, until it ends."""
    data = b""
    try:
        while part := os.read(fd, 4096):
            data += part
    except OSError:
        pass  # how Linux says that the other end is closed
    os.close(fd)
    return data.decode()
