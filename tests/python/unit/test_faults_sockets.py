"""What a system may answer to any call on a socket: nothing is raised at a sender, and the link goes on."""

from __future__ import annotations

import errno
import os
import socket
import struct
import sys
from pathlib import Path
from typing import Any

import pytest
from integration.namespaces import hosts
from mavwire import mavutil
from unit.bridge_tools import wait_until
from unit.faults import python
from unit.link_tools import drain, heartbeat, record
from watchdog import watched

# What sending and receiving may fail with for a while.
PASSING = [
    "EAGAIN", "ENOBUFS", "ENOMEM", "EPERM", "EACCES", "ENETDOWN", "ENETUNREACH", "EHOSTUNREACH",
    "ECONNREFUSED", "EMSGSIZE", "EIO",
]  # fmt: skip
FATAL = ["ECONNRESET", "EPIPE", "ETIMEDOUT", "ENOTCONN"]


class Failing:
    """A socket whose calls fail once for each error."""

    def __init__(self, port: Any, errors: list[str], calls: tuple[str, ...]) -> None:
        self._port = port
        self._calls = calls
        self.left = [getattr(errno, name) for name in errors]

    def __getattr__(self, name: str) -> Any:
        real = getattr(self._port, name)
        if name not in self._calls:
            return real

        def call(*arguments: Any) -> Any:
            if self.left:
                number = self.left.pop(0)
                raise OSError(number, os.strerror(number))
            return real(*arguments)

        return call


def udp(kind: str) -> tuple[Any, socket.socket]:
    """A UDP link that knows its peer, and the peer."""
    peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    peer.bind(("127.0.0.1", 0))
    peer.settimeout(60)
    if kind == "udpout":
        link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{peer.getsockname()[1]}")
        link.write(heartbeat())
        link_address = peer.recvfrom(300)[1]
        peer.connect(link_address)
        return link, peer
    link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    peer.connect(("127.0.0.1", link.port.getsockname()[1]))
    peer.send(heartbeat())
    assert link.recv_match(blocking=True, timeout=60) is not None
    return link, peer


@pytest.mark.parametrize("kind", ["udpin", "udpout"])
def test_a_datagram_link_counts_what_could_not_be_sent_and_goes_on(kind: str) -> None:
    link, peer = udp(kind)
    with link, peer, watched():
        errors = PASSING + FATAL
        link.port = Failing(link.port, errors, ("sendto", "send"))
        for _ in errors:
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert (link.write_errors, link.port.left) == (len(errors), [])
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert len(peer.recv(300)) > 0
        assert link.write_errors == len(errors)


@pytest.mark.parametrize("kind", ["udpin", "udpout"])
def test_a_datagram_link_receives_behind_errors_about_earlier_datagrams(kind: str) -> None:
    link, peer = udp(kind)
    with link, peer, watched():
        errors = ["ECONNREFUSED", "EHOSTUNREACH", "ENETUNREACH", "ECONNRESET", "EAGAIN"]
        link.port = port = Failing(link.port, errors, ("recvfrom", "recv", "recvfrom_into"))
        peer.send(heartbeat(7))
        msg = link.recv_match(blocking=True, timeout=60)
        assert (msg.get_seq(), port.left) == (7, [])


def test_a_refusal_by_the_other_host_ends_nothing() -> None:
    """ICMP says that nobody listens there; who comes later is heard."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        address = probe.getsockname()
    with mavutil.mavlink_connection(f"udpout:127.0.0.1:{address[1]}") as link, watched():
        for _ in range(20):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert link.recv_msg() is None
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as late:
            late.bind(address)
            late.settimeout(60)
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            _, sender = late.recvfrom(300)
            late.sendto(heartbeat(), sender)
            assert link.recv_match(blocking=True, timeout=60).get_type() == "HEARTBEAT"


def test_routes_that_are_forbidden_or_missing() -> None:
    """The errors of a system, in a network of its own."""
    with hosts(1) as (host,), host.inside():
        host.run("ip", "route", "add", "prohibit", "10.9.1.0/24")
        host.run("ip", "route", "add", "unreachable", "10.9.2.0/24")
        host.run("ip", "route", "add", "blackhole", "10.9.3.0/24")
        for net in (1, 2, 3, 4):
            with mavutil.mavlink_connection(f"udpout:10.9.{net}.1:14550") as link:
                for _ in range(3):
                    link.mav.heartbeat_send(6, 8, 0, 0, 0)
                    assert link.recv_msg() is None
                assert link.write_errors == 3, net
            with pytest.raises(OSError, match=r"\S"):
                mavutil.mavlink_connection(f"tcp:10.9.{net}.1:5760", retries=1)


def tcp(**options: Any) -> tuple[Any, socket.socket, socket.socket]:
    server = socket.create_server(("127.0.0.1", 0))
    server.settimeout(60)
    link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}", **options)
    return link, server, server.accept()[0]


def reset(connection: socket.socket) -> None:
    """End it as the system does for a process that is killed."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


