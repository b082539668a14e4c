"""Signals that end nothing: interrupted calls go on, processes that stood still lose nothing, and the end of a connection
is no end of the program, in processes of their own.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections import deque
from itertools import repeat
from pathlib import Path

import pytest
from integration.processes import announced_ports, mavwire
from mavwire import open_log, traffic
from mavwire.dialects.v20 import ardupilotmega as apm
from unit.bridge_tools import LIMIT, udp_peer, wait_until
from unit.faults import ENVIRONMENT, python
from unit.link_tools import heartbeat

pytestmark = pytest.mark.skipif(
    not hasattr(signal, "setitimer") or not hasattr(signal, "pthread_sigmask"),
    reason="signals are those of POSIX",
)

STORM = """
import os, signal, socket, sys, threading, time
os.environ["MAVLINK20"] = "1"
from mavwire import Bridge, mavutil
from unit.bridge_tools import wait_until
from unit.link_tools import heartbeat
seen = 0
def handle(*_):
    global seen
    seen += 1
def storm():
    signal.signal(signal.SIGALRM, handle)
    signal.setitimer(signal.ITIMER_REAL, 0.0005, 0.0005)
def connect(device, **options):
    return mavutil.mavlink_connection(device, **options)
def heard(link):
    found = []
    while len(found) < 20:
        msg = link.recv_match(type="HEARTBEAT", blocking=True, timeout=60)
        assert msg is not None
        found.append(msg.custom_mode)
    return found
"""

PAIRS = {
    "udp": """
one = connect("udpin:127.0.0.1:0")
other = connect("udpout:127.0.0.1:%d" % one.port.getsockname()[1])
""",
    "tcp": """
one = connect("tcpin:127.0.0.1:0")
other = connect("tcp:127.0.0.1:%d" % one.listen.getsockname()[1], autoreconnect=True)
""",
    "serial": """
import pty, tty
master, slave = pty.openpty()
tty.setraw(slave)
one = connect(os.ttyname(slave))
class Other:
    def __init__(self):
        self.mav = mavutil.mavlink.MAVLink(self, 2, 1)
    def write(self, data):
        os.write(master, data)
    def recv_match(self, **_):
        msg = self.mav.parse_char(b"")
        while msg is None:
            msg = self.mav.parse_char(os.read(master, 65536))
        return msg
other = Other()
""",
    "child": """
one = other = connect("exec:/bin/cat")
""",
}


@pytest.mark.parametrize("kind", PAIRS)
def test_a_storm_of_signals_loses_no_message(kind: str) -> None:
    """Waits go on behind a handler that returns, and frames stay whole."""
    if kind == "serial":
        pytest.importorskip("serial")
    done = python(f"""{STORM}{PAIRS[kind]}
storm()
number = 0
while seen < 60 or number < 200:
    for sender, receiver in ((other, one), (one, other)):
        first, number = number, number + 20
        for n in range(first, number):
            sender.mav.heartbeat_send(2, 3, 81, n, 4)
        assert heard(receiver) == list(range(first, number))
signal.setitimer(signal.ITIMER_REAL, 0)
assert one.mav_loss == 0
""")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("blocked", [False, True])
def test_a_storm_of_signals_over_a_bridge(blocked: bool) -> None:
    """With the signals blocked in the thread of the program they reach those of the bridge."""
    done = python(f"""{STORM}
one, other = connect("tcpin:127.0.0.1:0"), connect("udpin:127.0.0.1:0")
links = ["tcp:127.0.0.1:%d" % one.listen.getsockname()[1], "udpout:127.0.0.1:%d" % other.port.getsockname()[1]]
with Bridge(links) as bridge:
    while other.recv_match() is None or one.recv_match() is None:
        bridge.send(heartbeat(sysid=9))
    storm()
    number = rounds = 0
    while rounds < 20 or not ({blocked} or seen >= 60):
        if {blocked}:
            signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM])
        rounds += 1
        first, number = number, number + 20
        for n in range(first, number):
            one.mav.heartbeat_send(2, 3, 81, n, 4)
        found = []
        while len(found) < 20:
            msg = other.recv_match(type="HEARTBEAT", blocking=True, timeout=60)
            if msg.get_srcSystem() != 9:
                found.append(msg.custom_mode)
        assert found == list(range(first, number))
    signal.setitimer(signal.ITIMER_REAL, 0)
