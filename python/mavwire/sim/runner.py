"""Ties simulated vehicles to links and to real time.

The loop sleeps until a byte arrives or the next message is due; it never polls.
"""

from __future__ import annotations

import select
import socket
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from .swarm import Swarm
from .vehicle import Vehicle

# After a pause of the process (or a debugger) the vehicles do not fly all of it at once.
MAX_CATCH_UP = 1.0
# Links are drained in portions, so that a flood does not stop the vehicles.
MESSAGES_PER_TURN = 1000
# Links without a descriptor, or waiting for a reconnection, are looked at this often.
LINK_INTERVAL = 0.1


class Runner:
    """Runs `vehicles` on `links`, `speed` times as fast as real time."""

    def __init__(
        self, vehicles: Sequence[Vehicle], links: Sequence[Any], speed: float = 1.0
    ) -> None:
        if not 0 < speed <= 100:
            raise ValueError(f"speed must be above 0 and at most 100: {speed}")
        self.swarm = Swarm(vehicles)
        for vehicle in vehicles:
            vehicle.start_now(time.time())
        self.links = list(links)
        self.speed = speed
        self.received = 0
        self.errors = 0
        self._key: bytes | None = None
        self._stopping = threading.Event()
        self._wake, self._waker = socket.socketpair()
        self._wake.setblocking(False)
        self._thread: threading.Thread | None = None
        self._last: float | None = None

    @property
    def vehicles(self) -> list[Vehicle]:
        """The vehicles."""
        return self.swarm.vehicles

    @property
    def sent(self) -> int:
        """Frames that the vehicles have sent, lost ones included."""
        return sum(vehicle.frames_sent for vehicle in self.vehicles)

    # -- running

    def run(self, duration: float | None = None) -> None:
        """Run for `duration` seconds of real time, or until `stop`."""
        deadline = None if duration is None else time.monotonic() + duration
        while not self._stopping.is_set():
            wait = self.turn()
            if deadline is not None:
                left = deadline - time.monotonic()
                if left <= 0:
                    return
                wait = min(wait, left)
            self._sleep(wait)

    def turn(self) -> float:
        """Do what is due: receive, fly, send. Returns how long there is nothing to do."""
        self._share_key()
        more = [link for link in self.links if self._receive(link)]
        now = time.monotonic()
        elapsed = 0.0 if self._last is None else now - self._last
        self._last = now
        self.swarm.advance(min(elapsed, MAX_CATCH_UP) * self.speed)
        for frame in self.swarm.take():
            for link in self.links:
                self._write(link, frame)
        return 0.0 if more else self.swarm.until_next / self.speed

    def _share_key(self) -> None:
        """Links check signatures if all vehicles have the same key, which may change in flight."""
        key = self.swarm.key
        if key != self._key:
            self._key = key
            for link in self.links:
                if key is None:
                    link.disable_signing()
                else:
                    link.setup_signing(key, sign_outgoing=False)

    def _receive(self, link: Any) -> bool:
        """Take what is there; whether more is, which no descriptor may tell: it was read ahead."""
        for _ in range(MESSAGES_PER_TURN):
            try:
                msg = link.recv_msg()
            except OSError:
                # As with writing: the vehicle flies on.
                self.errors += 1
                return False
            if msg is None:
                return False
            if msg.get_type() != "BAD_DATA":
                self.received += 1
                self._hand_over(msg)
        return True

    def _hand_over(self, msg: Any) -> None:
        if self.swarm.keys == {self._key}:
            self.swarm.handle(msg)
        else:  # the link did not check what each vehicle wants checked
            self.swarm.receive(bytes(msg.get_msgbuf()))

    def _write(self, link: Any, frame: bytes) -> None:
        try:
            link.write(frame)
        except OSError:
            # A peer that is gone may come back; the vehicle flies on.
            self.errors += 1

    def _sleep(self, seconds: float) -> None:
        fds = [link.fd for link in self.links]
        if None in fds:
            seconds = min(seconds, LINK_INTERVAL)
        fds = [fd for fd in fds if fd is not None and fd >= 0]
        _wait_any([*fds, self._wake.fileno()], seconds)

    # -- in the background

    def start(self) -> None:
        """Run in a thread of its own, until `stop`."""
        if self._thread is None:
            self._thread = threading.Thread(target=self.run, name="mavwire.sim", daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """End `run`, from any thread, and wait for the one of `start`."""
        if not self._stopping.is_set():
            self._stopping.set()
            self._waker.send(b"\0")
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
            self._thread = None

    def close(self) -> None:
        """Stop and close the links."""
        self.stop()
        for link in self.links:
            link.close()
        self._wake.close()
        self._waker.close()


def _wait_any(fds: list[int], seconds: float) -> None:
    """Until one of `fds` is readable, `seconds` at most."""
    if hasattr(select, "poll"):
        poller = select.poll()
        for fd in fds:
            poller.register(fd, select.POLLIN)
        # Rounded up: a wait that ends a little early would turn the loop for nothing.
        poller.poll(int(seconds * 1000) + 1 if seconds > 0 else 0)
    else:
        select.select(fds, [], [], max(seconds, 0.0))


@contextmanager
def serve(
    device: str | Sequence[str] = "udpin:127.0.0.1:14550",
    *vehicles: Vehicle,
    speed: float = 1.0,
) -> Iterator[Runner]:
    """Vehicles (one like ArduPilot if none are given) on connection strings of mavutil, in the
    background as long as the context lasts.

    `with serve("udpout:127.0.0.1:14550", Vehicle("px4")) as sim: ...`
    """
    from mavwire import mavutil

    devices = [device] if isinstance(device, str) else list(device)
    links: list[Any] = []
    try:
        links += (mavutil.mavlink_connection(one, autoreconnect=True) for one in devices)
        runner = Runner(vehicles or (Vehicle(),), links, speed)
    except BaseException:
        for link in links:
            link.close()
        raise
    runner.start()
    try:
        yield runner
    finally:
        runner.close()
