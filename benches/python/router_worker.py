"""One measurement of a router for `make bench-bridge`, in a process of its own; prints what it found as JSON.

A process sends frames with a number in each and notes when. The router forwards them to sockets where the kernel stamps
each datagram as it arrives, so that this process may read them late and little. The difference is the added latency.
"""

from __future__ import annotations

import json
import os
import pty
import re
import socket
import struct
import subprocess
import sys
import termios
import time
import tty
from array import array
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile

from mavwire import Bridge
from mavwire.dialects.v20 import ardupilotmega as mavlink

PACKET, NUMBER_AT = 36, 10
# SO_TIMESTAMPNS of Linux: the control message has the same number.
STAMPS = 35
# Frames that are less than half of this apart are waited for in a loop: a timer is not that even.
SLEEP = 0.001
# The ends are read this often, and this long after the last frame was sent.
DRAIN, SETTLE = 0.002, 0.5
# The serial link takes bytes at this rate: 57,600 baud.
SERIAL_BYTES = 5_760


def frame(number: int, sysid: int) -> bytes:
    mav = mavlink.MAVLink(None, sysid, 1)
    mav.seq = number % 256
    return bytes(mavlink.MAVLink_attitude_message(number, 0.1, 0.2, 0.3, 0.4, 0.5, 0).pack(mav))


def send(rate: int, seconds: float, gap: float, ports: list[int]) -> None:
    """Send to each port in turn, and write the times of all frames to standard output."""
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in ports]
    for sock, port in zip(sockets, ports, strict=True):
        sock.connect(("127.0.0.1", port))
    made = [frame(n, 1 + n % len(ports)) for n in range(int(rate * seconds))]
    times, clock, per_burst = array("q"), time.time_ns, max(1, round(rate * gap))
    start = clock() + 200_000_000
    for n, one in enumerate(made):
        due = start + n // per_burst * per_burst * 1_000_000_000 // rate
        if (left := (due - clock()) / 1e9) > SLEEP / 2:
            time.sleep(left - SLEEP / 10)
        while (now := clock()) < due:
            pass
        times.append(now)
        sockets[n % len(sockets)].send(one)
    sys.stdout.buffer.write(times.tobytes())


class Sink:
    """The frames that arrive at one end: the time of each by its number."""

    def __init__(self) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, STAMPS, 1)
        for option in (33, socket.SO_RCVBUF):  # SO_RCVBUFFORCE, for root
            with suppress(OSError):
                self.socket.setsockopt(socket.SOL_SOCKET, option, 8 << 20)
                break
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.arrived: dict[int, int] = {}
        self.datagrams = 0

    @property
    def port(self) -> int:
        port: int = self.socket.getsockname()[1]
        return port

    def drain(self) -> None:
        with suppress(BlockingIOError):
            while True:
                data, controls, *_ = self.socket.recvmsg(65_536, 64)
                seconds, nanoseconds = struct.unpack("qq", controls[0][2])
                self.datagrams += 1
                for at in range(0, len(data) - PACKET + 1, PACKET):
                    (number,) = struct.unpack_from("<I", data, at + NUMBER_AT)
                    self.arrived[number] = seconds * 1_000_000_000 + nanoseconds


class SerialLine:
    """A serial port of the router that takes as many bytes as a radio."""

    def __init__(self) -> None:
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        attributes = termios.tcgetattr(self.slave)
        attributes[4] = attributes[5] = termios.B57600
        termios.tcsetattr(self.slave, termios.TCSANOW, attributes)
        os.set_blocking(self.master, False)
        self.since = time.monotonic()

    @property
    def device(self) -> str:
        return os.ttyname(self.slave)

    def drain(self) -> None:
        now = time.monotonic()
        with suppress(BlockingIOError):
            os.read(self.master, max(1, int((now - self.since) * SERIAL_BYTES)))
        self.since = now


def cpu_micros(pid: int) -> float:
    """Processor time of all threads of a process so far."""
    threads = Path(f"/proc/{pid}/task").glob("*/schedstat")
    return sum(int(one.read_text().split()[0]) for one in threads) / 1_000