""")
    assert done.returncode == 0, done.stderr


FORMATS = {
    "csv": ["convert", "LOG", "-o", "OUT", "--format", "csv"],
    "mcap": ["convert", "LOG", "-o", "OUT", "--format", "mcap"],
    "parquet": ["convert", "LOG", "-o", "OUT"],
    "repair": ["repair", "LOG", "-o", "OUT/made.tlog"],
    "merge": ["merge", "LOG", "LOG", "-o", "OUT/made.tlog"],
}


def test_a_storm_of_signals_changes_no_conversion(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    traffic.generate(log, 1000)
    done = python(f"""{STORM}
import pathlib
from mavwire import cli
log, folder = sys.argv[1:]
def made(where):
    found = dict[str, bytes]()
    for name, words in {FORMATS!r}.items():
        out = pathlib.Path(folder, where, name)
        out.mkdir(parents=True)
        words = [word.replace("LOG", log).replace("OUT", str(out)) for word in words]
        assert cli.main([*words, "--quiet"]) == 0, name
        for one in sorted(out.rglob("*")):
            if one.is_file() and one.name != "manifest.json":
                found[str(one.relative_to(pathlib.Path(folder, where)))] = one.read_bytes()
    return found
quiet = made("quiet")
assert len(quiet) >= {len(FORMATS)}
storm()
turn = 0
while seen < 60 or not turn:
    turn += 1
    assert made(str(turn)) == quiet
signal.setitimer(signal.ITIMER_REAL, 0)
""", str(log), str(tmp_path / "out"))  # fmt: skip
    assert done.returncode == 0, done.stderr


def stop(process: subprocess.Popen[str]) -> None:
    """Returns when it stands still."""
    process.send_signal(signal.SIGSTOP)
    assert os.WIFSTOPPED(os.waitpid(process.pid, os.WUNTRACED)[1])


RECORDER = """
import sys
from mavwire import mavutil
link = mavutil.mavlink_connection(sys.argv[1])
link.setup_logfile(sys.argv[2])
while True:
    link.recv_match(blocking=True)
"""
PAUSE = 1.3
"""Seconds that a process stands still: longer than it keeps records back, or a timeout of a second."""


def test_a_recorder_that_stood_still_has_recorded_all(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(LIMIT)
        device = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        command = [sys.executable, "-c", RECORDER, device, str(path)]
        with subprocess.Popen(command, env=ENVIRONMENT, text=True) as process:
            peer = server.accept()[0]
            with peer:
                peer.sendall(b"".join(heartbeat(n) for n in range(100)))
                wait_until("the log", path.exists)
                stop(process)
                peer.sendall(b"".join(heartbeat(n) for n in range(100, 250)))
                time.sleep(PAUSE)
                process.send_signal(signal.SIGCONT)
                wait_until("what came meanwhile", lambda: path.stat().st_size >= 250 * 29)
                process.kill()
    assert [msg.get_seq() for msg in open_log(path)] == list(range(250))


WAITER = """
import sys
from mavwire import mavutil
link = mavutil.mavlink_connection(sys.argv[1])
print("waiting", flush=True)
first = link.recv_match(type="HEARTBEAT", blocking=True, timeout=float(sys.argv[2]))
print(first if first is None else first.get_seq(), flush=True)
print(link.recv_match(type="HEARTBEAT", blocking=True, timeout=60).get_seq(), flush=True)
"""


@pytest.mark.parametrize("timeout", [0.5, 60])
def test_a_timeout_while_standing_still_loses_no_message(timeout: float) -> None:
    """One that has passed meanwhile ends the wait, and what came is handed out then or by the next call."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(LIMIT)
        device = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        command = [sys.executable, "-c", WAITER, device, str(timeout)]
        with subprocess.Popen(
            command, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True
        ) as process:
            peer = server.accept()[0]
            assert process.stdout is not None
            assert process.stdout.readline() == "waiting\n"
            stop(process)
            time.sleep(PAUSE)
            with peer:
                peer.sendall(heartbeat(1))
                process.send_signal(signal.SIGCONT)
                told = process.stdout.readline().strip()
                if timeout > PAUSE:
                    assert told == "1"
                peer.sendall(heartbeat(2))
                assert process.stdout.readline().strip() == ("1" if told == "None" else "2")
            assert process.wait(LIMIT) == 0


