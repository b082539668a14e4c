"""A serial port of the vehicle, used from here: bytes tunnelled in SERIAL_CONTROL messages."""

from __future__ import annotations

import time
from time import monotonic

from . import Any, state

# SERIAL_CONTROL carries at most this many bytes.
CHUNK = 70
SERIAL_CONTROL_FLAG_RESPOND = 2
SERIAL_CONTROL_FLAG_EXCLUSIVE = 4
# How long `read` waits for one reply before it asks the vehicle for more.
REPLY_TIMEOUT = 0.03
SEND_INTERVAL = 0.05


class MavlinkSerialPort:
    """A serial-like object over a MAVLink connection to `portname`.

    `devnum` is the SERIAL_CONTROL device, `devbaud` its rate (0: leave it), `timeout` the
    seconds that `read` waits, `debug` the level up to which messages are printed.
    """

    def __init__(
        self,
        portname: str,
        baudrate: int,
        devnum: int = 0,
        devbaud: int = 0,
        timeout: float = 3,
        debug: int = 0,
    ) -> None:
        self.baudrate = 0
        self.timeout = timeout
        self._debug = debug
        self.buf = b""
        self.port = devnum
        self.debug(f"Connecting with MAVLink to {portname} ...")
        self.mav: Any = state.public.mavlink_connection(portname, autoreconnect=True, baud=baudrate)
        self.mav.wait_heartbeat()
        self.debug("HEARTBEAT OK\n")
        if devbaud != 0:
            self.setBaudrate(devbaud)
        self.debug("Locked serial device\n")

    def debug(self, s: str, level: int = 1) -> None:
        """Print `s` if the debug level asks for it."""
        if self._debug >= level:
            print(s)

    def _control(self, timeout_ms: int, baudrate: int, data: bytes) -> None:
        flags = SERIAL_CONTROL_FLAG_EXCLUSIVE | SERIAL_CONTROL_FLAG_RESPOND
        padded = list(data.ljust(CHUNK, b"\0"))
        self.mav.mav.serial_control_send(self.port, flags, timeout_ms, baudrate, len(data), padded)

    def write(self, b: bytes) -> None:
        """Send bytes to the remote port."""
        self.debug(f"sending {b!r} of len {len(b)}\n", 2)
        for start in range(0, len(b), CHUNK):
            self._control(0, 0, bytes(b[start : start + CHUNK]))

    def _recv(self) -> None:
        """Take one reply, if it comes soon."""
        msg = self.mav.recv_match(
            condition="SERIAL_CONTROL.count!=0",
            type="SERIAL_CONTROL",
            blocking=True,
            timeout=REPLY_TIMEOUT,
        )
        if msg is not None:
            data = bytes(bytearray(msg.data[: msg.count]))
            self.debug(f"received {data!r}", 2)
            self.buf += data

    def read(self, n: int) -> bytearray:
        """Up to `n` bytes, after waiting `timeout` seconds at most for the first."""
        if not self.buf:
            self._recv()
        deadline = monotonic() + self.timeout
        while not self.buf and monotonic() < deadline:
            self._control(0, 0, b"")
            self._recv()
            if not self.buf:
                time.sleep(SEND_INTERVAL)
        data, self.buf = bytearray(self.buf[:n]), self.buf[n:]
        return data

    def flushInput(self) -> None:
        """Forget what was received and not read."""
        self.buf = b""
        self._recv()
        self.buf = b""

    def setBaudrate(self, baudrate: int) -> None:
        """Set the remote port's rate, once."""
        if self.baudrate == baudrate:
            return
        self.baudrate = baudrate
        self._control(0, self.baudrate, b"")
        self.flushInput()
        self.debug(f"Changed baudrate {self.baudrate}")
