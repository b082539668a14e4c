"""How long Ctrl-C takes to end a blocking receive on one transport, in a process of its own.

`interrupt_worker.py PACKAGE KIND` prints the longest of ten times, as JSON. Half of the signals come
early in the wait, when a call has just begun, and half some way into it.
"""

from __future__ import annotations

import asyncio
import importlib
import json
import os
import signal
import socket
import stat
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

TRIES = 10


def opened(package: str, kind: str, folder: Path) -> tuple[Any, Any]:
    """A link on which nothing arrives, and what has to be kept for it to stay so."""
    mavutil = importlib.import_module(f"{package}.mavutil")
    connect: Callable[..., Any] = mavutil.mavlink_connection
    if kind == "mcast":
        return connect("mcast:"), None
    if kind in ("udpin", "tcpin", "wsserver"):
        return connect(f"{kind}:127.0.0.1:0"), None
    if kind in ("udpout", "udpbcast"):
        return connect(f"{kind}:127.0.0.1:9"), None
    if kind == "serial":
        ends = os.openpty()
        return connect(os.ttyname(ends[1])), ends
    if kind == "exec":
        program = folder / "silent"
        program.write_text("#!/bin/sh\ncat > /dev/null\n")  # ends with its input
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        return connect(f"exec:{program}"), None
    if kind == "uds":
        server = socket.socket(socket.AF_UNIX)
        server.bind(str(folder / "socket"))
        server.listen()
        return connect(f"uds:{folder}/socket"), server
    server = socket.create_server(("127.0.0.1", 0))
    address = f"127.0.0.1:{server.getsockname()[1]}"
    if kind == "ws":
        threading.Thread(target=shake_hands, args=[server], daemon=True).start()
        return connect(f"ws:{address}"), server
    link = connect(f"tcp:{address}", autoreconnect=kind == "reconnecting")
    if kind == "reconnecting":
        server.accept()[0].close()
        server.close()
    return link, server


def shake_hands(server: socket.socket) -> None:
    """The server's half of a WebSocket's beginning, and nothing more."""
    import wsproto

    port, _ = server.accept()
    ws = wsproto.WSConnection(wsproto.ConnectionType.SERVER)
    ws.receive_data(port.recv(65536))
    port.sendall(ws.send(wsproto.events.AcceptConnection()))
    time.sleep(3600)


def timed(receive: Callable[[], object], after: float) -> float:
    """Seconds from a signal, `after` seconds into `receive()`, to the exception that ends it."""
    sent = [0.0]

    def interrupt() -> None:
        time.sleep(after)
        sent[0] = time.perf_counter()
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    try:
        receive()
        time.sleep(60)  # it came back by itself
    except KeyboardInterrupt:
        return time.perf_counter() - sent[0]
    raise AssertionError("no signal arrived")


def once(package: str, kind: str, folder: Path, after: float) -> float:
    """The time of a call that waits for a message that never comes."""
    root, _, aio = package.partition(".")
    link, kept = opened(root, kind, folder)
    if not aio:
        seconds = timed(lambda: link.recv_match(blocking=True), after)
    else:

        async def wait() -> None:
            loop_link = importlib.import_module(package).Link(link)
            await loop_link.recv_match()

        seconds = timed(lambda: asyncio.run(wait()), after)
    link.close()
    del kept
    return seconds


def main(package: str, kind: str) -> None:
    longest = 0.0
    for n in range(TRIES):
        with tempfile.TemporaryDirectory() as folder:
            after = (0.03 if n % 2 else 0.3) + 0.013 * n
            longest = max(longest, once(package, kind, Path(folder), after))
    os.write(1, json.dumps({"seconds": longest}).encode())


if __name__ == "__main__":
    main(*sys.argv[1:])
    os._exit(0)  # threads may still be waiting
