"""Slots of a bridge's servers: no address takes them all, and silent or useless peers are replaced."""

from __future__ import annotations

import socket
import sys
from contextlib import ExitStack
from typing import Any

import pytest
from encoder import heartbeat
from mavwire import Bridge
from unit.bridge_tools import TCP, UDP, command, peers, port_of, report, wait_until

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs two loopback addresses")

SLOTS = 64
ATTACKER, STATION = "127.0.0.9", "127.0.0.1"
# A peer that is silent for so many seconds is not active; a little more than in the bridge.
SILENCE = 5.2


class Door:
    """A server of a bridge, and its clients."""

    def __init__(self, bridge: Bridge, stack: ExitStack, endpoint: str, name: str = "door") -> None:
        bridge.add(endpoint, name=name)
        self.bridge, self.stack, self.name = bridge, stack, name
        self.is_tcp = endpoint == TCP
        self.address = ("127.0.0.1", port_of(bridge, name))

    def come(self, host: str) -> socket.socket:
        kind = socket.SOCK_STREAM if self.is_tcp else socket.SOCK_DGRAM
        one = self.stack.enter_context(socket.socket(socket.AF_INET, kind))
        one.bind((host, 0))
        one.settimeout(30)
        one.connect(self.address)
        return one

    def fill(self, host: str, slots: int = SLOTS) -> list[socket.socket]:
        """A crowd, each of which has sent a heartbeat."""
        crowd = []
        for _ in range(slots):
            crowd.append(self.come(host))
            crowd[-1].sendall(heartbeat(sysid=9))
        wait_until("them", lambda: all(map(self.has, crowd)))
        wait_until("their frames", lambda: all(one["received"] for one in self.of()))
        return crowd

    def of(self) -> list[dict[str, Any]]:
        return peers(self.bridge, self.name)

    def came(self) -> int:
        """How many came, and were let in or not."""
        told = report(self.bridge, self.name)
        return int(told["refused"] + told["connections"])

    def inside(self) -> set[str]:
        return {one["peer"] for one in self.of()}

    def has(self, one: socket.socket) -> bool:
        host, port = one.getsockname()
        return f"{host}:{port}" in self.inside()


def pause(bridge: Bridge, seconds: float) -> None:
    start = bridge.stats()["uptime"]
    wait_until("time", lambda: bridge.stats()["uptime"] > start + seconds)


@pytest.mark.parametrize("endpoint", [UDP, TCP])
def test_a_crowd_of_one_address_keeps_no_other_one_out(endpoint: str) -> None:
    """Not even an active crowd: a quarter of the slots is for others, and it takes none of these back."""
    with Bridge() as bridge, ExitStack() as stack:
        door = Door(bridge, stack, endpoint)
        door.fill(ATTACKER)
        stations = door.fill(STATION, SLOTS // 4)
        assert len(door.inside()) == SLOTS
        for _ in range(20):
            door.come(ATTACKER).sendall(heartbeat(sysid=9))
        wait_until("their fate", lambda: door.came() == SLOTS + SLOTS // 4 + 20)
        assert all(map(door.has, stations))
        assert len(door.inside()) == SLOTS


@pytest.mark.parametrize("endpoint", [UDP, TCP])
def test_a_frame_now_and_then_keeps_no_slot(endpoint: str) -> None:
    """A silent peer without a command is replaced first, and active peers stay."""
    with Bridge() as bridge, ExitStack() as stack:
        door = Door(bridge, stack, endpoint)
        (commander,) = door.fill(STATION, 1)
        commander.sendall(command(9))
        door.fill(ATTACKER, 46)
        (active,) = door.fill(STATION, 1)
        door.fill(ATTACKER, 16)
        pause(bridge, SILENCE)
        active.sendall(heartbeat(sysid=8))
        wait_until("it", lambda: bridge.latest("HEARTBEAT", 8))
        door.fill(STATION, 30)
        assert door.has(commander)
        assert door.has(active)


def test_a_crowd_at_other_servers_leaves_room() -> None:
    """The bridge has room for 256 peers and links altogether."""
    with Bridge() as bridge, ExitStack() as stack:
        for n in range(3):
            Door(bridge, stack, UDP, f"door {n}").fill(ATTACKER)
        third = Door(bridge, stack, UDP, "door 3")
        for _ in range(63):
            third.come(ATTACKER).sendall(heartbeat(sysid=9))
        wait_until("them", lambda: third.came() == 63)
        last = Door(bridge, stack, UDP, "door 4")
        last.fill(STATION, 10)
        assert len(last.inside()) == 10
        bridge.add("udpout:127.0.0.1:9", name="another link")