def resident_mb(pid: int) -> float:
    found = re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{pid}/status").read_text())
    return int(found[1]) / 1024 if found else 0.0


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def wait_until_it_routes(sinks: list[Sink], ports: list[int]) -> None:
    """Let each sender be heard, and each sink get something."""
    end, probe = time.monotonic() + 20, (1 << 32) - 1
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        while not all(sink.arrived for sink in sinks):
            if time.monotonic() > end:
                raise SystemExit("it routes nothing")
            for sysid, port in enumerate(ports, 1):
                with suppress(OSError):
                    sock.sendto(frame(probe, sysid), ("127.0.0.1", port))
            time.sleep(0.05)
            for sink in sinks:
                sink.drain()
    time.sleep(0.3)
    for sink in sinks:
        sink.drain()
        sink.arrived.clear()
        sink.datagrams = 0


def expanded(router: list[str], ends: dict[str, list[str]]) -> list[str]:
    """A command whose words that hold a kind of end come once for each."""
    words: list[str] = []
    for word in router:
        kind = next((kind for kind in ends if kind in word), None)
        words += [word.replace(kind, end) for end in ends[kind]] if kind else [word]
    return words


def drain_until_over(sender: subprocess.Popen[bytes], ends: list[Sink | SerialLine]) -> None:
    over = 0.0
    while not over or time.monotonic() < over:
        for end in ends:
            end.drain()
        time.sleep(DRAIN)
        if sender.poll() is not None:
            over = over or time.monotonic() + SETTLE


def measure(
    rate: int, seconds: float, gap: float, ins: int, outs: int, serial: bool, router: list[str]
) -> None:
    """Send through a router; IN, OUT and TTY in its words are its ends."""
    ports, sinks = [free_port() for _ in range(ins)], [Sink() for _ in range(outs)]
    lines = [SerialLine()] if serial else []
    ends = {
        "IN": [str(port) for port in ports],
        "OUT": [str(sink.port) for sink in sinks],
        "TTY": [line.device for line in lines],
    }
    program = subprocess.Popen(
        expanded(router, ends), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        wait_until_it_routes(sinks, ports)
        began = cpu_micros(program.pid)
        command = [sys.executable, __file__, "send", *map(str, (rate, seconds, gap, *ports))]
        with TemporaryFile() as times:
            drain_until_over(subprocess.Popen(command, stdout=times), [*sinks, *lines])
            times.seek(0)
            sent = array("q", times.read())
        cpu, memory = cpu_micros(program.pid) - began, resident_mb(program.pid)
    finally:
        program.kill()
        program.wait()
    print(json.dumps(summary(sent, sinks, cpu) | {"mb": memory}))


def forward_unpacked(*endpoints: str) -> None:
    """A bridge that puts one frame in each datagram, as a router."""
    with Bridge() as bridge:
        for endpoint in endpoints:
            bridge.add(endpoint, **({"datagram_bytes": 0} if "udp" in endpoint else {}))
        time.sleep(3_600)


def forward_with_pymavlink(source: str, *targets: str) -> None:
    """The loop of a program that has no router: from one connection to the others."""
    from pymavlink import mavutil

    came = mavutil.mavlink_connection(source)
    outs = [mavutil.mavlink_connection(target) for target in targets]
    while True:
        if msg := came.recv_match(blocking=True):
            for out in outs:
                out.write(msg.get_msgbuf())


def summary(sent: array[int], sinks: list[Sink], cpu: float) -> dict[str, float]:
    late = sorted(
        time - sent[n] for sink in sinks for n, time in sink.arrived.items() if n < len(sent)
    )
    at = lambda part: late[int(part * (len(late) - 1))] / 1_000 if late else 0.0  # noqa: E731
    arrived = max(1, len(late) // len(sinks))
    return {
        "sent": len(sent),
        "lost": len(sent) * len(sinks) - len(late),
        "micros": cpu / arrived,
        "p50": at(0.5),
        "p99": at(0.99),
        "p999": at(0.999),
        "datagrams": sum(sink.datagrams for sink in sinks) / max(1, len(late)),
    }


if __name__ == "__main__":
    what, *rest = sys.argv[1:]
    if what in ("forward_unpacked", "forward_with_pymavlink"):
        globals()[what](*rest)
    rate, seconds, gap, *rest = rest
    if what == "send":
        send(int(rate), float(seconds), float(gap), [int(port) for port in rest])
    else:
        ins, outs, serial, *router = rest
        measure(int(rate), float(seconds), float(gap), int(ins), int(outs), serial == "1", router)
