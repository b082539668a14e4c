"""Links, as `mavwire._native` has them."""

from collections.abc import Iterable
from typing import IO, Any, ClassVar, Self

from mavwire._native import Message, StreamWriter
from mavwire._stubs.mavutil import CurrentMAVLink, ReceivedMessage
from typing_extensions import disjoint_base

@disjoint_base
class SystemState:
    """Base of `mavutil.mavfile_state`: holds the table of newest messages."""

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Self: ...
    messages: dict[str, Any]
    """Message type -> newest message."""

    @property
    def components(self) -> dict[int, dict[str, Any]]:
        """Component id -> message type -> newest message of that component alone, as they are now."""

    def of_component(self, compid: int, kind: str | None = None) -> dict[str, Any]:
        """Message type -> newest message of a component, as they are now. With `kind` of that type alone."""

    def __setattr__(self, name: str, value: Any, /) -> None: ...
    def __delattr__(self, name: str, /) -> None: ...

@disjoint_base
class Link:
    """The part of `mavutil.mavfile`'s state that every message changes.

    A derived class that native code reads has `_quick_methods`, the methods that native code replaces.
    """

    _QUICK_METHODS: ClassVar[list[str]]
    """Names of the methods that native code replaces. A program may replace them, too."""

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Self: ...
    def __setattr__(self, name: str, value: Any, /) -> None: ...
    def __delattr__(self, name: str, /) -> None: ...
    mav: CurrentMAVLink
    """The `MAVLink` object of the current dialect."""
    message_hooks: Any
    """Functions called as `hook(link, message)` for every message."""
    mav_count: int
    """Messages received, radio status, BAD_DATA and UNKNOWN not counted."""
    mav_loss: int
    """Messages lost, by the gaps in sequence numbers."""

    @property
    def names_refused(self) -> int:
        """Message types, instances, components and parameters that were not kept because there were
        too many already."""
    uptime: float
    """Seconds since the vehicle booted, as its messages say."""
    first_byte: bool
    """The protocol version of the link is still to be found out from its first byte."""
    logfile: IO[bytes] | None
    """File that received messages are recorded to, or None."""
    logfile_raw: IO[bytes] | None
    """File that received bytes are recorded to, or None."""

    @property
    def sysid_state(self) -> dict[int, Any]:
        """System id -> mavfile_state."""

    @sysid_state.setter
    def sysid_state(self, value: dict[int, Any]) -> None: ...
    @property
    def last_seq(self) -> dict[tuple[int, int], int]:
        """`{(sysid, compid): last sequence number}`, a copy."""

    @last_seq.setter
    def last_seq(self, value: dict[tuple[int, int], int]) -> None: ...
    @property
    def timestamp(self) -> float:
        """Time of the last message in seconds since 1970; 0 before the first."""

    @timestamp.setter
    def timestamp(self, value: float) -> None: ...
    @property
    def _timestamp(self) -> float | None:
        """Time of the record being read from a log; None on live links."""

    @_timestamp.setter
    def _timestamp(self, value: float | None) -> None: ...
    @property
    def notimestamps(self) -> bool:
        """Messages are stamped with `uptime` instead of the time of their record."""

    @notimestamps.setter
    def notimestamps(self, value: object) -> None: ...
    def post_message(self, msg: Message) -> None:
        """Takes a received message into the link's state, once, then calls the message hooks."""

    def recv_msg(self) -> ReceivedMessage | None:
        """The next message, BAD_DATA and UNKNOWN included. None when nothing has arrived, and at the end
        of a log.
        """

    def recv_match(
        self,
        condition: str | None = None,
        type: str | Iterable[str] | None = None,
        blocking: bool = False,
        timeout: float | None = None,
    ) -> ReceivedMessage | None:
        """The next message of a `type` (name, list or set) for which `condition` holds.

        Messages that do not match are consumed, but have updated the state. Returns None when
        nothing is there, or when blocking, after `timeout` seconds. An indexed log is read only where
        messages of the wanted types, heartbeats and parameters are.
        """

    def _drop_partial(self) -> None:
        """Forget a frame whose rest will not come: the peer is gone."""

    def _fix_home(self, sysid: int) -> None:
        """The home position of a system is known for good."""

def peer_to_replace(host: str, peers: list[tuple[str, bool, float]]) -> int | None:
    """The position of the peer that a full link replaces by a new one from `host`; None if all peers stay. A peer is given
    as its host, whether it has sent a message to a system, and the seconds since its last message.
    """

def receive_batch(link: LiveLink, messages: list[Any], limit: int) -> bool:
    """Append to `messages` what `link` has received, `limit` at most; whether there may be more.

    An error is raised with the messages before it in the list. Where a read took everything the
    socket held, no other read is tried: whoever watches the descriptor is told what comes next.
    """

@disjoint_base
class LiveLink(Link):
    """A link over a socket, a serial port or a pipe: the live links of `mavutil` derive from it."""

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Self: ...
    @property
    def peers_forgotten(self) -> int:
        """Peers that had to make room for others."""
    def _raise_read_error(self) -> None:
        """Raises the error with which reading the connection natively ended; the system does not say it again."""
    _writer: StreamWriter
    """The writer of a stream link."""

    @property
    def _has_unsent(self) -> bool:
        """Bytes wait to be sent, so that receiving has to go through Python, which sends them."""

    def _end_connection(self, port: Any, fd: int | None) -> bool:
        """Closes the connection `port`, and waits on `fd` from then on. Bytes that wait to be sent and the
        start of a frame are dropped. False if that was done before."""

    def _read_stream(self, serves_one: bool = False) -> None:
        """From now on `port` may be read natively, as a stream. Servers for one client at a time look
        after it while nothing arrives."""

    def _read_datagrams(self, own: tuple[Any, ...] | None = None) -> None:
        """From now on `port` may be read natively, as datagrams; those from `own` are left out."""

    @property
    def _has_read_ahead(self) -> bool:
        """Whether data that was read ahead is buffered. The descriptor does not show such data."""

    def _take_datagram(self) -> tuple[bytes, tuple[Any, ...]] | None:
        """A datagram that was read ahead, or the rest of one, with its sender."""

    def _switch_peer(self, address: Any) -> None:
        """The next bytes come from `address`: bytes of another peer's frame are put aside."""

def replace_function(name: str, value: Any) -> None:
    """Makes links use a replacement of `mavutil.time` or `mavutil.add_message`; None restores the
    original. ValueError for another name.
    """

def forget_states() -> None:
    """Makes every link look its systems' states up again: somebody replaced one."""

def instance_dict(object: Any) -> dict[str, Any]:
    """The instance's own dictionary, for classes that show a `__dict__` of their own making."""

def recordable(frame: bytes | bytearray) -> bytes | bytearray:
    """`frame` as a telemetry log may hold it: without signature, without a secret key.

    The same object where it has neither, or is no whole frame.
    """
