"""From names of hosts to addresses and connections, in a way that Ctrl-C ends.

The system looks a name up for as long as its servers take to answer, and nothing interrupts it.
"""

from __future__ import annotations

import errno
import os
import sys

from mavwire._native import PortError, ask_port, close_port

from . import Any
from .readiness import from_handler, wait_writable

# How long a wait goes on without a look at signals, in seconds.
WAIT_SLICE = 0.1
# The error of a non-blocking socket while it is being connected.
IN_PROGRESS = getattr(errno, "WSAEWOULDBLOCK", errno.EINPROGRESS)


def look_up(host: str, number: int, family: int, kind: int) -> list[Any]:
    """The addresses of `socket.getaddrinfo`, or its error. An empty host is this machine.

    A name is looked up in a thread, which is left to itself if somebody interrupts the wait.
    """
    import socket

    def find() -> list[Any]:
        return list(socket.getaddrinfo(host or "localhost", number, family, kind))

    if not host or is_numeric(host):
        return find()
    from _thread import allocate_lock, start_new_thread

    answers: list[Any] = []
    failures: list[Exception] = []
    answered = allocate_lock()
    answered.acquire()

    def answer() -> None:
        try:
            answers.extend(find())
        except Exception as error:
            failures.append(error)
        finally:
            answered.release()

    try:
        start_new_thread(answer, ())
    except RuntimeError:  # there is none to be had, as at the end of the program
        return find()
    # A signal that comes just before the wait begins is seen when it ends.
    while not answered.acquire(timeout=WAIT_SLICE):
        pass
    if failures:
        raise failures[0]
    return answers


def is_numeric(host: str) -> bool:
    """Whether `host` is an address and no name."""
    import socket

    if ":" in host:
        return True
    try:
        ask_port(socket, "inet_aton", host)
    except PortError:
        return False
    return True


def connect_to(host: str, number: int, timeout: float) -> Any:
    """A TCP socket that is connected to the first address of `host` that answers, each within
    `timeout` seconds; the last error if none does."""
    import socket

    failure = OSError(errno.EADDRNOTAVAIL, f"no address of {host!r} is known")
    for family, kind, protocol, _, address in look_up(host, number, 0, socket.SOCK_STREAM):
        port = socket.socket(family, kind, protocol)
        try:
            connect(port, address, timeout)
        except BaseException as error:
            close_port(port)
            if not isinstance(error, OSError) or from_handler(error):
                raise
            failure = error
        else:
            return port
    raise failure


def connect(port: Any, address: Any, timeout: float) -> None:
    """Connect a socket, which then waits for `timeout` seconds in all it does; an OSError with a number if that fails."""
    import socket

    # Without waiting: by its own time-out, which has no number, nobody could tell what a signal handler raises from it.
    port.setblocking(False)
    failure = port.connect_ex(address)
    if failure == IN_PROGRESS:
        has_answered = wait_writable(port.fileno(), timeout)
        failure = (
            port.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) if has_answered else errno.ETIMEDOUT
        )
    if failure:
        raise OSError(failure, _words(failure))
    port.settimeout(timeout)


def _words(number: int) -> str:
    """The text of the system for an error."""
    if sys.platform == "win32":  # the C library there does not know those of sockets
        import ctypes

        return ctypes.FormatError(number)
    return os.strerror(number)
