"""The kernel's own time to send datagrams: `python benches/python/send_floor.py`, on Linux.

A loop over `sendmmsg` and nothing else sends a vehicle's frames to ten sockets on loopback, a datagram for each frame,
in calls of 1 to 64. This is what a bridge to ten links costs at least where no two frames share a datagram or leave
together.
"""

from __future__ import annotations

import ctypes
import os
import socket
import time

from bridge_worker import frames

LINKS = 10
DATAGRAMS = 200_000
CALLS = (1, 4, 16, 64)


class IoVec(ctypes.Structure):
    _fields_ = (("base", ctypes.c_void_p), ("len", ctypes.c_size_t))


class MsgHdr(ctypes.Structure):
    """Of a socket that is connected only the parts are used."""

    _fields_ = (
        ("name", ctypes.c_void_p), ("name_len", ctypes.c_uint),
        ("parts", ctypes.POINTER(IoVec)), ("part_count", ctypes.c_size_t),
        ("control", ctypes.c_void_p), ("control_len", ctypes.c_size_t), ("flags", ctypes.c_int),
    )  # fmt: skip


class MMsgHdr(ctypes.Structure):
    _fields_ = (("header", MsgHdr), ("sent", ctypes.c_uint))


def headers_of(some: list[bytes]) -> ctypes.Array[MMsgHdr]:
    """A header for each datagram. They point into `some`, which has to live as long."""
    parts = [IoVec(ctypes.cast(ctypes.c_char_p(one), ctypes.c_void_p), len(one)) for one in some]
    made = (MMsgHdr * len(some))()
    for one, part in zip(made, parts, strict=True):
        one.header.parts, one.header.part_count = ctypes.pointer(part), 1
    return made


def micros(made: list[bytes], per_call: int) -> float:
    """CPU time of a datagram in microseconds, user and system."""
    send = ctypes.CDLL(None, use_errno=True).sendmmsg
    calls = [headers_of(made[at : at + per_call]) for at in range(0, len(made), per_call)]
    sinks: list[socket.socket] = []
    links: list[socket.socket] = []
    for _ in range(LINKS):
        for some in (sinks, links):
            some.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        sinks[-1].bind(("127.0.0.1", 0))
        links[-1].connect(sinks[-1].getsockname())
    numbers = [link.fileno() for link in links]
    sent, began = 0, time.process_time()
    while sent < DATAGRAMS:
        for headers in calls:
            for number in numbers:
                if send(number, headers, len(headers), 0) != len(headers):
                    raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
            sent += LINKS * len(headers)
    took = time.process_time() - began
    for sock in (*sinks, *links):
        sock.close()
    return 1e6 * took / sent


def main() -> None:
    made = frames("mix")[:1_024]
    print(f"{'datagrams a call':>17}{'us CPU each':>13}")
    for per_call in CALLS:
        best = min(micros(made, per_call) for _ in range(3))
        print(f"{per_call:>17}{best:>13.2f}")


if __name__ == "__main__":
    main()