def test_a_bridge_that_stood_still_goes_on(tmp_path: Path) -> None:
    """What came meanwhile is forwarded, and who sent it is no silent peer."""
    with mavwire("bridge", "udpin:127.0.0.1:0", "--record", str(tmp_path)) as (process, lines):
        (number,) = announced_ports(lines)
        with udp_peer() as vehicle, udp_peer() as station:
            for peer, system in ((station, 255), (vehicle, 1)):
                peer.connect(("127.0.0.1", number))
                peer.send(heartbeat(0, sysid=system))
            assert station.recv(300) == heartbeat(0)
            stop(process)
            for n in range(1, 100):
                vehicle.send(heartbeat(n))
            time.sleep(PAUSE)
            process.send_signal(signal.SIGCONT)
            received = b""
            while len(received) < 99 * len(heartbeat()):
                received += station.recv(65536)
            assert received == b"".join(heartbeat(n) for n in range(1, 100))
            process.terminate()
            assert process.wait(LIMIT) == 0
    (path,) = tmp_path.iterdir()
    assert sum(1 for _ in open_log(path)) == 101


# Each makes `link`, has its other end go, and sends on: `gone` says when the link has noticed.
GONE = {
    "tcp": """
server = socket.create_server(("127.0.0.1", 0))
link = connect("tcp:127.0.0.1:%d" % server.getsockname()[1])
server.accept()[0].close()
gone = lambda: link.port is None
""",
    "uds": """
import tempfile
path = os.path.join(tempfile.mkdtemp(), "socket")
server = socket.socket(socket.AF_UNIX)
server.bind(path)
server.listen()
link = connect("uds:" + path)
server.accept()[0].close()
gone = lambda: link.port is None
""",
    "tcpin": """
link = connect("tcpin:127.0.0.1:0")
client = socket.create_connection(link.listen.getsockname())
wait_until("the client", lambda: link.recv_msg() or link.port is not None)
client.close()
gone = lambda: link.port is None
""",
    "bridge": """
server = socket.create_server(("127.0.0.1", 0))
link = Bridge(["tcp:127.0.0.1:%d" % server.getsockname()[1]])
link.start()
link.mav = mavutil.mavlink.MAVLink(link, 1, 1)
link.write = link.send
server.accept()[0].close()
gone = lambda: link.stats()["links"][0]["connections"] > 1
""",
}


@pytest.mark.skipif(sys.platform != "linux", reason="MSG_NOSIGNAL")
@pytest.mark.parametrize("kind", GONE)
def test_who_hangs_up_does_not_end_a_program_that_restored_sigpipe(kind: str) -> None:
    """R64: as programs do whose output goes to `head`."""
    done = python(f"""{STORM}
signal.signal(signal.SIGPIPE, signal.SIG_DFL)
{GONE[kind]}
def sent():
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    return gone()
wait_until("the end", sent)
for _ in range(3):
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
assert signal.getsignal(signal.SIGPIPE) is signal.SIG_DFL
print("alive", flush=True)
os._exit(0)
""")
    assert (done.returncode, done.stdout.splitlines()[-1:]) == (0, ["alive"]), done.stderr


class Interrupted(Exception):
    """What the handler raises."""


@pytest.mark.parametrize("name", ["_posted", "_timestamp"])
def test_what_a_handler_raises_is_not_lost_while_an_attribute_is_looked_for(name: str) -> None:
    """Looked for in a loop without Python code, so that the signal is seen by native code or behind the loop."""
    mav = apm.MAVLink(None)
    frame = bytes(apm.MAVLink_attitude_message(1, 2, 3, 4, 5, 6, 7).pack(mav))
    received = mav.parse_buffer(frame * 1000)
    assert received is not None

    def handle(*_: object) -> None:
        raise Interrupted

    before = signal.signal(signal.SIGALRM, handle)
    try:
        for _ in range(10):
            with pytest.raises(Interrupted):
                signal.setitimer(signal.ITIMER_REAL, 0.0005)
                for _ in range(1000):
                    deque(map(getattr, received, repeat(name), repeat(None)), 0)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
