"""The other ends of links, for failing_sessions.py: what they do never fails."""

from __future__ import annotations

import base64
import ctypes
import hashlib
import os
import pty
import socket
import threading
import tty
from collections.abc import Callable
from contextlib import suppress
from typing import Any

LIMIT = 60.0
WEBSOCKET_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
# Of the library that was preloaded.
faults = ctypes.PyDLL(None)


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