@pytest.mark.parametrize("name", PASSING + FATAL)
def test_a_stream_that_cannot_be_sent_on_is_made_again(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Half a frame may be on its way, so that nothing else can follow it."""
    link, server, peer = tcp(autoreconnect=True)
    with link, server, peer, watched():
        peer.sendall(heartbeat())
        assert link.recv_match(blocking=True, timeout=60) is not None
        link.port = port = Failing(link.port, [name], ("send", "sendall"))
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert port.left == []
        if name == "EAGAIN":
            link.recv_msg()  # what waits is sent first
            assert len(peer.recv(300)) > 0
            return
        assert link.port is not port
        port._port.close()
        wait_until("the connection", lambda: link.recv_msg() or link.port is not None)
        with server.accept()[0] as again:
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            again.settimeout(60)
            assert again.recv(1) in (b"\xfd", b"\xfe"), "it begins with a whole frame"


def test_a_peer_that_resets_is_connected_to_again(capsys: pytest.CaptureFixture[str]) -> None:
    link, server, peer = tcp(autoreconnect=True)
    with link, server, watched():
        for seq in range(3):
            peer.sendall(heartbeat(seq))
            msg = None
            while msg is None:
                msg = link.recv_match()
            assert msg.get_seq() == seq
            reset(peer)
            wait_until("the end", lambda: link.recv_msg() is None and link.port is None)
            wait_until("the connection", lambda: link.recv_msg() or link.port is not None)
            peer = server.accept()[0]
        peer.close()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of descriptors differ")
def test_descriptors_are_used_up(tmp_path: Path) -> None:
    """Opening says so; what is open goes on, and servers take clients when there is room again."""
    program = """
import os, resource, socket, sys
import mavwire
from mavwire import mavutil
from unit.bridge_tools import wait_until
from unit.link_tools import heartbeat

# What is imported when it is first needed needs a descriptor.
server = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
udp = mavutil.mavlink_connection("udpin:127.0.0.1:0")
bridge = mavwire.Bridge(["tcpin:127.0.0.1:0"])
bridge.start()
ports = [server.listen.getsockname()[1],
         int(bridge.stats()["links"][0]["endpoint"].rpartition(":")[2])]
clients = [socket.socket() for _ in ports]
out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
_, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
resource.setrlimit(resource.RLIMIT_NOFILE, (64, hard))
used = []
try:
    while True:
        used.append(os.open("/dev/null", os.O_RDONLY))
except OSError:
    pass
for device in ("udpin:127.0.0.1:0", "udpout:127.0.0.1:9", "tcpin:127.0.0.1:0", sys.argv[1]):
    try:
        mavutil.mavlink_connection(device)
    except OSError as error:
        assert error.errno == 24, error
    else:
        raise AssertionError(device)
for client, port in zip(clients, ports):
    client.connect(("127.0.0.1", port))
    client.sendall(heartbeat(5))
for _ in range(50):
    assert server.recv_msg() is None
out.sendto(heartbeat(6), udp.port.getsockname())
assert udp.recv_match(blocking=True, timeout=60).get_seq() == 6
for one in used:
    os.close(one)
assert wait_until("the client", server.recv_msg).get_seq() == 5
wait_until("the client of the bridge", lambda: bridge.stats()["components"])
bridge.stop()
"""
    log = tmp_path / "flight.tlog"
    log.write_bytes(record(heartbeat()))
    done = python(program, str(log))
    told = "tcpin:127.0.0.1:0: a client cannot be served: [Errno 24] Too many open files; trying again\n"
    assert (done.returncode, done.stderr) == (0, told)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="poll() fails so on Linux")
def test_a_bridge_that_cannot_wait_for_its_descriptors_goes_on() -> None:
    """poll() refuses more descriptors than the process may have now."""
    program = """
import resource, socket
from mavwire import Bridge
from unit.bridge_tools import wait_until
from unit.link_tools import heartbeat

with Bridge(["udpin:127.0.0.1:0", "tcpin:127.0.0.1:0"]) as bridge:
    ends = [link["endpoint"].rpartition(":") for link in bridge.stats()["links"]]
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    out.connect(("127.0.0.1", int(ends[0][2])))
    peer = socket.create_connection(("127.0.0.1", int(ends[1][2])), timeout=60)
    wait_until("the client", lambda: any(link["peer"] for link in bridge.stats()["links"]))
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    for seq, few in enumerate((limits[0], 2, 2, 2, limits[0])):
        resource.setrlimit(resource.RLIMIT_NOFILE, (few, limits[1]))
        out.send(heartbeat(seq))
        assert peer.recv(300) == heartbeat(seq)
"""
    done = python(program)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_receive_buffer_that_overflows_costs_datagrams_and_nothing_else() -> None:
    link, peer = udp("udpin")
    with link, peer, watched():
        link.port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        for n in range(2000):
            peer.send(heartbeat(n % 256))
        found = len(drain(link))
        assert 0 < found < 2000
        peer.send(heartbeat(77))
        assert link.recv_match(blocking=True, timeout=60).get_seq() == 77
