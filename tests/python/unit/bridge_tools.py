"""Bridges, peers and waiting for conditions, for the tests of the bridge."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import pack

if TYPE_CHECKING:
    from mavwire import Bridge

# Far beyond what anything takes: a test that waits so long has failed.
LIMIT = 60.0
UDP = "udpin:127.0.0.1:0"
TCP = "tcpin:127.0.0.1:0"
MARKER_V1, MARKER_V2 = 0xFE, 0xFD
# What came behind the frame that was received last.
_waiting: WeakKeyDictionary[socket.socket, bytes] = WeakKeyDictionary()


def wait_until(what: str, condition: Callable[[], Any]) -> Any:
    """Wait for a condition to be true; its value."""
    end = time.monotonic() + LIMIT
    while not (value := condition()):
        assert time.monotonic() < end, f"waited for {what}"
        time.sleep(0.01)
    return value


def report(bridge: Bridge, name: str) -> dict[str, Any]:
    """The entry of a link itself."""
    return next(one for one in bridge.stats()["links"] if one["name"] == name)


def peers(bridge: Bridge, name: str) -> list[dict[str, Any]]:
    """The entries of a link's peers."""
    return [one for one in bridge.stats()["links"] if one["name"] == name and one["peer"]]


def port_of(bridge: Bridge, name: str) -> int:
    """The port that a server listens on."""
    return int(report(bridge, name)["endpoint"].rpartition(":")[2])


@contextmanager
def udp_peer(bridge: Bridge | None = None, name: str = "") -> Iterator[socket.socket]:
    """A socket, connected to a UDP server of the bridge if there is one named."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 0))
        peer.settimeout(LIMIT)
        if bridge is not None:
            peer.connect(("127.0.0.1", port_of(bridge, name)))
        yield peer


def receive(peer: socket.socket) -> bytes:
    """The next frame: those that waited for a bridge together share a datagram."""
    data = _waiting.pop(peer, b"") or peer.recv(65536)
    length = len(data)
    if data[0] == MARKER_V2:
        length = 12 + data[1] + 13 * (data[2] & 1)
    elif data[0] == MARKER_V1:
        length = 8 + data[1]
    if length < len(data):
        _waiting[peer] = data[length:]
    return data[:length]


def read_exactly(stream: socket.socket, count: int) -> bytes:
    """So many bytes of a stream."""
    data = bytearray()
    while len(data) < count:
        part = stream.recv(count - len(data))
        assert part, "the stream ended"
        data += part
    return bytes(data)


def run_alone(program: str) -> None:
    """A program in a process of its own, which must end well."""
    where = str(Path(__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([where, *sys.path])},
        capture_output=True, text=True, timeout=3 * LIMIT, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def command(target: int, seq: int = 0, component: int = 1) -> bytes:
    """A command of the station 255/190 to a component."""
    msg = mavlink.MAVLink_command_long_message(target, component, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    return pack(msg, seq, 255, 190)
