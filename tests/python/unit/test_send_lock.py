"""The lock over sending: frames leave in sequence, and no program of pymavlink's waits for itself."""

from __future__ import annotations

import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import common
from unit.link_tools import heartbeat

WAIT = 60.0


def numbers(frames: list[bytes]) -> list[int]:
    """Sequence numbers, of both versions."""
    return [frame[4] if frame[0] == 0xFD else frame[2] for frame in frames]


def send(mav: Any) -> None:
    mav.heartbeat_send(6, 8, 0, 0, 0)


class Held:
    """What is written first is not done until `go` is set."""

    def __init__(self) -> None:
        self.frames: list[bytes] = []
        self.inside, self.go = threading.Event(), threading.Event()
        self.at_once = self.at_most = 0
        self.pause: Callable[[], object] = int

    def write(self, frame: bytes) -> None:
        self.at_once += 1
        self.at_most = max(self.at_most, self.at_once)
        self.frames.append(bytes(frame))
        if len(self.frames) == 1:
            self.inside.set()
            assert self.go.wait(WAIT)
        self.pause()
        self.at_once -= 1


@pytest.fixture
def threads() -> Iterator[Any]:
    started: list[threading.Thread] = []

    def start(act: Any, *arguments: Any, name: str | None = None) -> threading.Thread:
        started.append(threading.Thread(target=act, args=arguments, name=name, daemon=True))
        started[-1].start()
        return started[-1]

    yield start
    for thread in started:
        thread.join(WAIT)
        assert not thread.is_alive()


def test_a_write_that_takes_a_lock_of_the_senders_is_no_deadlock(threads: Any) -> None:
    lock, frames, waits = threading.RLock(), [], threading.Event()

    class Device:
        def write(self, frame: bytes) -> None:
            waits.set()
            with lock:
                frames.append(bytes(frame))

    mav = common.MAVLink(Device())
    each = 50

    def beats() -> None:
        for _ in range(each):
            send(mav)

    with lock:
        thread = threads(beats)
        assert waits.wait(WAIT)
        for _ in range(each):  # nobody else writes between these
            send(mav)
        assert len(frames) == each
    thread.join(WAIT)
    # Each number once; the one that waited for the lock comes after those.
    assert sorted(numbers(frames)) == list(range(2 * each))
    assert mav.total_packets_sent == 2 * each
    assert mav.seq == 2 * each


def test_a_write_that_fails_beside_another_one_gives_its_number_back(threads: Any) -> None:
    device = Held()
    mav = common.MAVLink(device)
    threads(send, mav)
    assert device.inside.wait(WAIT)
    send(mav)  # passes after a while
    assert mav.seq == 2

    class Broken:
        def write(self, frame: bytes) -> None:
            raise ConnectionResetError

    device.write = Broken().write  # type: ignore[method-assign]
    with pytest.raises(ConnectionResetError):
        send(mav)
    assert mav.seq == 2
    del device.write
    device.go.set()
    send(mav)
    assert numbers(device.frames) == [0, 1, 2]


def test_a_thread_that_sends_without_a_pause_lets_others_send(threads: Any) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 0))
        link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{peer.getsockname()[1]}")
        done = threading.Event()

        def beats() -> None:
            for _ in range(10):
                send(link.mav)
            done.set()

        threads(beats)
        end = time.monotonic() + WAIT
        while not done.is_set() and time.monotonic() < end:
            send(link.mav)
        assert done.is_set()
        link.close()


def test_who_stops_waiting_for_the_lock_leaves_it_to_others(threads: Any) -> None:
    """A signal handler that raises ends the wait of the main thread."""
    device = Held()
    mav = common.MAVLink(device)
    threads(send, mav)
    assert device.inside.wait(WAIT)
    threads(send, mav)

    class Stop(Exception):
        pass

    is_waiting, stopped = False, threading.Event()

    def handle(*_: object) -> None:
        if is_waiting:
            raise Stop

    def interrupt() -> None:
        while not stopped.wait(0.01):
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, handle)
    interrupter = threads(interrupt)
    with pytest.raises(Stop):
        is_waiting = True
        send(mav)
    is_waiting = False
    stopped.set()
    interrupter.join(WAIT)
    signal.signal(signal.SIGINT, before)
    device.go.set()
    while mav.total_packets_sent < 2:
        time.sleep(0.001)
    send(mav)
    assert numbers(device.frames) == [0, 1, 2]


