"""Signal handlers that raise, as Ctrl-C does in a REPL: what they interrupt stays usable, and frames stay whole."""

from __future__ import annotations

import gc
import os
import random
import signal
import socket
import threading
import tty
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import count, pairwise
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavutil
from mavwire._native import (
    DescriptorPort,
    Exclusive,
    StreamWriter,
    TlsPort,
)
from mavwire.dialects.v20 import all as all_messages
from mavwire.links import signing
from mavwire.links.link_ids import section
from mavwire.links.signing import prepared
from mavwire.links.timestamp_store import TimestampStore
from unit.link_tools import heartbeat
from watchdog import watched

WAIT = 60.0
FRAME = 10
INTERRUPTS = 300

pytestmark = [
    pytest.mark.usefixtures("mavlink20"),
    pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers"),
]


class Stop(Exception):
    """What the handler raises."""


@pytest.fixture
def interrupted() -> Iterator[Callable[[Callable[[], object]], None]]:
    """Runs something over and over, and interrupts it many times."""
    armed = False

    def handle(*_: object) -> None:
        nonlocal armed
        if armed:
            armed = False
            raise Stop

    def run(act: Callable[[], object]) -> None:
        nonlocal armed
        act()
        for _ in range(INTERRUPTS):
            armed = True
            with pytest.raises(Stop):
                signal.setitimer(signal.ITIMER_REAL, random.uniform(20e-6, 200e-6))
                while armed:  # also where the exception is swallowed
                    act()

    # What runs while garbage is collected, such as Hypothesis's callback, loses what is raised in it.
    gc.collect()
    gc.disable()
    before = signal.signal(signal.SIGALRM, handle)
    yield run
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, before)
    gc.enable()


class Reader:
    """Takes what is sent in small pieces, so that frames are often sent in part."""

    def __init__(self, fd: int) -> None:
        self.data = bytearray()
        self._fd = fd
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def _read(self) -> None:
        with suppress(OSError):  # the end of a serial port
            while piece := os.read(self._fd, 4097):
                self.data += piece

    def end(self) -> bytes:
        self._thread.join(WAIT)
        return bytes(self.data)


def follow(frames: list[bytes]) -> bool:
    """Whether sequence numbers do not go back. The number of an interrupted frame may come twice, as in pymavlink."""
    steps = [(after[4] - before[4]) % 256 for before, after in pairwise(frames)]
    return all(0 <= step < 128 for step in steps)


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


def tcp_link() -> tuple[Any, Any]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        return link, server.accept()[0]


def tcpin_link() -> tuple[Any, Any]:
    link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    peer = socket.create_connection(link.listen.getsockname())
    with watched(WAIT):
        while link.port is None:
            link.recv_match(blocking=True, timeout=1.0)
    return link, peer


def serial_link() -> tuple[Any, Any]:
    pytest.importorskip("serial")
    here, there = os.openpty()
    tty.setraw(here)
    tty.setraw(there)
    link = mavutil.mavlink_connection(os.ttyname(there), autoreconnect=True)
    os.close(there)
    return link, os.fdopen(here, "rb", buffering=0)


@pytest.mark.parametrize("make", [tcp_link, tcpin_link, serial_link])
def test_a_link_goes_on_after_interrupts(make: Any, interrupted: Any) -> None:
    link, peer = make()
    port, last = link.port, len(heartbeat())
    reader = Reader(peer.fileno())

    def act() -> None:
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        link.recv_msg()

    interrupted(act)
    link.write(heartbeat(7))
    send_all(link._writer, DescriptorPort(port) if make is serial_link else port)
    assert (link.port, link.portdead, link.frames_dropped) == (port, False, 0)
    link.close()
    data = reader.end()
    peer.close()
    assert data.endswith(heartbeat(7))
    frames = [data[at : at + last] for at in range(0, len(data) - last, last)]
    assert {(frame[0], len(frame)) for frame in frames} <= {(0xFD, last)}
    assert follow(frames)


def test_datagrams_go_on_after_interrupts(interrupted: Any) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 0))
        link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{peer.getsockname()[1]}")
        received = []

        def act() -> None:
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            received.append(peer.recv(1000))

        interrupted(act)
        assert link.write_errors == 0
        link.close()


def test_a_recording_goes_on_after_interrupts(interrupted: Any, tmp_path: Path) -> None:
    link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    link.setup_logfile_raw(str(tmp_path / "log"))
    interrupted(lambda: link._arrived(b"bytes"))
    assert link.logfile_errors == 0
    link.close()


def test_keys_that_go_lose_no_interrupts(interrupted: Any) -> None:
    arguments = prepared(bytes(32), link_id=1)
    interrupted(lambda: signing._set_up(all_messages.MAVLinkSigning(), arguments))


def descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


