"""Sessions over links and bridges in which one call of the system fails, each call in its turn.

Run by test_faults_injected.py with failing_calls.c preloaded: `failing_sessions.py KIND...` tells, as JSON, what
calls a session of each kind makes and how many of them failed; it ends with an error where something was not as it must be.
"""

from __future__ import annotations

import errno
import faulthandler
import gc
import json
import os
import socket
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from mavwire import Bridge, mavutil
from unit.failing_peers import (
    GROUP,
    LIMIT,
    Client,
    Datagrams,
    Echo,
    Group,
    Peer,
    Server,
    Terminal,
    WebClient,
    WebServer,
    faults,
)
from unit.link_tools import heartbeat

ERRORS = {
    "socket": ["EMFILE"],
    "bind": ["EADDRINUSE"],
    "connect": ["ENETUNREACH"],
    "listen": ["EADDRINUSE"],
    "setsockopt": ["ENOMEM"],
    "getsockopt": ["ENOBUFS"],
    "getsockname": ["ENOBUFS"],
    "poll": ["EINTR", "ENOMEM"],
    "receive": ["EINTR", "ENOMEM", "ECONNRESET"],
    "send": ["EINTR", "ENOBUFS", "EPIPE"],
    "accept": ["ECONNABORTED", "EMFILE"],
    "close": ["EIO"],
}
KINDS = list(ERRORS)
MOST_CALLS = 8
"""Of a kind, that fail in their turns: what comes later is the same again."""


@contextmanager
def aside() -> Iterator[None]:
    """What the other end does neither counts nor fails."""
    faults.faults_stand_aside(1)
    try:
        yield
    finally:
        faults.faults_stand_aside(0)


def connect(device: str, **options: Any) -> Any:
    return mavutil.mavlink_connection(device, **options)


QUICK = {"autoreconnect": True, "retries": 1}


def udpin() -> tuple[Peer, Callable[[], Any]]:
    return Datagrams(), lambda: connect("udpin:127.0.0.1:0")


def udpout() -> tuple[Peer, Callable[[], Any]]:
    peer = Datagrams()
    return peer, lambda: connect(f"udpout:127.0.0.1:{peer.number}")


def udpbcast() -> tuple[Peer, Callable[[], Any]]:
    peer = Datagrams(broadcast=True)
    return peer, lambda: connect(f"udpbcast:127.255.255.255:{peer.number}")


def mcast() -> tuple[Peer, Callable[[], Any]]:
    peer = Group()
    return peer, lambda: connect(f"mcast:{GROUP}:{peer.number}")


def tcp() -> tuple[Peer, Callable[[], Any]]:
    peer = Server()
    return peer, lambda: mavutil.mavtcp(f"127.0.0.1:{peer.number}", reconnect_delay=0.01, **QUICK)


def uds() -> tuple[Peer, Callable[[], Any]]:
    path = os.path.join(tempfile.mkdtemp(), "socket")
    peer = Server(socket.AF_UNIX, path)
    return peer, lambda: mavutil.mavuds(path, reconnect_delay=0.01, **QUICK)


def tcpin() -> tuple[Peer, Callable[[], Any]]:
    return Client(), lambda: connect("tcpin:127.0.0.1:0")


def wsserver() -> tuple[Peer, Callable[[], Any]]:
    return WebClient(), lambda: connect("wsserver:127.0.0.1:0")


def ws() -> tuple[Peer, Callable[[], Any]]:
    peer = WebServer()
    return peer, lambda: mavutil.mavwebsocket_client(
        f"ws:127.0.0.1:{peer.listen.getsockname()[1]}", reconnect_delay=0.01
    )


def serial() -> tuple[Peer, Callable[[], Any]]:
    peer = Terminal()
    return peer, lambda: mavutil.mavserial(
        peer.name, 57600, autoreconnect=True, reconnect_delay=0.01
    )


def child() -> tuple[Peer, Callable[[], Any]]:
    return Echo(), lambda: connect("exec:/bin/cat")


LINKS = {
    one.__name__: one
    for one in (udpin, udpout, udpbcast, mcast, tcp, uds, tcpin, wsserver, ws, serial, child)
}


class Session:
    """A link is opened, receives, sends and is closed. What it may raise is the error that was armed."""

    def __init__(
        self, make: Callable[[], tuple[Peer, Callable[[], Any]]], armed: int | None
    ) -> None:
        self.armed = armed
        with aside():
            self.peer, self.open = make()

    @contextmanager
    def allowed(self) -> Iterator[None]:
        """OSError with the number that was armed."""
        try:
            yield
        except OSError as error:
            assert self.armed is not None and error.errno == self.armed, error

    def run(self) -> None:
        link = None
        with self.allowed():
            link = self.open()
        try:
            if link is not None:
                self.use(link)
        finally:
            with aside():
                self.peer.close()

    def use(self, link: Any) -> None:
        received = False
        end = time.monotonic() + LIMIT
        with aside():
            self.peer.device(link)
        with self.allowed():
            assert link.recv_match(blocking=True, timeout=0.001) is None, (
                "it waits, as nothing is there"
            )
        while not (received and self.peer.frames()):
            assert time.monotonic() < end, (received, self.peer.streams)
            with aside():
                self.peer.send(heartbeat())
                self.peer.receive()
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            with self.allowed():
                received |= link.recv_match(blocking=True, timeout=0.01) is not None
        with self.allowed():
            link.close()
        with aside():
            self.peer.receive()
        self.peer.frames()


