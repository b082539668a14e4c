"""`mavfile`, the base of every link: bytes in, messages out, and the state they leave behind.

A transport provides `recv`, `write` and `close`. The native base class `Link` receives and keeps the
state that every message changes; everything else is here or in the mixins.
"""

from __future__ import annotations

import errno
import os
import time
from io import FileIO
from time import monotonic

from mavwire._native import Link, MAVLink, instance_dict, recordable

from . import state, warn
from .commands import Commands
from .conditions import evaluate_condition
from .readiness import wait_readable
from .signing import Signing
from .tracking import Tracking
from .vehicle_state import SystemStates, mavfile_state, param_state

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import IO, Any, Self

    from mavwire._stubs.mavutil import CurrentMAVLink, ReceivedMessage

MARKERS = (0xFE, 0xFD)
MARKER_V2 = 0xFD
# How long a blocking receive without timeout waits between two calls of the idle hooks.
IDLE_INTERVAL = 0.05
# How long a wait goes without looking whether the link was closed, in seconds.
WAIT_SLICE = 0.25

# The attributes that a link's MAVLink object keeps when the dialect module under it changes.
_KEPT_BY_MAV = (
    "seq", "file", "callback", "callback_args", "callback_kwargs",
    "send_callback", "send_callback_args", "send_callback_kwargs",
    "robust_parsing", "signing", "startup_time",
    "total_packets_sent", "total_bytes_sent",
    "total_packets_received", "total_bytes_received", "total_receive_errors",
)  # fmt: skip


# The names that `vars(link)` shows, in pymavlink's order. The native base class keeps some of the values.
_ATTRIBUTES = (
    "fd", "sysid", "param_sysid", "address", "timestamp", "last_seq", "mav_loss", "mav_count",
    "param_fetch_start", "sysid_state", "param_state", "source_system", "source_component",
    "first_byte", "robust_parsing", "mav", "logfile", "logfile_raw", "start_time",
    "message_hooks", "idle_hooks", "uptime", "notimestamps", "_timestamp",
    "WIRE_PROTOCOL_VERSION", "stop_on_EOF", "portdead",
)  # fmt: skip
# Where attributes that are properties keep their values.
_HIDDEN = ("_sysid", "_data_map")


def _attributes(link: mavfile) -> dict[str, Any]:
    shown = (*_ATTRIBUTES, *link._own_attributes)
    own = instance_dict(link).copy()  # other threads add attributes
    first = {name: own[name] for name in own if name not in shown and name not in _HIDDEN}
    return first | {name: getattr(link, name) for name in shown if hasattr(link, name)}


# The dictionary of `vars(link)`. A class with a native base beside mavfile gets a `__dict__` of Python's,
# unless it says that this is its own.
link_dict = property(_attributes)


