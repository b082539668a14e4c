"""Serial links. pyserial does the work, and `port` is its object: users reach into it."""

from __future__ import annotations

import errno
from time import monotonic

from mavwire._native import Exclusive

from . import Any
from .chunked import READ_SIZE
from .helpers import FakeSerial
from .readiness import wait_writable
from .recognise import mode_of
from .reconnecting import RetryingLink
from .stream import DescriptorPort, StreamWriter, receive
from .waiting import set_close_on_exec

# Opening at this rate first makes a change of rate take effect on adapters that ignore
# setting the rate they believe they already have.
OPENING_BAUD = 1200
# A port that takes nothing for this long, in seconds, is not waited for until it takes something.
WRITE_TIMEOUT = 0.5
# Bytes kept for it then: what comes first when it is read again is old.
MAX_UNSENT = 1 << 14


def _rate(baud: Any) -> int | None:
    """A baud rate as a number; None for what is none."""
    try:
        rate = int(baud)
    except (TypeError, ValueError, OverflowError):
        return None
    return rate if rate >= 0 else None


def _not_a_rate(baud: Any, device: str) -> str:
    return f"the baud rate {baud!r} of the serial port {device} is not a number"


def _close(port: Any) -> None:
    """Close a port, which may be gone already."""
    from contextlib import suppress

    with suppress(OSError):
        port.close()


def _is_plain(port: Any) -> bool:
    """Whether writing to the descriptor of `port` is all that writing to it does."""
    return type(port).__module__ == "serial.serialposix"


