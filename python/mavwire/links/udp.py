"""UDP links: a server that answers every sender of MAVLink messages, a client, a broadcaster.

Anyone can send a datagram, so a sender becomes a reply target only once a message of its own was
accepted, and with a signing key that means a good signature.
"""

from __future__ import annotations

import errno
import time
from time import monotonic

from mavwire._native import MAVLink, Message, peer_to_replace

from . import Any, warn
from .chunked import ChunkedLink
from .names import look_up
from .waiting import (
    address_family,
    ask_for_room,
    bind,
    datagrams_dropped,
    set_close_on_exec,
    split_host_port,
)

UDP_MAX_PACKET_LEN = 65535
# Each reply target costs a send per message.
MAX_CLIENTS = 128
# Looking up a name may block for seconds: the least time between two attempts.
LOOKUP_PAUSE = 10.0

# "Nothing there", and what the network reports about datagrams sent earlier.
NOTHING_RECEIVED = frozenset((
    errno.EAGAIN, errno.EWOULDBLOCK, errno.ECONNREFUSED, errno.ECONNRESET,
    errno.EHOSTUNREACH, errno.ENETUNREACH,
))  # fmt: skip


class DatagramLink(ChunkedLink):
    """A link over a datagram socket, `port`."""

    _aio_transport = "Transport"
    # Fits into an Ethernet frame.
    batch_bytes = 1400
    # Counted instead of raised: a datagram link has no one to tell.
    write_errors = 0

    @property
    def datagrams_dropped(self) -> int:
        """Datagrams lost because this link was not read quickly enough, where the system counts."""
        return datagrams_dropped(self.port)

    def _release(self) -> None:
        self.fd = None  # its number may be somebody else's next
        self.port.close()

    def _receive(self) -> tuple[bytes, Any] | None:
        """The next datagram and its sender; None if none is waiting."""
        try:
            received: tuple[bytes, Any] = self._take_datagram() or self.port.recvfrom(
                UDP_MAX_PACKET_LEN
            )
        except OSError as error:
            if error.errno in NOTHING_RECEIVED:
                return None
            raise
        return received


