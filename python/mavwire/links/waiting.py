"""Finding an endpoint's address, and setting up sockets: what every socket link needs."""

from __future__ import annotations

import errno
import os
import sys

from . import Any
from .names import is_numeric, look_up
from .recognise import is_serial_name

MAX_PORT = 65535


def set_close_on_exec(fd: int) -> None:
    """Keep `fd` out of child processes where the platform can; never fails."""
    if sys.platform == "win32":  # a socket's number is no descriptor there, or another file's
        return
    from contextlib import suppress

    with suppress(OSError):
        os.set_inheritable(fd, False)


# A peer that vanished (power, radio, cable) ends no connection. It is asked after 10 s of silence and
# given up 20 s later, and with data on the way after a minute. Systems wait for two hours, and for
# a quarter of one, by themselves.
_KEEPALIVE = (("TCP_KEEPIDLE", 10), ("TCP_KEEPINTVL", 5), ("TCP_KEEPCNT", 4),
              ("TCP_USER_TIMEOUT", 60_000))  # fmt: skip


def prepare_tcp(port: Any) -> None:
    """Send frames at once, and notice a peer that is gone without a word."""
    import socket
    from contextlib import suppress

    port.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    port.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _KEEPALIVE:
        if hasattr(socket, name):
            with suppress(OSError):  # named by the headers, not known to the system
                port.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


# Wanted size of a receive buffer: a tenth of a second of 100,000 datagrams a second, which count
# 768 bytes each. Systems allow less by default and then give what they allow.
RECEIVE_BUFFER = 8 << 20


def ask_for_room(port: Any) -> None:
    """Let a datagram socket hold more than the usual few hundred datagrams for a busy reader."""
    import socket
    from contextlib import suppress

    if sys.platform.startswith("linux"):
        with suppress(OSError):  # only the superuser may have more than the limit
            port.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, RECEIVE_BUFFER)
            return
    with suppress(OSError):  # some systems refuse instead of giving less
        port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)


# Linux: a receive buffer beyond the system's limit.
_SO_RCVBUFFORCE = 33
# Linux: memory and drop counters of a socket, nine 32-bit numbers of which the last counts drops.
_SO_MEMINFO = 55
_MEMINFO_LEN = 9 * 4


def datagrams_dropped(port: Any) -> int:
    """Datagrams that the system dropped because nobody read `port`; 0 where it does not say."""
    import socket

    if not sys.platform.startswith("linux"):
        return 0
    try:
        memory = port.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, _MEMINFO_LEN)
    except OSError:
        return 0  # closed, or a system that does not count
    return int.from_bytes(memory[-4:], sys.byteorder)


def split_host_port(device: str, kind: str) -> tuple[str, int]:
    """`host:port` or `[v6 address]:port` as a pair; ValueError names `kind` of link otherwise."""
    host, separator, port = device.rpartition(":")
    bracketed = host.startswith("[") and host.endswith("]")
    if not separator:
        raise ValueError(f"{kind} ports must be specified as host:port")
    if (":" in host and not bracketed) or host.startswith("/") or is_serial_name(host):
        raise ValueError(
            f"{kind} ports must be specified as host:port, which {device!r} is not; "
            "an IPv6 address stands in brackets, the baud rate of a serial port behind a comma"
        )
    try:
        number = int(port)
    except ValueError:
        raise ValueError(f"{kind} port number {port!r} in {device!r} is not a number") from None
    if not 0 <= number <= MAX_PORT:
        raise ValueError(f"{kind} port number {number} in {device!r} is not from 0 to {MAX_PORT}")
    return host[1:-1] if bracketed else host, number


def interface_index(scope: str) -> int:
    """The index of a network interface by its name or index; 0 for none. OSError without such."""
    import socket

    if scope.isdecimal() and len(scope) < len(str(1 << 32)):
        return int(scope)
    try:
        index = socket.if_nametoindex(scope) if scope else 0
    except OSError:
        raise OSError(errno.ENODEV, f"there is no network interface {scope!r}") from None
    return index


def socket_address(address: tuple[str, int]) -> tuple[str, int] | tuple[str, int, int, int]:
    """`address` as sockets take it: the network interface after the % of an IPv6 address is a number
    of its own there."""
    host, port = address
    numeric, percent, scope = host.partition("%")
    return (numeric, port, 0, interface_index(scope)) if percent else address


def bind(port: Any, address: tuple[str, int]) -> None:
    """Bind a socket; an OSError names the address."""
    host, number = address
    try:
        if host and not is_numeric(host):
            address = look_up(host, number, port.family, port.type)[0][4]
        port.bind(socket_address(address))
    except OSError as error:
        raise type(error)(error.errno, f"{error.strerror}: {host}:{number}") from None


def address_family(host: str) -> int:
    """AF_INET6 for a numeric IPv6 host, AF_INET for names and IPv4 addresses."""
    import socket

    return socket.AF_INET6 if ":" in host else socket.AF_INET