class mavfile(Link, Tracking, Commands, Signing):
    """One link. `fd` is a descriptor to wait on, or None; `address` names the other end."""

    __dict__ = link_dict
    # Further names for `vars()`, of attributes that stand in no instance dictionary.
    _own_attributes: tuple[str, ...] = ()

    # Bytes of whole frames that `send_many` gives to one `write`; 0 for one frame.
    batch_bytes = 0

    # Recording failures are counted, not raised. Class attributes, so that `vars()` of a link
    # shows pymavlink's attributes alone until something fails.
    logfile_errors = 0

    def __init__(
        self,
        fd: int | None,
        address: str | None,
        source_system: int = 255,
        source_component: int = 0,
        notimestamps: bool = False,
        input: bool = True,
        use_native: bool = False,
    ) -> None:
        self.fd = fd
        self.sysid = 0
        self.param_sysid = (0, 0)
        self.address = address
        self.timestamp: float = 0
        self.param_fetch_start: float = 0
        self.sysid_state = SystemStates({0: mavfile_state()})
        self.param_state = {(0, 0): param_state()}
        self.source_system = source_system
        self.source_component = source_component
        self.robust_parsing = True
        self.mav = self._new_mav()
        self.mav.robust_parsing = self.robust_parsing
        self.logfile: IO[bytes] | None = None
        self.logfile_raw: IO[bytes] | None = None
        self.start_time = time.time()
        self.message_hooks: list[Callable[[mavfile, ReceivedMessage], object]] = []
        self.idle_hooks: list[Callable[[mavfile], object]] = []
        self.uptime = 0.0
        self.notimestamps = notimestamps
        self._timestamp: float | None = None
        self.WIRE_PROTOCOL_VERSION: str = state.dialect_of_new_links().WIRE_PROTOCOL_VERSION
        self.stop_on_EOF = False
        self.portdead = False
        if input:
            state.mavfile_global = self

    # -- the parser object

    def _new_mav(self) -> CurrentMAVLink:
        mav: CurrentMAVLink = state.dialect_of_new_links().MAVLink(
            self, srcSystem=self.source_system, srcComponent=self.source_component
        )
        return mav

    def _replace_mav(self) -> bytes:
        """A parser of the current dialect in place of the old one, which hands over its state.

        Returns the bytes that the old parser had not consumed.
        """
        old, new = self.mav, self._new_mav()
        new.srcSystem, new.srcComponent = old.srcSystem, old.srcComponent
        for name in _KEPT_BY_MAV:
            setattr(new, name, getattr(old, name))
        if isinstance(old, MAVLink):
            new.resync = old.resync
            new._share_sending(old)
        unread = bytes(old.buf[old.buf_index :]) if old.buf_len() else b""
        # The user may have set the counter back in the meantime.
        new.total_bytes_received = max(new.total_bytes_received - len(unread), 0)
        self.mav = new  # last, since other threads send with it from now on
        return unread

    def auto_mavlink_version(self, buf: bytes) -> bytes:
        """Look at the first byte of a link: a v2 marker on a v1 link switches it to MAVLink 2.

        Anything but a marker is ignored, and the next chunk is looked at instead. Returns the
        bytes of earlier chunks that still have to be parsed, nearly always none.
        """
        if not buf or buf[0] not in MARKERS:
            return b""
        self.first_byte = False
        if self.WIRE_PROTOCOL_VERSION != "1.0" or buf[0] != MARKER_V2:
            return b""
        state.set_wire_protocol("2.0")
        self.WIRE_PROTOCOL_VERSION = state.mavlink.WIRE_PROTOCOL_VERSION
        return self._replace_mav()

    def mavlink10(self) -> bool:
        """Always True: every dialect reads MAVLink 1."""
        return True

    def mavlink20(self) -> bool:
        """Whether this link sends MAVLink 2."""
        return float(self.WIRE_PROTOCOL_VERSION) >= 2

    # -- receiving

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes; empty when nothing is there. Each transport has its own."""
        raise RuntimeError("no recv() method supplied")

    def write(self, buf: bytes) -> Any:
        """Send one packed message. Each transport has its own."""
        raise RuntimeError("no write() method supplied")

    def send_many(self, messages: Iterable[Any], force_mavlink1: bool = False) -> None:
        """Send messages in order, with one call of the system for many where the transport can.

        A stream or serial port takes all frames side by side, a datagram as many as fit into `batch_bytes`.
        """
        self.mav.send_many(messages, force_mavlink1)

    def close(self) -> None:
        """Release the transport. Each has its own."""
        raise RuntimeError("no close() method supplied")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, exc_type: object, exc_value: object, traceback: object) -> None:
        self.close()

    def pre_message(self) -> None:
        """Called before each message is read; log readers take the timestamp here."""

    def _recv_by_methods(self) -> ReceivedMessage | None:
        """`recv_msg` by the methods of the link, for a program that replaced or supplied one."""
        self.pre_message()
        while True:
            data = self.recv(self.mav.bytes_needed())
            if data:
                data = self._arrived(data)
            msg: ReceivedMessage | None = self.mav.parse_char(data)
            if msg is not None:
                self._delivered(msg)
                return msg
            if not data:
                return None

    def _arrived(self, data: bytes) -> bytes:
        """Record received bytes and look at the protocol version; returns what to parse."""
        if self.logfile_raw:
            self._log(self.logfile_raw, data)
        if self.first_byte:
            unread = self.auto_mavlink_version(data)
            if unread:
                return unread + data
        return data

    def _delivered(self, msg: ReceivedMessage) -> None:
        """Record a received message and take it into the state."""
        self._record(msg)
        self.post_message(msg)

    def _record(self, msg: ReceivedMessage) -> None:
        """Record a received message, if messages are recorded: big-endian microseconds, low two bits
        clear, and the frame without secrets.
        """
        if self.logfile and msg.get_type() != "BAD_DATA":
            stamp = int(time.time() * 1.0e6) & ~3
            self._log(self.logfile, stamp.to_bytes(8, "big") + recordable(msg.get_msgbuf()))

    def _log(self, file: IO[bytes], data: bytes) -> None:
        """Write to a log; a failing log never stops reception."""
        try:
            written = file.write(data)
            if type(file) is FileIO and written < len(data):  # a full disk: no half a record
                file.truncate(file.seek(-written, os.SEEK_CUR))
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except (OSError, ValueError) as error:
            self._recording_failed(file, error)

    def _recording_failed(self, file: Any, error: Exception) -> None:
        self.logfile_errors += 1
        if self.logfile_errors == 1:
            warn("recording failed: %s", error)

    def setup_logfile(self, logfile: str, mode: str = "wb") -> None:
        """Record received messages to a telemetry log, without signatures and secret keys.

        Each record is handed to the system at once: the end of the program and a fork lose none.
        """
        self.logfile = open(logfile, mode, buffering=0)

    def setup_logfile_raw(self, logfile: str, mode: str = "wb") -> None:
        """Record received bytes exactly as they arrived, secrets included."""
        self.logfile_raw = open(logfile, mode, buffering=0)

    def _matches(self, msg: ReceivedMessage, condition: str | None) -> bool:
        """Whether the sender of `msg` is known, and `condition` holds for its newest messages."""
        sender = self.sysid_state.get(msg.get_srcSystem())
        if sender is None or condition is None:
            return sender is not None
        holds: bool = evaluate_condition(condition, sender.messages)
        return holds

    def _idle(self, timeout: float | None, remaining: float | None) -> None:
        """Run the idle hooks, then wait for data, `remaining` seconds at most."""
        deadline = None if remaining is None else monotonic() + remaining
        for hook in self.idle_hooks:
            hook(self)
        if timeout is None or deadline is None:
            self.select(IDLE_INTERVAL)
        else:
            self.select(max(min(timeout / 2, deadline - monotonic()), 0.0))

    def select(self, timeout: float) -> bool:
        """Whether data may be there within `timeout` seconds; False where the link is closed meanwhile.
        Without a descriptor, sleep half a second at most; with one that cannot be watched, a quarter."""
        fd = self.fd
        if fd is None:
            time.sleep(min(timeout, 0.5))
            return True
        deadline = monotonic() + timeout
        try:
            while not wait_readable(fd, min(timeout, WAIT_SLICE)):
                timeout = deadline - monotonic()
                # Closing a descriptor wakes nobody who waits for it.
                if timeout <= 0 or self.fd != fd:
                    return False
        except TimeoutError:  # of an alarm of the program: waiting itself has no such error
            raise
        except (OSError, ValueError, TypeError):
            time.sleep(max(0.0, min(WAIT_SLICE, timeout)))  # callers come again at once
            return False
        return True

    def set_rtscts(self, enable: Any) -> None:
        """Hardware flow control; only serial ports have it."""
