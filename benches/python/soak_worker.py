"""The parts of benches/soak.py, each in a process of its own, which answer a line on standard input with one of JSON."""

from __future__ import annotations

import json
import os
import queue
import socket
import subprocess
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
# Of the flight. Whoever else there is may say that it is all others.
SYSTEM = 1
STRANGERS = [(system, component) for system in range(2, 256) for component in range(256)]
# Datagrams that come to the flight's own port beside it, each second: no more than a system has room for meanwhile.
INTRUSIONS = 500


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
            # Late frames follow at a limited rate: the machine may have stood still.
            due = min(wanted, int((time.perf_counter() - start) * int(rate)) + 1, sent + 2000)
            for n in range(sent, due):
                sock.send(frames[n % FRAMES])
            sent = due
            time.sleep(PAUSE)
        taken = time.perf_counter() - start
    tell(sent=sent, seconds=taken)


def bridge(target: str) -> None:
    """A bridge with a UDP port for the flight, a TCP port for who wants to see it, and two ports for whoever comes."""
    with Bridge() as core:
        core.add(f"udpout:127.0.0.1:{target}", name="station", allow_systems_out=[SYSTEM])
        ports = ("honest", "viewers", "hostile UDP", "hostile TCP")
        for name, kind in zip(ports, ("udpin", "tcpin", "udpin", "tcpin"), strict=True):
            core.add(f"{kind}:127.0.0.1:0", name=name)
        ends = {one["name"]: one["endpoint"] for one in core.stats()["links"] if not one["peer"]}
        tell(**{name: int(ends[name].rpartition(":")[2]) for name in ports})
        for _ in sys.stdin:
            stats = core.stats()
            tell(
                **measured(),
                came=sum(one["junk_bytes"] + one["received_bytes"] for one in stats["links"]),
                garbage=sum(one["junk_bytes"] for one in stats["links"]),
                components=len(stats["components"]) + stats["hidden_components"],
            )


def garbage() -> list[bytes]:
    """Datagrams without a whole frame."""
    return [
        Random(2).randbytes(GARBAGE),
        b"\xfd" * GARBAGE,
        b"\xfe\xff\x01" * 400,
        b"".join(frame[:-3] for frame in flight()[:60])[:GARBAGE],
    ]


def intrude(udp: str, tcp: str) -> None:
    """To the flight's own ports, steadily: good frames of every sender that there is, garbage from senders that change, and
    a client that reads nothing.
    """
    os.nice(10)
    mav, frames = mavutil.mavlink.MAVLink(None), list[bytes]()
    for system, component in STRANGERS:
        mav.srcSystem, mav.srcComponent = system, component
        frames.append(mav.heartbeat_encode(6, 8, 0, 0, 4).pack(mav))
    made_up = [b"".join(frames[start : start + 60]) for start in range(0, len(frames), 60)]
    pieces, address = garbage(), ("127.0.0.1", int(udp))
    with (
        socket.create_connection(("127.0.0.1", int(tcp))) as deaf,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as liar,
    ):
        deaf.sendall(frames[0])
        start = time.perf_counter()
        for turn in range(sys.maxsize):
            if turn == len(made_up):
                tell(known=len(STRANGERS))
            with suppress(OSError):
                liar.sendto(made_up[turn % len(made_up)], address)
                with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
                    stranger.sendto(pieces[turn % len(pieces)], address)
            time.sleep(max(start + turn / INTRUSIONS - time.perf_counter(), 0.0))


def attack(udp: str, tcp: str) -> None:
    """Garbage as fast as it goes, from senders that change; also frames that were cut off, but no whole one."""
    os.nice(10)
    pieces = garbage()
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
    """A link of mavutil that records, and a process that compares the logs with the flight."""

    def __init__(self, folder: str, log_bytes: int) -> None:
        self._folder, self._log_bytes = Path(folder), log_bytes
        self.link: Any = mavutil.mavlink_connection("udpin:127.0.0.1:0", dialect="all")
        self.received = self._logs = 0
        self._answer: dict[str, Any] = {"compared": 0, "difference": None, "CPU": 0.0}
        self._path = self._next()
        # Not a thread: it would take its turns from the link, as no program that can lose nothing lets it.
        command = [sys.executable, __file__, "compare"]
        self._comparer = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    def _next(self) -> Path:
        path = self._folder / f"{self._logs}.tlog"
        self._logs += 1
        self.link.setup_logfile(str(path))
        return path

    def _listen(self) -> None:
        assert self._comparer.stdout is not None
        for line in self._comparer.stdout:
            self._answer = json.loads(line)

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
        assert self._comparer.stdin is not None
        self._comparer.stdin.write(f"{self._path}\n")
        self._comparer.stdin.flush()

    def end(self) -> None:
        """Compare the last log too."""
        self._close_log()
        assert self._comparer.stdin is not None
        self._comparer.stdin.close()
        self._listener.join()
        self._comparer.wait()

    def told(self) -> dict[str, Any]:
        own = measured()
        own["CPU"] = round(own["CPU"] + self._answer["CPU"], 2)
        return self._answer | own | {"received": self.received}


def compare() -> None:
    """Tell how many frames of the logs that are named on standard input are those of the flight, and remove them."""
    frames = flight()
    compared, difference = 0, None
    for line in sys.stdin:
        path = Path(line.rstrip("\n"))
        for msg in open_log(path):
            if difference is None and msg.get_msgbuf() != frames[compared % FRAMES]:
                difference = compared
            compared += 1
        path.unlink()
        tell(compared=compared, difference=difference, CPU=time.process_time())


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