@pytest.mark.skipif(not os.path.isdir("/proc/self/fd"), reason="counts descriptors")
def test_no_timestamp_store_is_left_open_by_interrupts(interrupted: Any, tmp_path: Path) -> None:
    store, numbers = TimestampStore(tmp_path / "store"), count(1)
    before = descriptors()
    interrupted(lambda: (store.load(), store.save(next(numbers))))
    gc.collect()
    assert descriptors() <= before
    last = next(numbers)
    store.save(last)
    assert store.load() == last


def test_turns_are_free_after_interrupts(interrupted: Any) -> None:
    turn = Exclusive()
    interrupted(lambda: turn.run(int))
    assert not turn.locked()


def test_the_section_is_free_after_interrupts(interrupted: Any) -> None:
    def enter() -> None:
        with section:
            pass

    interrupted(enter)
    thread = threading.Thread(target=enter)
    thread.start()
    thread.join(WAIT)
    assert not thread.is_alive()


@pytest.mark.parametrize("kind", ["udpin", "tcpin", "mcast"])
def test_what_a_handler_raises_while_a_link_is_opened_is_not_lost(
    kind: str, interrupted: Any
) -> None:
    name = "mcast:" if kind == "mcast" else f"{kind}:127.0.0.1:0"
    try:
        mavutil.mavlink_connection(name).close()
    except OSError as error:
        pytest.skip(f"no multicast here: {error}")
    interrupted(lambda: mavutil.mavlink_connection(name).close())


def test_closing_a_log_maps_no_file_that_nobody_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which may fail, or be interrupted, before the log is closed."""

    def interrupted(*_: object, **__: object) -> None:
        raise Stop

    path = tmp_path / "log.tlog"
    path.write_bytes(bytes(8) + heartbeat())
    log = mavutil.mavlink_connection(str(path))
    monkeypatch.setattr("mmap.mmap", interrupted)
    log.close()
    assert log.f.closed


class Alarm(Exception):
    """What a handler raises of no kind of error that ports have."""


class Interrupting:
    """A socket in whose closing a signal handler raises, the first time."""

    def __init__(self, real: socket.socket) -> None:
        self._real, self._raises = real, True

    def close(self) -> None:
        if self._raises:
            self._raises = False
            raise Alarm
        self._real.close()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)


@pytest.mark.parametrize(("device", "first"), [("tcpin:127.0.0.1:0", "listen"), ("mcast:", "port")])
def test_a_link_whose_closing_is_interrupted_is_closed_whole(device: str, first: str) -> None:
    """Nobody closes it again: it says that it is closed, and a `with` block is over."""
    try:
        link = mavutil.mavlink_connection(device)
    except OSError as error:
        pytest.skip(f"no multicast here: {error}")
    peer = None
    if first == "listen":
        peer = socket.create_connection(link.listen.getsockname())
        with watched(WAIT):
            while link.port is None:
                link.recv()
    ports = [link.port, link.port_out if peer is None else link.listen]
    real = getattr(link, first)
    setattr(link, first, Interrupting(real))
    with pytest.raises(Alarm):
        link.close()
    assert [port.fileno() for port in ports] == [-1, -1]
    assert link.fd is None
    if peer is not None:
        assert peer.recv(1) == b""
        peer.close()


def test_who_interrupts_the_end_of_a_child_does_not_wait_for_it() -> None:
    link = mavutil.mavlink_connection("exec:/bin/cat")
    wait, waits = link.child.wait, []

    def interrupt(timeout: float | None = None) -> int:
        waits.append(timeout)
        if timeout is not None and len(waits) == 1:
            raise KeyboardInterrupt
        return wait(timeout)

    link.child.terminate = int
    link.child.wait = interrupt
    with watched(WAIT), pytest.raises(KeyboardInterrupt):
        link.close()
    assert link.child.returncode == -signal.SIGKILL
    assert (link.child.stdin.closed, link.child.stdout.closed) == (True, True)


def test_a_turn_is_had_by_one() -> None:
    turn = Exclusive()
    assert turn.run(lambda: (turn.run(int), turn.locked())) == (None, True)
    assert turn.run(divmod, 7, 2) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        turn.run(lambda: 1 // 0)
    assert not turn.locked()


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
        with pytest.raises(ConnectionAbortedError, match="interrupted"):
            act(port)


class Used:
    """A TLS socket that is closed while it is used, by a signal handler and by another thread."""

    is_closed = closed_meanwhile = False

    def send(self, data: bytes) -> int:
        self.port.close()
        thread = threading.Thread(target=self.port.close)
        thread.start()
        thread.join(WAIT)
        assert not thread.is_alive()
        self.closed_meanwhile = self.is_closed
        return len(data)

    def close(self) -> None:
        self.is_closed = True


def test_a_tls_connection_is_closed_by_who_uses_it() -> None:
    """OpenSSL does not allow it meanwhile, and who closes it does not wait."""
    used = Used()
    used.port = port = TlsPort(used)
    with watched(WAIT):
        assert port.send(bytes(FRAME)) == FRAME
    assert (used.closed_meanwhile, used.is_closed) == (False, True)
    with pytest.raises(ConnectionAbortedError, match="closed"):
        port.send(bytes(FRAME))
