"""What the figures share."""

from __future__ import annotations

import importlib
import os
import signal
import socket
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

KEY = bytes(range(32))
T0 = 1_600_000_000_000_000


def mavutil_of(package: str) -> Any:
    """mavutil of a package, for version 2 and the dialect `common`."""
    os.environ["MAVLINK20"] = "1"
    os.environ["MAVLINK_DIALECT"] = "common"
    return importlib.import_module(f"{package}.mavutil")


def dialect_of(package: str) -> Any:
    return importlib.import_module(f"{package}.dialects.v20.common")


def parser_of(package: str, resync: str = "skip") -> Any:
    """A robust parser; the policy is one that only mavwire has."""
    mav = dialect_of(package).MAVLink(None, 255, 190)
    mav.robust_parsing = True
    if resync != "skip" and package == "mavwire":
        mav.resync = resync
    return mav


def parse(mav: Any, stream: bytes, chunk: int = 65536) -> Iterator[Any]:
    for start in range(0, len(stream), chunk):
        yield from mav.parse_buffer(bytearray(stream[start : start + chunk])) or []


def capture_of(package: str) -> Any:
    """A link that receives what is put into `rx` and sends nothing."""

    class Capture(mavutil_of(package).mavfile):  # type: ignore[misc]
        def __init__(self) -> None:
            self.rx = bytearray()
            super().__init__(None, "capture")

        def recv(self, n: int | None = None) -> bytes:
            n = len(self.rx) if n is None else n
            data = bytes(self.rx[:n])
            del self.rx[:n]
            return data

        def write(self, buf: bytes) -> None:
            pass

    return Capture()


def drain(link: Any) -> list[Any]:
    """Every message that is there now."""
    return list(iter(link.recv_msg, None))


def good(messages: Iterable[Any]) -> int:
    """How many of them came of good frames."""
    return sum(msg.get_type() != "BAD_DATA" for msg in messages)


def feed(link: Any, frames: Iterator[bytes]) -> int:
    """Through a link in portions, its messages thrown away; how many good ones there were."""
    waiting, came = bytearray(), 0
    for frame in frames:
        waiting += frame
        if len(waiting) > 4096:
            link.rx += waiting
            waiting.clear()
            came += good(drain(link))
    link.rx += waiting
    return came + good(drain(link))


def memory() -> int:
    """Bytes of this process that are in memory."""
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGESIZE")


@contextmanager
def alarm(seconds: float) -> Iterator[None]:
    """TimeoutError in what takes longer."""

    def ring(_signal: int, _frame: FrameType | None) -> None:
        raise TimeoutError

    signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


@contextmanager
def silence() -> Iterator[list[int]]:
    """Nothing is printed; how many lines it would have been is in the list afterwards."""
    lines = [0]

    class Counter:
        def write(self, text: str) -> int:
            lines[0] += text.count("\n")
            return len(text)

        def flush(self) -> None:
            pass

    before = sys.stdout, sys.stderr
    sys.stdout = sys.stderr = Counter()
    try:
        yield lines
    finally:
        sys.stdout, sys.stderr = before


def until(condition: Callable[[], Any], seconds: float = 30) -> bool:
    """Whether it came to be."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


def udp_server(package: str) -> tuple[Any, tuple[str, int]]:
    """A `udpin:` link and its address."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        address = probe.getsockname()
    link = mavutil_of(package).mavlink_connection(f"udpin:127.0.0.1:{address[1]}")
    return link, address


def datagrams() -> socket.socket:
    return socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
