"""Links to a child process that speaks MAVLink over its standard input and output."""

from __future__ import annotations

import os

from . import Any
from .chunked import READ_SIZE
from .stream import DescriptorPort, StreamLink, StreamWriter


class mavchildexec(StreamLink):
    """Runs `filename`, which is why `mavlink_connection` wants the `exec:` prefix for it."""

    _aio_transport = "Child"

    def __init__(
        self,
        filename: str,
        source_system: int = 255,
        source_component: int = 0,
        use_native: bool = False,
    ) -> None:
        import subprocess

        if not filename:
            raise ValueError("the program to run must be named: exec:PROGRAM")
        self.filename = filename
        self.child = subprocess.Popen(
            [filename], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
        )
        output = self.child.stdout.fileno()  # type: ignore[union-attr]
        for pipe in (output, self.child.stdin.fileno()):  # type: ignore[union-attr]
            os.set_blocking(pipe, False)
        self._input = DescriptorPort(self.child.stdin)
        self._writer = StreamWriter()
        super().__init__(
            output, filename, source_system=source_system, source_component=source_component
        )
        self._read_stream()

    @property
    def port(self) -> Any:
        """The child's standard output, which is read."""
        return self.child.stdout

    def _release(self) -> None:
        """Ask the child to end, and make it after five seconds, or when somebody interrupts the wait."""
        import subprocess

        self.fd = None
        self.child.terminate()
        try:
            self.child.wait(timeout=5)
        except BaseException as error:
            self.child.kill()
            self.child.wait()
            if not isinstance(error, subprocess.TimeoutExpired):
                raise
        for pipe in (self.child.stdin, self.child.stdout):
            if pipe is not None:
                pipe.close()
        self._forget_unsent()

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes of the child's output; empty when there are none, or no child."""
        if self.fd is None:
            self._check_open()
            return b""
        try:
            self._send_rest(self._input)
        except OSError:  # it takes no more, but what it said last is still to be read
            self._forget_unsent()
        try:
            data: bytes | None = self.port.read(READ_SIZE if n is None else n)
        except (OSError, ValueError):
            self._check_open()  # or another thread has closed it
            raise
        if data is None:
            return b""
        if not data:
            # End of output: nothing to wait on any more.
            self.fd = None
            self.portdead = True
        return data

    def write(self, buf: bytes) -> None:
        """Send one frame whole to the child's input; drop it when the child does not read, or has ended."""
        try:
            self._send_frame(self._input, buf)
        except OSError:
            self._forget_unsent()