def test_who_is_left_the_lock_takes_it_before_a_signal_handler_runs(threads: Any) -> None:
    """Others leave it once to who has waited for long, and would wait while a handler runs, or for nobody if it raises."""

    class Stop(Exception):
        pass

    def handle(*_: object) -> None:
        raise Stop

    device, has_it, frames = SimpleNamespace(), threading.Event(), []
    mav = common.MAVLink(device)

    def hold(frame: bytes) -> None:
        device.write = frames.append  # which runs no Python code, and so no handler
        has_it.set()
        time.sleep(0.1)  # until the main thread waits, which nobody can see
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    device.write = hold
    before, interval = signal.signal(signal.SIGINT, handle), sys.getswitchinterval()
    sys.setswitchinterval(10.0)  # from the signal to the end of the write no other thread runs
    try:
        threads(send, mav)
        with pytest.raises(Stop):
            has_it.wait(WAIT)
            send(mav)
    finally:
        sys.setswitchinterval(interval)
        signal.signal(signal.SIGINT, before)
    assert numbers(frames) == [1]


def test_a_signal_handler_may_wait_for_who_has_the_lock(threads: Any) -> None:
    """The thread in whose wait for the lock the handler runs does not get it meanwhile."""
    mav = common.MAVLink(held := Held())

    def work() -> None:
        for _ in range(300):
            send(mav)

    worker = threads(work)
    assert held.inside.wait(WAIT)
    ended: list[bool] = []
    is_waiting, looks, stopped = False, 0, threading.Event()

    def handle(*_: object) -> None:
        nonlocal looks
        looks += is_waiting
        if looks == 5:  # it has waited for some of these by now
            held.go.set()
            worker.join(WAIT)
            ended.append(not worker.is_alive())
            stopped.set()

    def interrupt() -> None:
        while not stopped.wait(0.01):
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, handle)
    interrupter = threads(interrupt)
    is_waiting = True
    send(mav)
    interrupter.join(WAIT)
    signal.signal(signal.SIGINT, before)
    assert ended == [True]


def test_writes_are_kept_apart_again_after_one_that_stood_still(threads: Any) -> None:
    device = Held()
    mav = common.MAVLink(device)
    threads(send, mav)
    assert device.inside.wait(WAIT)
    send(mav)  # passes after a while
    assert device.at_most == 2
    device.go.set()
    while mav.total_packets_sent < 2:
        time.sleep(0.001)
    device.at_most, device.pause = 0, lambda: time.sleep(0)

    def beats() -> None:
        for _ in range(200):
            send(mav)

    both = [threads(beats), threads(beats)]
    for thread in both:
        thread.join(WAIT)
    assert device.at_most == 1
    assert sorted(numbers(device.frames)) == sorted(n % 256 for n in range(402))


def test_what_a_link_calls_may_wait_for_another_sender(threads: Any) -> None:
    done: list[bool] = []

    class Link(mavutil.mavtcp):  # type: ignore[misc]
        def handle_disconnect(self) -> None:
            thread = threads(send, self.mav)
            thread.join(WAIT)
            done.append(not thread.is_alive())
            super().handle_disconnect()

    with socket.create_server(("127.0.0.1", 0)) as server:
        link = Link(f"127.0.0.1:{server.getsockname()[1]}")
        server.accept()[0].close()
        while link.port is not None:
            send(link.mav)
        assert done == [True]
        link.close()


def test_a_frame_that_is_sent_in_the_middle_of_another_one_has_the_next_number() -> None:
    """As a signal handler sends it."""

    class Device:
        def __init__(self) -> None:
            self.frames: list[bytes] = []

        def write(self, frame: bytes) -> None:
            self.frames.append(bytes(frame))
            if len(self.frames) % 3:  # twice, one inside of the other
                send(mav)

    mav = common.MAVLink(device := Device())
    for _ in range(100):
        send(mav)
    assert numbers(device.frames) == [n % 256 for n in range(300)]
    assert (mav.seq, mav.total_packets_sent) == (300 % 256, 300)


def test_the_switch_to_mavlink_2_during_a_send_uses_no_number_twice(threads: Any) -> None:
    mavutil.set_wire_protocol("1.0")
    mavutil.set_dialect("all")
    try:
        link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
        device = Held()
        link.mav.file, old = device, link.mav
        threads(send, old)
        assert device.inside.wait(WAIT)
        link.auto_mavlink_version(heartbeat()[:1])  # what receiving does
        assert link.mav is not old
        send(link.mav)
        device.go.set()
        send(old)
        while link.mav.total_packets_sent < 3:
            time.sleep(0.001)
        send(link.mav)
        assert numbers(device.frames) == [0, 1, 2, 3]
        assert (link.mav.total_packets_sent, link.mav.seq, old.seq) == (4, 4, 4)
        link.close()
    finally:
        mavutil.set_wire_protocol(None)
        mavutil.set_dialect("all")
