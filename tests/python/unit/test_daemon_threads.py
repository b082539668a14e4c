"""A program may end while its daemon threads are inside of mavwire, whatever Python code mavwire calls there."""

from __future__ import annotations

import importlib.util
import struct
import subprocess
import sys
from pathlib import Path

import pytest
from unit.link_tools import heartbeat

# Ends once the thread has called Python, which it goes on with, and gives it time to do so while the interpreter ends.
PROGRAM = """
import sys, threading, time
from mavwire import mavutil
from mavwire.dialects.v20 import common

called = threading.Event()

def connect(device):
    return mavutil.mavlink_connection(device, dialect="common")

class Lingering:
    def __del__(self, sleep=time.sleep):
        sleep(0.2)

lingering = Lingering()

def callback(*arguments):
    called.set()
    sum(range(1000))

class File:
    write = callback

{setup}

def work():
    while True:
        {step}

threading.Thread(target=work, daemon=True).start()
assert called.wait(60)
"""

UDP = 'link = connect("udpin:127.0.0.1:0")'
MAV = "mav = common.MAVLink(File(), 1, 1); frame = common.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3).pack(mav)"
SEND = "mav.heartbeat_send(2, 3, 0, 0, 4, 3)"

CASES = {
    "idle hook": (f"{UDP}; link.idle_hooks.append(callback)", "link.recv_match(blocking=True)"),
    "log condition": (
        "link = connect(sys.argv[1])",
        'link.recv_match(condition="HEARTBEAT.type==9"); called.set(); link.rewind()',
    ),
    "message hook": (
        "",
        "link = connect(sys.argv[1]); link.message_hooks.append(callback)\n"
        "        while link.recv_match(): pass",
    ),
    "write": (MAV, SEND),
    "send callback": (f"{MAV}; mav.set_send_callback(callback)", SEND),
    "receive callback": (f"{MAV}; mav.set_callback(callback)", "mav.parse_buffer(frame)"),
    "allow unsigned": (
        f"{MAV}; mav.signing.secret_key = bytes(32); mav.robust_parsing = True\n"
        f"mav.signing.allow_unsigned_callback = callback",
        "mav.parse_buffer(frame)",
    ),
    "WebSocket": (
        'link = connect("ws:127.0.0.1:1")',
        "link.recv_match(blocking=True, timeout=0.01); called.set()",
    ),
}


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    frame = heartbeat()
    path.write_bytes(
        b"".join(struct.pack(">Q", 1_700_000_000_000_000 + i) + frame for i in range(20_000))
    )
    return path


@pytest.mark.parametrize("name", CASES)
def test_the_process_ends_normally(name: str, log: Path) -> None:
    if name == "WebSocket" and importlib.util.find_spec("wsproto") is None:
        pytest.skip("wsproto is not installed")
    setup, step = CASES[name]
    program = [sys.executable, "-c", PROGRAM.format(setup=setup, step=step), str(log)]
    for _ in range(2):
        done = subprocess.run(program, capture_output=True, text=True, timeout=120, check=False)
        # The WebSocket link says that nobody answers.
        unexpected = [line for line in done.stderr.splitlines() if "trying again" not in line]
        assert (done.returncode, unexpected) == (0, []), name


LAST_WORDS = """
import os, threading, time
from mavwire.dialects.v20 import common

called = threading.Event()

class File:
    def write(self, data, sleep=time.sleep, called=called.set):
        called()
        sleep(0.001)

mav = common.MAVLink(File(), 1, 1)
beat = common.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3)

class LastWords:
    def __del__(self, send=mav.send, beat=beat, write=os.write):
        try:
            send(beat)
        except Exception:
            pass  # what it takes may be gone by now
        write(1, b"over")

def work():
    while True:
        mav.send(beat)

os.last_words = LastWords()  # goes after the threads
threading.Thread(target=work, daemon=True).start()
assert called.wait(60)
"""


def test_last_words_do_not_wait_for_a_thread_that_never_runs_again() -> None:
    for _ in range(3):
        program = [sys.executable, "-c", LAST_WORDS]
        done = subprocess.run(program, capture_output=True, text=True, timeout=120, check=False)
        assert (done.returncode, done.stdout, done.stderr) == (0, "over", "")
