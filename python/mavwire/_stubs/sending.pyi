"""Classes that live links send with."""

from collections.abc import Callable, Iterable
from typing import Any, final

@final
class Exclusive:
    """A lock that no thread waits for: a thread that does not get it leaves the work to its owner.

    It is taken and released in one call with the work in between, so that the exception of a signal
    handler leaves it free wherever it is raised. A thread that a fork left behind holds nothing.
    """

    def __new__(cls) -> Exclusive: ...
    def run(self, act: Callable[..., Any], *args: Any) -> Any:
        """`act(*args)`; None, with nothing done, while another call has the turn."""

    def locked(self) -> bool:
        """Whether a call has the turn."""

@final
class StreamWriter:
    """Outgoing bytes of a non-blocking stream socket, from any number of threads.

    One thread sends at a time and takes along what others put into the queue meanwhile. Nobody
    waits for it, so that a signal handler that writes in the middle of a write is no deadlock. No
    handler runs between the return of a native `port.send` and the moment when what it sent leaves
    the queue.
    """

    dropped_frames: int
    """Frames that were not sent."""

    def __new__(cls, max_unsent: int = ...) -> StreamWriter: ...
    @property
    def unsent(self) -> bytes:
        """The bytes that wait in the queue (a copy)."""

    @property
    def bytes_sent(self) -> int:
        """Bytes that a port has taken."""

    def write(self, port: Any, frame: bytes | bytearray | Iterable[int]) -> None:
        """Sends `frame` after what is queued; OSError when the connection is gone, and then `clear` counts
        the frame."""

    def flush(self, port: Any) -> None:
        """Sends as much of the queue as the peer takes now."""

    def clear(self) -> None:
        """Drops and counts what is queued: the connection it was meant for is gone."""

@final
class DescriptorPort:
    """A file, pipe or serial port of this system to use as a socket: it takes what there is room for."""

    def __new__(cls, file: Any) -> DescriptorPort: ...
    def send(self, data: bytes) -> int:
        """How many of the bytes it took."""

    def recv(self, n: int) -> bytes:
        """Up to `n` bytes."""

@final
class TlsPort:
    """A TLS connection as the non-blocking socket that links read and write. Waiting for the peer is no error
    of its own kind, and several threads may use it, which OpenSSL does not allow."""

    def __new__(cls, port: Any) -> TlsPort: ...
    def recv(self, n: int) -> bytes:
        """Up to `n` bytes."""

    def send(self, data: bytes) -> int:
        """How many of the bytes it took."""

    def fileno(self) -> int: ...
    def close(self) -> None: ...
    def setblocking(self, flag: bool) -> None: ...
