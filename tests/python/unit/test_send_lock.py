"""The lock over sending: frames leave in sequence, and no program of pymavlink's waits for itself."""

from __future__ import annotations

import builtins
import threading
import time
from collections.abc import Iterator
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

    def write(self, frame: bytes) -> None:
        self.at_once += 1
        self.at_most = max(self.at_most, self.at_once)
        self.frames.append(bytes(frame))
        if len(self.frames) == 1:
            self.inside.set()
            assert self.go.wait(WAIT)
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
        threads(beats)
        assert waits.wait(WAIT)
        for _ in range(each):  # nobody else writes between these
            send(mav)
        assert len(frames) == each
    for thread in threading.enumerate():
        if thread.daemon and thread is not threading.current_thread():
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


def test_a_link_that_stands_still_is_waited_for(threads: Any, monkeypatch: Any) -> None:
    link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    device = Held()
    monkeypatch.setattr(type(link), "write", lambda _, frame: device.write(frame))
    threads(send, link.mav)
    assert device.inside.wait(WAIT)
    second = threads(send, link.mav)
    second.join(1.5)
    assert second.is_alive()
    device.go.set()
    second.join(WAIT)
    assert (numbers(device.frames), device.at_most) == ([0, 1], 1)
    link.close()


def test_an_error_in_asking_for_the_end_of_the_program_is_not_its_end(
    threads: Any, monkeypatch: Any
) -> None:
    device, asked, load = Held(), threading.Event(), builtins.__import__

    def hook(*arguments: Any, **options: Any) -> Any:
        if threading.current_thread().name == "second":
            asked.set()
            raise RuntimeError
        return load(*arguments, **options)

    mav = common.MAVLink(device)
    threads(send, mav)
    assert device.inside.wait(WAIT)
    monkeypatch.setattr(builtins, "__import__", hook)
    second = threads(send, mav, name="second")
    asked.wait(0.2)
    device.go.set()
    second.join(WAIT)
    assert (numbers(device.frames), device.at_most) == ([0, 1], 1)


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
