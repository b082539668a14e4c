"""Multicast links: every program on the group hears every other, and not itself."""

from __future__ import annotations

import sys

from . import Any
from .udp import DatagramLink
from .waiting import (
    address_family,
    ask_for_room,
    interface_index,
    set_close_on_exec,
    socket_address,
    split_host_port,
)

DEFAULT_GROUP = "239.255.145.50"
DEFAULT_PORT = 14550


def group_and_port(device: str) -> tuple[str, int]:
    """`""`, `PORT` or `GROUP:PORT` with the defaults filled in; ValueError otherwise."""
    if not device:
        return DEFAULT_GROUP, DEFAULT_PORT
    if ":" not in device:
        device = f"{DEFAULT_GROUP}:{device}"
    group, port = split_host_port(device, "mcast")
    if not group:
        return DEFAULT_GROUP, port
    return _checked(group), port


def _checked(group: str) -> str:
    """`group`; ValueError if it is no multicast address."""
    import ipaddress

    try:
        is_group = ipaddress.ip_address(group).is_multicast
    except ValueError:
        is_group = False
    if not is_group:
        raise ValueError(
            f"mcast: {group!r} is no multicast address, 224.0.0.0 to 239.255.255.255 or ff00::/8"
        )
    return group


class mavmcast(DatagramLink):
    """`device` is `""`, PORT, GROUP:PORT or [GROUP]:PORT with an IPv6 group."""

    def __init__(
        self,
        device: str,
        source_system: int = 255,
        source_component: int = 0,
        use_native: bool = False,
    ) -> None:
        import socket

        group, number = group_and_port(device)
        self.port = self._receiver(socket, group, number)
        self.port_out = socket.socket(address_family(group), socket.SOCK_DGRAM)
        try:
            self.port_out.setblocking(False)
            if "%" in group:
                index = interface_index(group.partition("%")[2])
                self.port_out.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_IF, index)
            self.port_out.connect(socket_address((group, number)))
        except BaseException:
            self.port.close()
            self.port_out.close()
            raise
        for endpoint in (self.port, self.port_out):
            set_close_on_exec(endpoint.fileno())
        self.own_address = self.port_out.getsockname()
        self.myport = self.own_address[1]
        super().__init__(
            self.port.fileno(), device, source_system=source_system,
            source_component=source_component, input=False, use_native=use_native,
        )  # fmt: skip
        self._read_datagrams(self.own_address)

    @staticmethod
    def _receiver(socket: Any, group: str, number: int) -> Any:
        """A socket that has joined the group."""
        family = address_family(group)
        port = socket.socket(family, socket.SOCK_DGRAM, socket.IPPROTO_UDP)
        try:
            port.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if hasattr(socket, "SO_REUSEPORT"):
                port.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            try:
                port.bind(socket_address((group, number)))
            except OSError:
                # Windows binds no group address.
                port.bind(("", number))
            # On the interface that is named, or the one that the system chooses.
            if family == socket.AF_INET6:
                address, _, scope = group.partition("%")
                interface = interface_index(scope).to_bytes(4, sys.byteorder)
                membership = socket.inet_pton(family, address) + interface
                port.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, membership)
            else:
                membership = socket.inet_aton(group) + socket.inet_aton("0.0.0.0")
                port.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
            port.setblocking(False)
            ask_for_room(port)
        except BaseException:
            port.close()
            raise
        return port

    def _release(self) -> None:
        super()._release()
        self.port_out.close()

    def recv(self, n: int | None = None) -> bytes:
        """One datagram of someone else; empty when none is waiting."""
        while (received := self._receive()) is not None:
            data, sender = received
            if sender != self.own_address:
                self._switch_peer(sender)
                return data
        return b""

    def write(self, buf: bytes) -> None:
        """Send to the group; errors are counted, not raised."""
        try:
            self.port_out.send(buf)
        except OSError:
            self.write_errors += 1