class mavserial(RetryingLink):
    """`device` is a port name, or `name,baud` where no such file exists. With `autoreconnect` a port that was
    unplugged is opened again, every `reconnect_delay` seconds at most."""

    _aio_transport = "SerialPort"
    # The port took nothing for WRITE_TIMEOUT.
    _is_stuck = False

    def __init__(
        self,
        device: str,
        baud: int = 115200,
        autoreconnect: bool = False,
        source_system: int = 255,
        source_component: int = 0,
        use_native: bool = False,
        force_connected: bool = False,
        reconnect_delay: float = 1,
    ) -> None:
        if "," in device and not mode_of(device):
            device, baud = device.rsplit(",", 1)  # type: ignore[assignment]
            if _rate(baud) is None:  # before a port is opened for nothing
                raise ValueError(_not_a_rate(baud, device))
        self.baud = baud
        self.device = device
        self.autoreconnect = autoreconnect
        self.reconnect_delay = reconnect_delay
        self.force_connected = force_connected
        self.rtscts = False
        self._next_reset = 0.0
        self._opening = Exclusive()
        self._writer = StreamWriter(MAX_UNSENT)
        self.port: Any = self._open()
        super().__init__(
            self._descriptor(self.port), device, source_system=source_system,
            source_component=source_component, use_native=use_native,
        )  # fmt: skip
        try:
            self.set_baudrate(self.baud)
        except BaseException:
            self._release()
            raise
        self._read_stream()

    def _open(self) -> Any:
        import serial

        try:
            return self._open_at(OPENING_BAUD)
        except serial.SerialException:
            if self.force_connected:
                return FakeSerial()
            raise

    def _open_at(self, baud: int) -> Any:
        """The port, opened; SerialException otherwise."""
        import serial

        try:
            return serial.Serial(
                self.device, baud, timeout=0, dsrdtr=False, rtscts=self.rtscts, xonxoff=False
            )
        except Exception as error:
            # It was unplugged while it was set up, or the rate is no number of the system's, which pyserial does not tell
            # in its own words.
            if type(error).__module__ != "termios" and not isinstance(error, OverflowError):
                raise
            raise serial.SerialException(*error.args) from None

    @staticmethod
    def _descriptor(port: Any) -> int | None:
        """The port's descriptor to wait on; None where there is none (Windows, FakeSerial)."""
        try:
            fd: int = port.fileno()
        except (AttributeError, OSError, ValueError):
            return None
        set_close_on_exec(fd)
        return fd

    def set_rtscts(self, enable: Any) -> None:
        """Switch hardware flow control."""
        self.rtscts = enable
        self.port.rtscts = enable

    def set_baudrate(self, baudrate: int) -> None:
        """Change the rate; a port that refuses it says so in pyserial's words."""
        self.port.baudrate = baudrate if isinstance(self.port, FakeSerial) else int(baudrate)

    def close(self) -> None:
        """Close the port for good."""
        self.autoreconnect = False
        super().close()

    def _release(self) -> None:
        self.fd = None  # its number may be somebody else's next
        _close(self.port)
        self._forget_unsent()

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes of what has arrived.

        With `autoreconnect` a port that was unplugged is opened again once it is back; without,
        pyserial's errors propagate.
        """
        self._check_open()
        port = self.port
        if isinstance(port, FakeSerial) or (self.autoreconnect and not port.is_open):
            self._maybe_reset()
            return b""
        try:
            data = self._read(port, READ_SIZE if n is None else n)
        except OSError:  # SerialException is one
            if self.autoreconnect:
                self._lost(port)
                return b""
            data = port.read(n or READ_SIZE)  # which says it in pyserial's words
        if data:
            self.portdead = False
        return data

    def _read(self, port: Any, n: int) -> bytes:
        if _is_plain(port):
            line = DescriptorPort(port)
            self._send_rest(line)
            return receive(line, n) or b""
        if self.fd is None:
            # Without a descriptor nothing can wait, and reading more than there is would.
            n = min(n, port.in_waiting)
        data: bytes = port.read(n)
        return data

    def _lost(self, port: Any) -> None:
        """The `port` was unplugged: nothing to read, wait for or finish any more."""
        if port is self.port:  # or another thread has opened the next one
            self._say_dead()
            self._opening.run(self._shut, port)
            self._maybe_reset()

    def _shut(self, port: Any) -> None:
        """Close `port`, unless another thread has opened the next one."""
        if port is not self.port:
            return
        self.fd = None
        _close(port)
        self._forget_unsent()
        self._drop_partial()

    def _say_dead(self) -> None:
        if not self.portdead:
            self._say(f"Device {self.device} is dead")
        self.portdead = True

    def _say(self, text: str) -> None:
        print(text)

    def write(self, buf: bytes) -> Any:
        """Send one frame whole, or drop it whole when nobody reads: the bytes taken. -1 when the port is dead, which
        is printed once, or closed."""
        if self._closed:
            self._writer.dropped_frames += 1
            return -1
        port = self.port
        try:
            return self._write(port, bytes(buf)) if _is_plain(port) else port.write(bytes(buf))
        except Exception as error:
            if not _is_plain(port):
                # Drivers raise errors of their own. The port is unusable after any of them.
                self._writer.dropped_frames += 1
            elif isinstance(error, OSError):
                self._opening.run(self._forget_of, port)
            else:
                raise
        if port is self.port and not self._closed:  # meanwhile
            self._say_dead()
            self._maybe_reset()
        return -1

    def _forget_of(self, port: Any) -> None:
        """Forget what is queued, unless another thread has opened the next port."""
        if port is self.port:
            self._forget_unsent()

    def _write(self, port: Any, frame: bytes) -> int:
        """Send or queue a frame."""
        line, sent = DescriptorPort(port), self._writer.bytes_sent
        dropped = self._writer.dropped_frames
        self._send_frame(line, frame)
        if self._writer.dropped_frames != dropped:
            return 0
        if self._writer.bytes_sent != sent:
            self._is_stuck = False
        if self._writer.unsent and not self._is_stuck:
            self._send_all(line, port)
        return len(frame)

    def _send_all(self, line: DescriptorPort, port: Any) -> None:
        """Send what is queued as long as the port takes something: who is faster than the line is slowed down."""
        while self._writer.unsent and not self._is_stuck:
            sent = self._writer.bytes_sent
            wait_writable(port.fileno(), WRITE_TIMEOUT)
            self._send_rest(line)
            self._is_stuck = self._writer.bytes_sent == sent

    def _maybe_reset(self) -> None:
        """Reopen a dead port if asked to and if the last time is long enough ago."""
        if self.autoreconnect:
            self._reset(only_when_due=True)

    def reset(self) -> bool:
        """Reopen the port; whether that worked. False at once while another thread is at it."""
        return self._reset(only_when_due=False)

    def _reset(self, only_when_due: bool) -> bool:
        return not self._closed and bool(self._opening.run(self._reopen, only_when_due))

    def _reopen(self, only_when_due: bool) -> bool:
        if only_when_due and monotonic() < self._next_reset:
            return False
        self._next_reset = monotonic() + self.reconnect_delay
        baud = _rate(self.baud)
        if baud is None:
            self._note_failure(OSError(errno.EINVAL, _not_a_rate(self.baud, self.device)))
            return False
        try:
            port = self._open_at(baud)
        except OSError as error:  # SerialException is one
            self._note_failure(error)
            return False
        self._note_success()
        _close(self.port)  # it is gone, which is why it is replaced
        self._forget_unsent()
        self._drop_partial()
        self.portdead = False
        self.port, self.fd = port, self._descriptor(port)
        if self._closed:  # meanwhile
            self._release()
            return False
        self._say(f"Device {self.device} reopened OK")
        return True
