"""The parts of benches/soak.py, each in a process of its own, which answer a line on standard input with one of JSON."""

from __future__ import annotations

import json
import os
import queue
import socket
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from random import Random
from typing import Any

from live_worker import PAUSE, resident
from mavwire import Bridge, mavutil, open_log
from mavwire.sim import Vehicle

# So many frames of a flight, a multiple of the sequence numbers there are: then the next flight follows without a gap.
FRAMES = 256 * 40
GARBAGE = 1400


def flight() -> list[bytes]:
    """The frames of a simulated copter, the same each time."""
    vehicle, found = Vehicle(seed=1), list[bytes]()
    while len(found) < FRAMES:
        vehicle.advance(0.1)
        found += vehicle.take()
    return found[:FRAMES]


def tell(**answer: Any) -> None:
    print(json.dumps(answer), flush=True)


def measured() -> dict[str, Any]:
    """Memory in kB, descriptors, and seconds of processor time of this process."""
    return {
        "kB": resident(),
        "fd": len(os.listdir("/proc/self/fd")),
        "CPU": round(time.process_time(), 2),
    }


def send(port: str, rate: str, seconds: str) -> None:
    """The flight, over and over, at an even rate."""
    frames = flight()
    wanted, sent = int(int(rate) * float(seconds)), 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", int(port)))
        start = time.perf_counter()
        while sent < wanted:
            # What is late is caught up with gently: the machine may have stood still.
            due = min(wanted, int((time.perf_counter() - start) * int(rate)) + 1, sent + 2000)
            for n in range(sent, due):
                sock.send(frames[n % FRAMES])
            sent = due
            time.sleep(PAUSE)
        took = time.perf_counter() - start
    tell(sent=sent, seconds=took)


def bridge(target: str) -> None:
    """A bridge with a port for the flight, and two for whoever comes."""
    with Bridge(["udpin:127.0.0.1:0", f"udpout:127.0.0.1:{target}"]) as core:
        hostile = [core.add(f"{kind}:127.0.0.1:0", name=kind) for kind in ("udpin", "tcpin")]
        ends = {one["name"]: one["endpoint"] for one in core.stats()["links"] if not one["peer"]}
        ports = [int(ends[name].rpartition(":")[2]) for name in ("udpin:127.0.0.1:0", *hostile)]
        tell(**dict(zip(("honest", "hostile UDP", "hostile TCP"), ports, strict=True)))
        for _ in sys.stdin:
            links = core.stats()["links"]
            garbage = sum(one["junk_bytes"] for one in links if one["name"] in hostile)
            tell(**measured(), garbage=garbage)


def attack(udp: str, tcp: str) -> None:
    """Garbage as fast as it goes, from senders that change; also frames that were cut off, but no whole one."""
    os.nice(10)
    rand = Random(2)
    pieces = [
        rand.randbytes(GARBAGE),
        b"\xfd" * GARBAGE,
        b"\xfe\xff\x01" * 400,
        b"".join(frame[:-3] for frame in flight()[:60])[:GARBAGE],
    ]
    address = ("127.0.0.1", int(tcp))
    for turn in range(sys.maxsize):
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock,
            socket.socket() as stream,
            suppress(OSError),
        ):
            sock.connect(("127.0.0.1", int(udp)))
            stream.settimeout(1)
            stream.connect(address)
            for _ in range(200):
                with suppress(ConnectionError):
                    sock.send(pieces[turn % len(pieces)])
                stream.sendall(pieces[turn % len(pieces)])


class Recorder:
    """A link of mavutil that records, and a thread that compares the logs with the flight."""

    def __init__(self, folder: str, log_bytes: int) -> None:
        self._folder, self._log_bytes = Path(folder), log_bytes
        self.link: Any = mavutil.mavlink_connection("udpin:127.0.0.1:0", dialect="all")
        self.received = self.compared = self._logs = 0
        self.difference: int | None = None
        self._path = self._next()
        self._done: queue.Queue[Path | None] = queue.Queue()
        self._comparing = threading.Thread(target=self._compare)
        self._comparing.start()

    def _next(self) -> Path:
        path = self._folder / f"{self._logs}.tlog"
        self._logs += 1
        self.link.setup_logfile(str(path))
        return path

    def receive(self, timeout: float) -> bool:
        """Whether a message came."""
        if self.link.recv_match(blocking=True, timeout=timeout) is None:
            return False
        self.received += 1
        if self.received % 1024 == 0 and self.link.logfile.tell() >= self._log_bytes:
            self._close_log()
            self._path = self._next()
        return True

    def _close_log(self) -> None:
        self.link.logfile.close()
        self._done.put(self._path)

    def end(self) -> None:
        """Compare the last log too."""
        self._close_log()
        self._done.put(None)
        self._comparing.join()

    def _compare(self) -> None:
        frames = flight()
        while (path := self._done.get()) is not None:
            for msg in open_log(path):
                if self.difference is None and msg.get_msgbuf() != frames[self.compared % FRAMES]:
                    self.difference = self.compared
                self.compared += 1
            path.unlink()

    def told(self) -> dict[str, Any]:
        names = ("received", "compared", "difference")
        return measured() | {name: getattr(self, name) for name in names}


def link(folder: str, log_bytes: str) -> None:
    """Receive until told to end and nothing comes any more."""
    recorder, questions = Recorder(folder, int(log_bytes)), queue.Queue[str]()

    def ask() -> None:
        for line in sys.stdin:
            questions.put(line.strip())

    threading.Thread(target=ask, daemon=True).start()
    tell(port=recorder.link.port.getsockname()[1])
    ending = False
    while recorder.receive(2.0 if ending else 0.05) or not ending:
        if not questions.empty():
            ending = questions.get() == "end"
            if not ending:
                tell(**recorder.told())
    recorder.end()
    tell(**recorder.told())


if __name__ == "__main__":
    what, *arguments = sys.argv[1:]
    globals()[what](*arguments)
