"""What stands between two ends that cannot meet by themselves: cables, servers, encryption."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import ssl
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

CHUNK = 65536


@contextlib.contextmanager
def in_background(work: Any) -> Iterator[None]:
    """`work(stop)` in a thread, until the descriptor `stop` becomes readable."""
    stop_here, stop_there = os.pipe()
    thread = threading.Thread(target=work, args=[stop_here])
    thread.start()
    try:
        yield
    finally:
        os.close(stop_there)
        thread.join()
        os.close(stop_here)


@contextlib.contextmanager
def null_modem() -> Iterator[tuple[str, str]]:
    """Two serial ports that are connected to each other."""
    import tty

    ends = [os.openpty() for _ in range(2)]
    for end in ends:
        for fd in end:
            tty.setraw(fd)
    across = {ends[0][0]: ends[1][0], ends[1][0]: ends[0][0]}

    def pump(stop: int) -> None:
        while stop not in (readable := select.select([*across, stop], [], [])[0]):
            for fd in readable:
                os.write(across[fd], os.read(fd, 4096))

    with in_background(pump):
        yield os.ttyname(ends[0][1]), os.ttyname(ends[1][1])
    for fd in (*ends[0], *ends[1]):
        os.close(fd)


def join(one: socket.socket, other: socket.socket, stop: int) -> None:
    """Pass on what either end sends, until one is closed."""
    across = {one: other, other: one}
    with contextlib.suppress(OSError):
        while stop not in (readable := select.select([*across, stop], [], [])[0]):
            for end in readable:
                data = end.recv(CHUNK)
                while isinstance(end, ssl.SSLSocket) and end.pending():
                    data += end.recv(CHUNK)
                if not data:
                    return
                across[end].sendall(data)


def accepted(listener: socket.socket, stop: int) -> socket.socket | None:
    """The next connection; None when there is to be an end."""
    if stop in select.select([listener, stop], [], [])[0]:
        return None
    return listener.accept()[0]


@contextlib.contextmanager
def unix_server(path: Path) -> Iterator[None]:
    """A Unix domain socket at `path` that connects its first client with its second one."""
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
        listener.listen()

        def serve(stop: int) -> None:
            if (one := accepted(listener, stop)) is None:
                return
            with one:
                if (other := accepted(listener, stop)) is not None:
                    with other:
                        join(one, other, stop)

        with in_background(serve):
            yield


@contextlib.contextmanager
def tls_server(certificate: Path, port: int) -> Iterator[int]:
    """The port of a server that takes the encryption off one connection and passes it on to `port`."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate)
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def serve(stop: int) -> None:
            client = accepted(listener, stop)
            if client is None:
                return
            with (
                context.wrap_socket(client, server_side=True) as plain,
                socket.create_connection(("127.0.0.1", port)) as server,
            ):
                join(plain, server, stop)

        with in_background(serve):
            yield listener.getsockname()[1]
