"""From names of hosts to addresses and connections, in a way that Ctrl-C ends.

The system looks a name up for as long as its servers take to answer, and nothing interrupts it.
"""

from __future__ import annotations

import errno

from . import Any

# How long a wait goes on without a look at signals, in seconds.
WAIT_SLICE = 0.1


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
        socket.inet_aton(host)
    except OSError:
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
            port.settimeout(timeout)
            port.connect(address)
        except OSError as error:
            port.close()
            failure = error
        else:
            return port
    raise failure