class mavudp(DatagramLink):
    """`device` is host:port: where to listen if `input`, where to send otherwise."""

    _aio_transport = "DatagramClient"
    clients_refused = 0
    # The destination's name is to be looked up: at first, and again when sending fails.
    _lookup_due = True
    _next_lookup = 0.0
    # Somebody was told that the name is not known.
    _unknown_said = False

    def __init__(
        self,
        device: str,
        input: bool = True,
        broadcast: bool = False,
        source_system: int = 255,
        source_component: int = 0,
        use_native: bool = False,
        timeout: float = 0,
    ) -> None:
        host, number = split_host_port(device, "UDP")
        self.udp_server = input
        self.broadcast = broadcast and not input
        self.port = self._socket(address_family(host))
        if input:
            try:
                # Without SO_REUSEADDR: a second listener would take the datagrams of the first.
                bind(self.port, (host, number))
            except BaseException:
                self.port.close()
                raise
        else:
            self.destination_addr = (host, number)
        self.last_address: Any = None
        self.timeout = timeout
        self.clients: set[Any] = set()
        self.clients_last_alive: dict[Any, float] = {}
        # Clients that have sent a message to a system. They are replaced last.
        self._useful_clients: set[Any] = set()
        self.resolved_destination_addr: Any = None
        super().__init__(
            self.port.fileno(), device, source_system=source_system,
            source_component=source_component, input=input, use_native=use_native,
        )  # fmt: skip
        self._read_datagrams()

    def _socket(self, family: int) -> Any:
        import socket

        port = socket.socket(family, socket.SOCK_DGRAM)
        set_close_on_exec(port.fileno())
        port.setblocking(False)
        ask_for_room(port)
        if self.broadcast:
            port.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        return port

    def recv(self, n: int | None = None) -> bytes:
        """One datagram of any length; empty when none is waiting."""
        data = self._read_datagram()
        # A client that is bound to its server has nobody to find.
        if data and (self.udp_server or self.broadcast) and self._holds_trusted(data):
            self._heard(self.last_address)
        return data

    def _recv_own(self, n: int | None) -> bytes:
        """Of what this link parses itself `post_message` knows whom to answer."""
        is_replaced = getattr(self.recv, "__func__", None) is not _NATIVE_RECV
        return self.recv(n) if is_replaced else self._read_datagram()

    def _read_datagram(self) -> bytes:
        received = self._receive()
        if received is None:
            return b""
        data, self.last_address = received
        self._switch_peer(self.last_address)
        return data

    def _holds_trusted(self, data: bytes) -> bool:
        """Whether `data` has a message that may say who is there. A caller of `recv` need not parse
        with this link, or at all. Looking leaves `mav` as it was: with a key a message is good once.
        """
        mav: Any = self.mav
        if isinstance(mav, MAVLink):
            return mav._holds_trusted(data)
        if self._has_key():  # then only the program's own parser knows what is good
            return False
        mav = self._new_mav()
        mav.robust_parsing = True
        return any(msg.get_msgId() >= 0 for msg in mav.parse_buffer(data) or ())

    def _has_key(self) -> bool:
        signing = getattr(self.mav, "signing", None)
        return signing is not None and signing.secret_key is not None

    def post_message(self, msg: Message) -> None:
        """Take a received message into the link's state, once. Its sender, which is that of the last
        datagram, is answered from now on.
        """
        is_new = not getattr(msg, "_posted", False)
        if is_new and self.last_address is not None and self._is_trusted(msg):
            self._heard(self.last_address, _is_targeted(msg))
        super().post_message(msg)

    def _is_trusted(self, msg: Message) -> bool:
        """Whether `msg` may say who is there: with a key, what a callback let pass may not."""
        return msg.get_msgId() >= 0 and (not self._has_key() or bool(msg.get_signed()))

    def _heard(self, address: Any, is_targeted: bool = False) -> None:
        """Answer `address` from now on: a valid message came from it."""
        if self.udp_server:
            now = time.time()
            if address in self.clients or self._room_for_client(address, now):
                self.clients_last_alive[address] = now
                self.clients.add(address)
                if is_targeted:
                    self._useful_clients.add(address)
        elif self.broadcast:
            self.broadcast = False
            self.destination_addr = address
            self._found(address)

    def _room_for_client(self, address: Any, now: float) -> bool:
        heard = {} if len(self.clients) < MAX_CLIENTS else self._heard_at()
        if len(heard) < MAX_CLIENTS:
            return True
        peers = [
            (str(one[0]), one in self._useful_clients, now - moment)
            for one, moment in heard.items()
        ]
        silent = peer_to_replace(str(address[0]), peers)
        if silent is None:
            self.clients_refused += 1
            return False
        self._forget_client(list(heard)[silent])
        return True

    def _heard_at(self) -> dict[Any, float]:
        """When each client was heard, as it is now: meanwhile another thread may hear or forget one."""
        times = self.clients_last_alive.copy()
        return {address: times.get(address, 0.0) for address in tuple(self.clients)}

    def _forget_client(self, address: Any) -> None:
        self.clients.discard(address)
        self._useful_clients.discard(address)
        self.clients_last_alive.pop(address, None)

    def _forget_silent_clients(self) -> None:
        """Drop clients silent for `timeout` seconds, but keep the one heard last."""
        if self.timeout <= 0 or len(self.clients) < 2:
            return
        heard = self._heard_at()
        newest = max(heard.values(), default=0.0)
        oldest = time.time() - self.timeout
        for address, moment in heard.items():
            if moment < min(oldest, newest):
                self._forget_client(address)

    def write(self, buf: bytes) -> None:
        """Send to every client heard, or to the destination; errors are counted, not raised."""
        if self.udp_server:
            self._forget_silent_clients()
            for address in tuple(self.clients):
                self._send(buf, address)
        else:
            self._send_out(buf)

    def _send_out(self, buf: bytes) -> None:
        address = self._destination()
        if address is None:
            self.write_errors += 1
            self._say_unknown()
        elif not self._send(buf, address):
            self._lookup_due = True  # the host may have moved

    def _say_unknown(self) -> None:
        """Log once why nothing is sent: sending raises nothing."""
        if not self._unknown_said:
            self._unknown_said = True
            reason = (
                "no IPv4 address of %s:%s is found; it is looked up again now and then. "
                "An IPv6 address is written [ADDRESS]:PORT"
            )
            warn(reason, *self.destination_addr)

    def _send(self, buf: bytes, address: Any) -> bool:
        """Whether the system took the datagram, or may take the next one."""
        try:
            self.port.sendto(buf, address)
        except (BlockingIOError, InterruptedError):  # there is no room for it
            self.write_errors += 1
        except OSError:
            self.write_errors += 1
            return False
        return True

    # -- where to send to

    def _destination(self) -> Any:
        """The destination as a numeric address; None while its name cannot be looked up."""
        if self._lookup_due and monotonic() >= self._next_lookup:
            self._look_up()
        return self.resolved_destination_addr

    def _look_up(self) -> None:
        self._found(self._resolve())

    def _found(self, address: Any) -> None:
        """Use a looked-up address. None leaves the address that was found before."""
        self._next_lookup = monotonic() + LOOKUP_PAUSE
        self._lookup_due = address is None
        if address is not None:
            self.resolved_destination_addr = address

    def _resolve(self) -> Any:
        """The address to send to, of the family of the socket; None while the host is not known."""
        import socket

        host, number = self.destination_addr
        try:
            return look_up(host, number, self.port.family, socket.SOCK_DGRAM)[0][4]
        except (OSError, UnicodeError, OverflowError):
            return None


def _is_targeted(msg: Message) -> bool:
    """Whether `msg` has a target system. MANUAL_CONTROL calls the field `target`."""
    return bool(getattr(msg, "target_system", 0) or getattr(msg, "target", 0))


# Programs may replace `recv` in the class. The comparison with the original shows it.
_NATIVE_RECV = mavudp.recv
