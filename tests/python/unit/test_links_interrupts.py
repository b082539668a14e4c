"""Signal handlers that raise, as Ctrl-C does in a REPL: what they interrupt stays usable, and frames stay whole."""

from __future__ import annotations

import os
import random
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from mavwire import mavutil
from mavwire._native import DescriptorPort, Section, StreamWriter, TlsPort, Turn
from unit.link_tools import heartbeat
from watchdog import watched

WAIT = 60.0
FRAME = 10
INTERRUPTS = 300

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers")


class Stop(Exception):
    """What the handler raises."""


@pytest.fixture
def interrupted() -> Iterator[Callable[[Callable[[], object]], None]]:
    """Runs something over and over, and interrupts it many times."""
    armed = False

    def handle(*_: object) -> None:
        if armed:
            raise Stop

    def run(act: Callable[[], object]) -> None:
        nonlocal armed
        for _ in range(INTERRUPTS):
            try:
                armed = True
                signal.setitimer(signal.ITIMER_REAL, random.uniform(20e-6, 200e-6))
                while True:
                    act()
            except Stop:
                armed = False

    before = signal.signal(signal.SIGALRM, handle)
    yield run
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, before)


class Reader:
    """Takes what is sent in small pieces, so that frames are often sent in part."""

    def __init__(self, fd: int) -> None:
        self.data = bytearray()
        self._fd = fd
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def _read(self) -> None:
        while piece := os.read(self._fd, 4097):
            self.data += piece

    def end(self) -> bytes:
        self._thread.join(WAIT)
        return bytes(self.data)


def assert_whole(data: bytes, last: int) -> None:
    """Frames were numbered upwards; one whose sending was interrupted may be missing, and none comes twice."""
    assert len(data) % FRAME == 0
    numbers = [int.from_bytes(data[at : at + FRAME], "big") for at in range(0, len(data), FRAME)]
    assert numbers == sorted(set(numbers))
    assert numbers[-1] == last


def send_all(writer: StreamWriter, port: Any) -> None:
    with watched(WAIT):
        while writer.unsent:
            writer.flush(port)


@pytest.mark.parametrize("kind", ["socket", "pipe"])
def test_frames_stay_whole_whatever_is_interrupted(kind: str, interrupted: Any) -> None:
    if kind == "socket":
        end, out = socket.socketpair()
        out.setblocking(False)
        port: Any = out
    else:
        ends = os.pipe()
        os.set_blocking(ends[1], False)
        end, out = (
            os.fdopen(fd, mode, buffering=0) for fd, mode in zip(ends, ("rb", "wb"), strict=True)
        )
        port = DescriptorPort(out)
    reader, writer, number = Reader(end.fileno()), StreamWriter(1 << 30), 0

    def write() -> None:
        nonlocal number
        number += 1
        writer.write(port, number.to_bytes(FRAME, "big"))

    interrupted(write)
    number += 1
    writer.write(port, number.to_bytes(FRAME, "big"))
    send_all(writer, port)
    out.close()
    data = reader.end()
    end.close()
    assert writer.bytes_sent == len(data)
    assert_whole(data, number)


def test_a_link_goes_on_after_interrupts(interrupted: Any) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        peer = server.accept()[0]
        reader = Reader(peer.fileno())
        interrupted(lambda: link.write(heartbeat()))
        link.write(heartbeat(7))
        send_all(link._writer, link.port)
        link.close()
        data = reader.end()
        peer.close()
    assert len(data) % len(heartbeat()) == 0
    assert data.endswith(heartbeat(7))
    assert link.frames_dropped == 0


def test_turns_and_sections_are_free_after_interrupts(interrupted: Any) -> None:
    turn, section = Turn(), Section()
    interrupted(lambda: turn.run(int))
    assert not turn.locked()
    interrupted(lambda: section.run(int))
    thread = threading.Thread(target=section.run, args=[int])
    thread.start()
    thread.join(WAIT)
    assert not thread.is_alive()


def test_a_turn_is_had_by_one() -> None:
    turn = Turn()
    assert turn.run(lambda: (turn.run(int), turn.locked())) == (None, True)
    assert turn.run(divmod, 7, 2) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        turn.run(lambda: 1 // 0)
    assert not turn.locked()


def test_a_turn_may_be_a_threads_own() -> None:
    turn, go, done = Turn(), threading.Event(), threading.Event()
    started = []

    def start(function: Any, arguments: Any) -> None:
        started.append(threading.Thread(target=function, args=arguments))
        started[-1].start()

    def refuse(function: Any, arguments: Any) -> None:
        raise RuntimeError

    assert not turn.start(start, bool, done.set)
    assert not turn.locked()
    with pytest.raises(RuntimeError):
        turn.start(refuse, lambda: True, done.set)
    assert not turn.locked()
    assert turn.start(start, lambda: True, lambda: go.wait(WAIT) and done.set())
    assert turn.locked()
    assert not turn.start(start, lambda: True, done.set)
    assert turn.run(int) is None
    go.set()
    started[-1].join(WAIT)
    assert (done.is_set(), turn.locked(), len(started)) == (True, False, 1)


class Interrupted:
    """A TLS socket inside of which a signal handler raises."""

    def send(self, data: bytes) -> int:
        raise Stop

    def recv(self, n: int) -> bytes:
        return bytes(n)


def test_a_tls_connection_is_not_gone_on_with_if_nobody_knows_what_was_sent() -> None:
    writer, port = StreamWriter(), TlsPort(Interrupted())
    assert port.recv(3) == bytes(3)
    with pytest.raises(Stop):
        writer.write(port, bytes(FRAME))
    for act in (writer.flush, lambda port: port.recv(3)):
        with pytest.raises(ConnectionAbortedError, match="signal"):
            act(port)
