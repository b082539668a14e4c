"""Sessions over links and bridges in which one call of the system fails, each call in its turn.

Run by test_faults_injected.py with failing_calls.c preloaded: `failing_sessions.py KIND...` tells, as JSON, what
calls a session of each kind makes and how many of them failed; it ends with an error where something was not as it must be.
"""

from __future__ import annotations

import base64
import ctypes
import errno
import faulthandler
import gc
import hashlib
import json
import os
import pty
import socket
import sys
import tempfile
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from mavwire import Bridge, mavutil
from unit.link_tools import heartbeat

LIMIT = 60.0
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
WEBSOCKET_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"

# Of the library that was preloaded.
faults = ctypes.PyDLL(None)


@contextmanager
def aside() -> Iterator[None]:
    """What the other end does neither counts nor fails."""
    faults.faults_stand_aside(1)
    try:
        yield
    finally:
        faults.faults_stand_aside(0)


class Peer:
    """The other end. Each connection's bytes are kept by themselves, as half a frame may end one."""

    def __init__(self) -> None:
        self.streams: list[bytearray] = [bytearray()]

    def device(self, link: Any) -> None:
        """Told of the link once it is open."""

    def send(self, frame: bytes) -> None:
        """To the link, if it is there."""

    def receive(self) -> None:
        """Everything that is there."""

    def close(self) -> None:
        """The end."""

    def frames(self, system: int | None = None) -> int:
        """Whole frames from the link, of a system. AssertionError for a torn one that others follow."""
        count = 0
        for stream in self.streams:
            at = 0
            while at < len(stream):
                assert stream[at] == 0xFD, (at, stream)
                is_meant = system is None or stream[at + 5 : at + 6] == bytes([system])
                at += 12 + stream[at + 1] if at + 1 < len(stream) else 12
                count += is_meant and at <= len(stream)
        return count


class Datagrams(Peer):
    """Speaks to a server, or is spoken to."""

    def __init__(self, to: Callable[[Any], Any] | None = None, broadcast: bool = False) -> None:
        super().__init__()
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.bind(("0.0.0.0" if broadcast else "127.0.0.1", 0))
        self.sock.setblocking(False)
        self.number = self.sock.getsockname()[1]
        self.address: Any = None

    def device(self, link: Any) -> None:
        if link.udp_server:
            self.address = link.port.getsockname()

    def send(self, frame: bytes) -> None:
        if self.address is not None:
            with suppress(OSError):
                self.sock.sendto(frame, self.address)

    def receive(self) -> None:
        with suppress(BlockingIOError):
            while True:
                data, self.address = self.sock.recvfrom(65536)
                self.streams.append(bytearray(data))

    def close(self) -> None:
        self.sock.close()


GROUP = "239.255.145.51"


class Group(Datagrams):
    """Has joined a group, and speaks to it."""

    def __init__(self) -> None:
        Peer.__init__(self)
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        for option in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
            self.sock.setsockopt(socket.SOL_SOCKET, option, 1)
        self.sock.bind(("", 0))
        self.sock.setblocking(False)
        self.number = self.sock.getsockname()[1]
        self.address = (GROUP, self.number)
        member = socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0")
        self.sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)

    def device(self, link: Any) -> None:
        """The group is the same for all."""

    def receive(self) -> None:
        with suppress(BlockingIOError):
            while True:
                data = self.sock.recv(65536)
                if data[5] == 255:  # its own come, too
                    self.streams.append(bytearray(data))


class Stream(Peer):
    """One connection after the other, which `connected` makes if there is one to be had."""

    def __init__(self) -> None:
        super().__init__()
        self.sock: Any = None

    def connected(self) -> Any:
        raise NotImplementedError

    def framed(self, frame: bytes) -> bytes:
        return frame

    def received(self, data: bytes) -> None:
        self.streams[-1] += data

    def _try(self, act: Callable[[Any], Any]) -> None:
        if self.sock is None:
            self.sock = self.connected()
            if self.sock is None:
                return
            self.streams.append(bytearray())
        try:
            act(self.sock)
        except BlockingIOError:
            pass
        except OSError:
            self.sock.close()
            self.sock = None

    def send(self, frame: bytes) -> None:
        self._try(lambda sock: sock.sendall(self.framed(frame)))

    def receive(self) -> None:
        def read(sock: Any) -> None:
            while data := sock.recv(65536):
                self.received(data)
            raise ConnectionResetError

        self._try(read)

    def close(self) -> None:
        if self.sock is not None:
            self.sock.close()


