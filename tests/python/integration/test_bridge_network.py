"""Bridges on hosts of their own: a ring of them, cables that are pulled, hosts that vanish."""

from __future__ import annotations

import socket
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import pytest
from integration.namespaces import Cable, Host, hosts
from mavwire import Bridge
from unit.bridge_tools import LIMIT, command, peers, receive, report, wait_until
from unit.link_tools import heartbeat

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="network namespaces are Linux's")


@contextmanager
def bridge_on(host: Host, links: dict[str, str], **options: float) -> Iterator[Bridge]:
    """A bridge whose sockets and threads belong to a host."""
    with ExitStack() as stack:
        with host.inside():
            bridge = stack.enter_context(Bridge(dedup=LIMIT))
            for name, endpoint in links.items():
                bridge.add(endpoint, name=name, **options)
        yield bridge


@contextmanager
def station_on(host: Host, to: str | None = None, port: int = 14550) -> Iterator[socket.socket]:
    """A UDP socket of a host that listens on a port, or sends to one."""
    with host.inside():
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with made:
        made.settimeout(LIMIT)
        if to is None:
            made.bind(("0.0.0.0", port))
        else:
            made.connect((to, port))
        yield made


def test_three_hosts_and_two_bridges_in_a_ring() -> None:
    """Two ways between the bridges: each frame arrives once, none goes round, and one way is enough."""
    with hosts(5) as (vehicle, camera, station, left, right), ExitStack() as stack:
        one, two, three = Cable(vehicle, left, 1), Cable(camera, left, 2), Cable(right, station, 3)
        ways = [Cable(left, right, 4), Cable(left, right, 5)]
        far = bridge_on(
            right,
            {"first": "udpin:10.4.0.2:15000", "second": "udpin:10.5.0.2:15000",
             "station": f"udpout:{three.right}:14550"},
        )  # fmt: skip
        far_bridge = stack.enter_context(far)
        near = bridge_on(
            left,
            {"vehicles": "udpin:0.0.0.0:14550", "first": f"udpout:{ways[0].right}:15000",
             "second": f"udpout:{ways[1].right}:15000"},
        )  # fmt: skip
        near_bridge = stack.enter_context(near)
        flown = stack.enter_context(station_on(vehicle, one.right))
        filmed = stack.enter_context(station_on(camera, two.right))
        ground = stack.enter_context(station_on(station))

        for seq in range(100):
            for sender, system in ((flown, 1), (filmed, 2)):
                sender.send(heartbeat(seq, system))
                assert receive(ground) == heartbeat(seq, system), "each once, in order"
        # They are told of each other, once too: the camera as soon as it has said something.
        assert [receive(filmed) for _ in range(1, 100)] == [heartbeat(n, 1) for n in range(1, 100)]
        assert [receive(flown) for _ in range(100)] == [heartbeat(n, 2) for n in range(100)]
        wait_until("copies", lambda: sum(
            peer["duplicates"] for name in ("first", "second") for peer in peers(far_bridge, name)
        ) == 200)  # fmt: skip
        for bridge, went in ((near_bridge, 200), (far_bridge, 200)):
            links = bridge.stats()["links"]
            assert sum(link["received"] - link["duplicates"] for link in links) == went

        far_bridge.send(command(1))
        assert receive(flown) == command(1), "and nothing came back meanwhile"

        ways[0].pull()
        for seq in range(100, 120):
            flown.send(heartbeat(seq, 1))
            assert receive(ground) == heartbeat(seq, 1), "over the other one"
        far_bridge.send(command(1, seq=1))
        assert receive(flown) == command(1, seq=1)


def test_datagrams_find_another_way_when_the_address_changes() -> None:
    """A lease that ends, a cable that becomes a radio; and a start before there is a network."""
    with hosts(2) as (near, far), ExitStack() as stack:
        early = stack.enter_context(bridge_on(near, {"out": "udpout:10.1.0.2:14550"}, retry=0.3))
        assert report(early, "out")["state"] == "connecting", "nothing leads there yet"
        cable = Cable(near, far, 1)
        ground = stack.enter_context(station_on(far))
        wait_until("a way", lambda: report(early, "out")["state"] == "up")
        early.send(heartbeat(seq=1))
        assert receive(ground) == heartbeat(seq=1)
        near.run("ip", "address", "del", f"{cable.left}/24", "dev", "c1")

        def way_is_gone() -> bool:
            early.send(heartbeat(seq=2))
            return bool(report(early, "out")["error"])

        wait_until("an error", way_is_gone)
        near.run("ip", "address", "add", "10.1.0.77/24", "dev", "c1")
        wait_until("another way", lambda: report(early, "out")["state"] == "up")
        early.send(heartbeat(seq=3))
        ground_got, where = ground.recvfrom(300)
        assert (ground_got, where[0]) == (heartbeat(seq=3), "10.1.0.77")
        assert report(early, "out")["connections"] == 2
        ground.sendto(heartbeat(seq=4, sysid=9), where)
        assert wait_until("it", lambda: early.latest("HEARTBEAT", 9)).get_seq() == 4


def test_a_host_that_vanishes_is_missed_and_found_again() -> None:
    """Without a word of goodbye: either side gives the connection up, and makes it again."""
    with hosts(2) as (near, far), ExitStack() as stack:
        cable = Cable(near, far, 1)
        server = stack.enter_context(bridge_on(far, {"in": "tcpin:0.0.0.0:5760"}, peer_timeout=1))
        client = stack.enter_context(
            bridge_on(near, {"out": f"tcp:{cable.right}:5760"}, peer_timeout=1, retry=0.3)
        )
        wait_until("them", lambda: report(client, "out")["state"] == "up" and peers(server, "in"))
        cable.pull()
        # One has something to say, the other waits.

        def silence_ended() -> bool:
            client.send(heartbeat())
            return report(client, "out")["state"] != "up" and not peers(server, "in")

        wait_until("the end of the silence", silence_ended)
        cable.plug()
        wait_until("them", lambda: report(client, "out")["state"] == "up" and peers(server, "in"))
        server.send(heartbeat(seq=7, sysid=9))
        assert wait_until("it", lambda: client.latest("HEARTBEAT", 9)).get_seq() == 7
