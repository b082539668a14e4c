"""Frames that wait for a peer to read: each is sent whole, or counted when its connection ends."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import struct
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mavwire import aio, mavutil
from mavwire.links import serial_port
from mavwire.links.stream import StreamWriter
from unit.aio_tools import eventually, run
from unit.bridge_tools import wait_until
from unit.link_tools import heartbeat
from watchdog import watched

WAIT = 60.0
FRAME = len(heartbeat())


class Port:
    """Takes `room` bytes."""

    def __init__(self, room: int) -> None:
        self.room = room
        self.taken = bytearray()

    def send(self, data: bytes) -> int:
        if not self.room:
            raise BlockingIOError
        sent = min(len(data), self.room)
        self.room -= sent
        self.taken += data[:sent]
        return sent


class Broken:
    def send(self, data: bytes) -> int:
        raise ConnectionResetError


@pytest.mark.parametrize(
    ("room", "left"), [(0, 4), (1, 4), (10, 3), (11, 3), (29, 3), (30, 2), (99, 1), (100, 0)]
)
def test_frames_that_were_not_sent_whole_are_counted(room: int, left: int) -> None:
    port, writer = Port(room), StreamWriter()
    for length in (10, 20, 30, 40):
        writer.write(port, bytes(length))
    assert (len(writer.unsent), writer.dropped_frames) == (100 - room, 0)
    writer.clear()
    assert (len(writer.unsent), writer.dropped_frames) == (0, left)
    # The next connection begins anew.
    writer.write(Port(3), bytes(5))
    writer.clear()
    assert writer.dropped_frames == left + 1


def test_frames_that_were_sent_bit_by_bit_are_not_counted() -> None:
    port, writer = Port(0), StreamWriter()
    for _ in range(1000):
        port.room = 7
        writer.write(port, bytes(10))
    port.room = 1 << 20
    writer.flush(port)
    writer.clear()
    assert (len(port.taken), writer.dropped_frames) == (10_000, 0)


def test_a_frame_whose_writing_raises_is_counted_once() -> None:
    writer = StreamWriter(max_unsent=15)
    for sent in range(3):  # at first there is room for it in the queue
        with pytest.raises(ConnectionResetError):
            writer.write(Broken(), bytes(10))
        assert writer.dropped_frames == sent
    writer.clear()
    assert writer.dropped_frames == 3


def test_threads_that_write_and_forget_count_what_was_not_sent() -> None:
    """Every frame is taken, waits or is counted."""
    writer, port, frames = StreamWriter(1 << 30), Port(0), 2000

    def write() -> None:
        for _ in range(frames):
            writer.write(port, bytes(10))

    threads = [threading.Thread(target=write) for _ in range(3)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        writer.clear()
    for thread in threads:
        thread.join()
    writer.clear()
    assert writer.dropped_frames == 3 * frames


# -- links


def tcp_ends(folder: Path) -> Any:
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        peer = server.accept()[0]
    return link, lambda: reset(peer)


def tcpin_ends(folder: Path) -> Any:
    link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    peer = socket.socket()
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    peer.connect(link.listen.getsockname())
    wait_until("the client", lambda: link.recv_msg() or link.port is not None)
    return link, lambda: reset(peer)


def exec_ends(folder: Path) -> Any:
    program = folder / "program"
    program.write_text("#!/bin/sh\nexec sleep 600\n")
    program.chmod(0o700)
    link = mavutil.mavlink_connection(f"exec:{program}")

    def end() -> None:
        link.child.kill()
        link.child.wait()

    return link, end


def serial_ends(folder: Path) -> Any:
    pytest.importorskip("serial")
    if not hasattr(os, "openpty"):
        pytest.skip("no pseudo terminals")
    vehicle, port = os.openpty()
    link = mavutil.mavlink_connection(os.ttyname(port), autoreconnect=True)

    def end() -> None:
        os.close(port)
        os.close(vehicle)

    return link, end


def reset(peer: socket.socket) -> None:
    """End a connection with what was sent unread."""
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    peer.close()


def fill(link: Any, unsent: Callable[[], bytes]) -> int:
    """Send until the peer takes no more, and how many frames wait then."""
    port = getattr(link, "port", None)
    if isinstance(port, socket.socket):
        port.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    while len(unsent()) < 10 * FRAME:
        link.write(heartbeat())
    return -(-len(unsent()) // FRAME)


@pytest.mark.parametrize("ends", [tcp_ends, tcpin_ends, exec_ends, serial_ends])
def test_what_waits_is_counted_when_the_peer_goes(
    ends: Callable[[Path], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serial_port, "WRITE_TIMEOUT", 0.01)
    with watched(WAIT):
        link, end = ends(tmp_path)
        waiting = fill(link, lambda: link._writer.unsent)
        assert link.frames_dropped == 0
        end()

        def is_counted() -> bool:
            try:
                link.recv_msg()
            except OSError:  # said by a link that does not connect again
                pass
            return not link._writer.unsent

        wait_until("the end", is_counted)
        assert link.frames_dropped == waiting
        link.close()


@pytest.mark.parametrize("ends", [tcp_ends, exec_ends])
def test_what_waits_is_counted_when_the_link_is_closed(
    ends: Callable[[Path], Any], tmp_path: Path
) -> None:
    with watched(WAIT):
        link, end = ends(tmp_path)
        waiting = fill(link, lambda: link._writer.unsent)
        link.close()
        assert link.frames_dropped == waiting
        end()


def test_what_waits_in_a_loop_is_counted_when_the_peer_goes(tmp_path: Path) -> None:
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\nexec sleep 600\n")
    program.chmod(0o700)

    async def main() -> None:
        async with aio.connect(f"exec:{program}") as link:
            waiting = fill(link.mav.file, lambda: link.sync._writer.unsent)
            assert link.frames_dropped == 0
            link.sync.child.send_signal(signal.SIGKILL)
            await eventually(lambda: not link.connected)
            assert link.frames_dropped == waiting

    run(main())


def test_a_link_that_raises_when_it_sends_has_dropped_a_frame_in_a_loop() -> None:
    async def main() -> None:
        async with aio.connect("udpin:127.0.0.1:0") as link:

            def write(frame: bytes) -> None:
                raise OSError("it does not fit")

            link.sync.write = write
            failures: list[Any] = []
            asyncio.get_running_loop().set_exception_handler(
                lambda _, found: failures.append(found)
            )
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert (link.frames_dropped, len(failures)) == (1, 1)

    run(main())