class Server(Stream):
    """Takes the connections of a link."""

    def __init__(self, family: int = socket.AF_INET, address: Any = ("127.0.0.1", 0)) -> None:
        super().__init__()
        self.listen = socket.socket(family, socket.SOCK_STREAM)
        self.listen.bind(address)
        self.listen.listen(8)
        self.listen.setblocking(False)
        self.number = self.listen.getsockname()[-1]

    def connected(self) -> Any:
        try:
            sock = self.listen.accept()[0]
        except BlockingIOError:
            return None
        sock.setblocking(False)
        return sock

    def close(self) -> None:
        super().close()
        self.listen.close()


class Client(Stream):
    """Connects to a server."""

    address: Any = None

    def device(self, link: Any) -> None:
        self.address = link.listen.getsockname()

    def connected(self) -> Any:
        if self.address is None:
            return None
        try:
            sock = socket.create_connection(self.address, LIMIT)
        except OSError:
            return None
        sock.setblocking(False)
        return sock


def web_frame(payload: bytes, masked: bool) -> bytes:
    """A binary message; the mask of a client is of zeros."""
    head = bytes([0x82, len(payload) | (0x80 if masked else 0)])
    return head + (b"\0" * 4 if masked else b"") + payload


def unmasked(stream: bytes) -> bytes:
    """The binary messages of a stream, without their wrapping."""
    found, at = b"", 0
    while at + 2 <= len(stream):
        length, mask = stream[at + 1] & 0x7F, stream[at + 1] >> 7
        start = at + 2 + 4 * mask
        key = (stream[at + 2 : start] if mask else b"\0") or b"\0"
        payload = bytes(b ^ key[n % len(key)] for n, b in enumerate(stream[start : start + length]))
        found += payload if stream[at] == 0x82 else b""
        at = start + length
    return found


class WebClient(Client):
    def connected(self) -> Any:
        sock = super().connected()
        self.raw, self.open = b"", False
        if sock is not None:
            request = "GET / HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            key = base64.b64encode(b"k" * 16).decode()
            sock.sendall(
                f"{request}Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
            )
        return sock

    def framed(self, frame: bytes) -> bytes:
        return web_frame(frame, True)

    def received(self, data: bytes) -> None:
        self.raw += data
        if not self.open and b"\r\n\r\n" in self.raw:
            self.raw, self.open = self.raw.partition(b"\r\n\r\n")[2], True
        if self.open:
            self.streams[-1] = bytearray(unmasked(self.raw))


class WebServer(Server):
    """Shakes hands in a thread, since the link waits for that."""

    def __init__(self) -> None:
        super().__init__()
        self.made: list[Any] = []
        self.raw = b""
        self.listen.setblocking(True)
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        faults.faults_stand_aside(1)
        with suppress(OSError):
            while True:
                sock = self.listen.accept()[0]
                sock.settimeout(LIMIT)
                request = b""
                while b"\r\n\r\n" not in request and (data := sock.recv(4096)):
                    request += data
                key = request.partition(b"Sec-WebSocket-Key: ")[2].partition(b"\r\n")[0]
                accept = base64.b64encode(hashlib.sha1(key + WEBSOCKET_GUID).digest())
                with suppress(OSError):
                    sock.sendall(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                                 b"Connection: Upgrade\r\nSec-WebSocket-Accept: " + accept + b"\r\n\r\n")  # fmt: skip
                sock.setblocking(False)
                self.made.append(sock)

    def connected(self) -> Any:
        self.raw = b""
        return self.made.pop(0) if self.made else None

    def framed(self, frame: bytes) -> bytes:
        return web_frame(frame, False)

    def received(self, data: bytes) -> None:
        self.raw += data
        self.streams[-1] = bytearray(unmasked(self.raw))

    def close(self) -> None:
        self.listen.shutdown(socket.SHUT_RDWR)
        super().close()
        for sock in self.made:
            sock.close()


class Terminal(Peer):
    """The other side of a serial port."""

    def __init__(self) -> None:
        super().__init__()
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        self.name = os.ttyname(slave)
        self._slave = slave
        os.set_blocking(self.master, False)

    def send(self, frame: bytes) -> None:
        with suppress(OSError):
            os.write(self.master, frame)

    def receive(self) -> None:
        with suppress(OSError):
            while data := os.read(self.master, 65536):
                self.streams[-1] += data

    def close(self) -> None:
        os.close(self.master)
        os.close(self._slave)


class Echo(Peer):
    """A child process gives back what it is sent."""

    def frames(self, system: int | None = None) -> int:
        return 1


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
        bridge = Bridge()
        try:
            try:
                with bridge:
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
            while (left := descriptors()) > before:  # of threads that are about to end
                assert time.monotonic() < end, (kind, name, count, error, left, before)
                time.sleep(0.001)
    return {"calls": dict(zip(KINDS, counts, strict=True)), "failed": hits}


if __name__ == "__main__":
    faulthandler.dump_traceback_later(200, exit=True)
    print(json.dumps({kind: each_call_once(kind) for kind in sys.argv[1:]}))