class BridgeSession:
    """A bridge between a link of each kind and a datagram socket; `add` may be refused with a typed error."""

    def __init__(self, make: Callable[[], Peer], armed: int | None) -> None:
        self.armed = armed
        with aside():
            self.peer, self.endpoint, self.options = make()
            self.other = Datagrams()
            self.other.address = None

    def run(self) -> None:
        try:
            try:
                with Bridge() as bridge:
                    name = bridge.add(self.endpoint, name="link", **self.options)
                    bridge.add(f"udpout:127.0.0.1:{self.other.number}", name="other")
                    self.use(bridge, name)
            except OSError as error:
                assert self.armed is not None and error.errno == self.armed, error
        finally:
            with aside():
                self.peer.close()
                self.other.close()

    def use(self, bridge: Bridge, name: str) -> None:
        end = time.monotonic() + LIMIT
        if self.endpoint.startswith(("udpin", "tcpin")):
            where = next(one for one in bridge.stats()["links"] if one["name"] == name)["endpoint"]
            self.peer.address = ("127.0.0.1", int(where.rpartition(":")[2]))
        seq = 0
        while not (self.peer.frames(2) and self.other.frames(1) and self.peer.frames(3)):
            assert time.monotonic() < end, (self.peer.streams, self.other.streams, bridge.stats())
            seq += 1
            with aside():
                self.peer.send(heartbeat(seq % 256))
                self.other.send(heartbeat(seq % 256, sysid=2))
                time.sleep(0.002)
                self.peer.receive()
                self.other.receive()
            bridge.send(heartbeat(seq % 256, sysid=3))


def bridge_udpin() -> tuple[Peer, str, dict[str, Any]]:
    return Datagrams(), "udpin:127.0.0.1:0", {}


def bridge_udpout() -> tuple[Peer, str, dict[str, Any]]:
    peer = Datagrams()
    return peer, f"udpout:127.0.0.1:{peer.number}", {}


def bridge_tcpin() -> tuple[Peer, str, dict[str, Any]]:
    return Client(), "tcpin:127.0.0.1:0", {}


def bridge_tcp() -> tuple[Peer, str, dict[str, Any]]:
    peer = Server()
    return peer, f"tcp:127.0.0.1:{peer.number}", {}


def bridge_serial() -> tuple[Peer, str, dict[str, Any]]:
    peer = Terminal()
    return peer, f"{peer.name}:57600", {}


BRIDGES = {
    one.__name__: one
    for one in (bridge_udpin, bridge_udpout, bridge_tcpin, bridge_tcp, bridge_serial)
}


def descriptors() -> int:
    gc.collect()
    return len(os.listdir("/proc/self/fd"))


def session(kind: str, call: int = 0, count: int = 0, number: int | None = None) -> bool:
    """Whether the call failed."""
    made: Any = (
        BridgeSession(BRIDGES[kind], number) if kind in BRIDGES else Session(LINKS[kind], number)
    )
    faults.faults_begin(call, count, number or 0)
    try:
        made.run()
    finally:
        failed = faults.faults_end()
    return bool(failed)


def failures(count: int, errors: list[str]) -> Iterator[tuple[int, str]]:
    """Each call once and each error once, by the number of the call."""
    for n in range(max(min(count, MOST_CALLS), len(errors)) if count else 0):
        yield 1 + n % count, errors[n % len(errors)]


def each_call_once(kind: str) -> dict[str, Any]:
    """The calls of a session that are counted, and how many of each kind failed."""
    for _ in range(2):  # what is loaded once is loaded
        session(kind)
    gc.collect()
    gc.freeze()  # what is loaded need not be looked through each time
    before = descriptors()
    session(kind)
    counts = [faults.faults_count(call) for call in range(len(KINDS))]
    hits: dict[str, int] = {}
    for call, name in enumerate(KINDS):
        for count, error in failures(counts[call], ERRORS[name]):
            try:
                hit = session(kind, call, count, getattr(errno, error))
            except BaseException:
                print(f"{kind}: {name} number {count}, {error}", file=sys.stderr)
                raise
            hits[name] = hits.get(name, 0) + hit
            end = time.monotonic() + LIMIT
            if (kind, name) == ("serial", "close"):  # pyserial leaves its pipes open
                before = descriptors()
            while (left := descriptors()) > before:  # of threads that are about to end
                assert time.monotonic() < end, (kind, name, count, error, left, before)
                time.sleep(0.001)
    return {"calls": dict(zip(KINDS, counts, strict=True)), "failed": hits}


if __name__ == "__main__":
    faulthandler.dump_traceback_later(200, exit=True)
    print(json.dumps({kind: each_call_once(kind) for kind in sys.argv[1:]}))
