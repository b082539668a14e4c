"""Signal handlers that raise, as Ctrl-C does in a REPL: what they interrupt stays usable, and frames stay whole."""

from __future__ import annotations

import gc
import os
import random
import select
import signal
import socket
import sys
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
    PortError,
    StreamWriter,
    TlsPort,
    close_port,
)
from mavwire.dialects.v20 import all as all_messages
from mavwire.links import signing
from mavwire.links.link_ids import section
from mavwire.links.signing import prepared
from mavwire.links.timestamp_store import TimestampStore
from mavwire.links.waiting import ask_for_room, prepare_tcp, set_close_on_exec
from unit.link_tools import heartbeat
from watchdog import watched

WAIT = 60.0
FRAME = 10
INTERRUPTS = 300

pytestmark = [
    pytest.mark.usefixtures("mavlink20"),
    pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers"),
]


class Stop(TimeoutError):
    """What the handler raises: an OSError, which is not to be taken for one of a port."""


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
        act()  # Python takes an OSError for the file system's while it looks for what is imported when it is first needed
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


def silent(listener: socket.socket) -> list[socket.socket]:
    """Fills the queue of who listens, so that connections to it are not answered."""
    listener.listen(0)
    waiting: list[socket.socket] = []
    while True:
        client = socket.socket()
        waiting.append(client)
        client.setblocking(False)
        if client.connect_ex(listener.getsockname()) == 0:
            continue
        if not select.select([], [client], [], 0.2)[1]:
            return waiting


@pytest.mark.parametrize("kind", ["tcp", "ws", "ws, of a server that does not shake hands"])
def test_a_handlers_timeout_ends_the_attempt_to_connect(kind: str) -> None:
    """An alarm around `mavlink_connection` is no time-out of the connection, which is tried again."""
    if kind != "tcp":
        pytest.importorskip("wsproto")

    def handle(*_: object) -> None:
        raise Stop

    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        clients = [] if "," in kind else silent(listener)
        before = signal.signal(signal.SIGALRM, handle)
        device = f"{kind.partition(',')[0]}:127.0.0.1:{listener.getsockname()[1]}"
        with pytest.raises(Stop):
            signal.setitimer(signal.ITIMER_REAL, 0.3)
            mavutil.mavlink_connection(device, retries=2)
        signal.signal(signal.SIGALRM, before)
        for client in clients:
            client.close()


def each_step() -> Iterator[Callable[[], object]]:
    """What closes, prepares and watches a socket, and opens a serial port."""
    serial, device = serial_link()
    serial.reconnect_delay = 0
    yield serial.reset
    serial.close()
    device.close()
    pair = socket.socketpair()
    link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    yield lambda: close_port(socket.socket())
    yield lambda: (prepare_tcp(link.listen), pair)
    yield lambda: ask_for_room(pair[0])
    yield lambda: set_close_on_exec(pair[0].fileno())
    yield lambda: link.select(0.0)
    yield link._somebody_waits
    link.close()
    for end in pair:
        end.close()


def test_what_a_handler_raises_is_not_taken_for_the_systems(interrupted: Any) -> None:
    for act in each_step():
        interrupted(act)


@pytest.mark.parametrize("kind", ["udpin", "tcpin", "mcast", "serial"])
def test_what_a_handler_raises_while_a_link_is_opened_is_not_lost(
    kind: str, interrupted: Any
) -> None:
    serial, device = serial_link() if kind == "serial" else (None, None)
    name = serial.device if serial else "mcast:" if kind == "mcast" else f"{kind}:127.0.0.1:0"
    try:
        mavutil.mavlink_connection(name).close()
    except OSError as error:
        pytest.skip(f"no multicast here: {error}")
    interrupted(lambda: mavutil.mavlink_connection(name).close())
    if serial:
        serial.close()
        device.close()


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


class Refused:
    """The module that opens serial ports, whose words for errors are its own."""

    def __init__(self, module: Any, error: OSError) -> None:
        self._module, self._error = module, error

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)

    def Serial(self, *_: object, **__: object) -> Any:
        try:
            raise self._error
        except OSError as error:
            raise self._module.SerialException(error.errno, f"could not open port: {error}")  # noqa: B904


@pytest.mark.parametrize("force_connected", [False, True])
def test_opening_a_serial_port_tells_a_handlers_errors_from_the_systems(
    force_connected: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    serial = pytest.importorskip("serial")
    options = {"baud": 57600, "force_connected": force_connected}
    monkeypatch.setitem(sys.modules, "serial", Refused(serial, Stop("alarm")))
    with pytest.raises(Stop, match="alarm"):
        mavutil.mavserial("/dev/ttyNONE0", **options)
    gone = Refused(serial, FileNotFoundError(2, "No such file or directory"))
    monkeypatch.setitem(sys.modules, "serial", gone)
    if force_connected:
        assert not mavutil.mavserial("/dev/ttyNONE0", **options).reset()
    else:
        with pytest.raises(serial.SerialException, match="No such file"):
            mavutil.mavserial("/dev/ttyNONE0", **options)


@pytest.mark.parametrize("device", ["udpin:somewhere.test:0", "tcpin:somewhere.test:0"])
def test_what_a_handler_raises_while_a_name_is_looked_up_to_listen_stays_what_it_is(
    device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    raised = Stop()

    def interrupted(*_: object) -> None:
        raise raised

    monkeypatch.setattr("mavwire.links.waiting.look_up", interrupted)
    with pytest.raises(Stop) as told:
        mavutil.mavlink_connection(device)
    assert told.value is raised


@pytest.mark.parametrize("is_gone", [False, True])
def test_a_serial_port_is_closed_whole(is_gone: bool) -> None:
    """Also where the system says an error."""
    link, device = serial_link()
    port = link.port
    names = ["fd", *(f"pipe_abort_{end}" for end in ("read_r", "read_w", "write_r", "write_w"))]
    open_before = [getattr(port, name) for name in names]
    if is_gone:
        os.close(port.fd)
    close_port(port)
    close_port(port)
    for fd in open_before:
        with pytest.raises(OSError, match="Bad file"):
            os.fstat(fd)
    assert {getattr(port, name) for name in names} == {None}
    assert not port.is_open
    assert port.closed  # or its finalizer would do it again, and swallow what a handler raises
    link.close()
    device.close()


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
        with pytest.raises((ConnectionAbortedError, PortError), match="signal"):
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
