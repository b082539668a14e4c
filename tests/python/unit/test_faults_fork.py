"""Processes that fork: what was in use goes on in the parent, and the child can use it too or make its own."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from mavwire import traffic
from unit.faults import FORKS, python

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")

CASES = {
    "a log by mavutil": """
log = connect(path)
first = [log.recv_msg() for _ in range(100)]
def each():
    assert count(log) == 1900
forks(each, each)
""",
    "the messages of a log": """
log = mavwire.open_log(path)
messages = iter(log)
next(messages)
def each():
    assert sum(1 for _ in messages) == 1999
    assert sum(1 for _ in log) == 2000
forks(each, each)
""",
    "logs in a pool": """
import multiprocessing
log = mavwire.open_log(path)
next(iter(log))
def messages(path):
    return sum(1 for _ in mavwire.open_log(path))
with multiprocessing.get_context("fork").Pool(2) as pool:
    assert pool.map(messages, [path] * 4) == [2000] * 4
""",
    "the HTTP server of a bridge": """
from mavwire.bridge.metrics import MetricsServer
with mavwire.Bridge() as bridge, MetricsServer(bridge, "127.0.0.1", 0) as server:
    forks(server.close)
""",
    "a link": """
link, out = udp()
def each():
    out.mav.heartbeat_send(1, 2, 3, 4, 5)
    assert link.recv_match(blocking=True, timeout=60)
each()
def child():
    each()
    link.close()
forks(child, each)
""",
    "a signed link": """
link, out = udp()
for one in (link, out):
    one.setup_signing(bytes(32))
def each():
    out.mav.heartbeat_send(1, 2, 3, 4, 5)
    assert link.recv_match(blocking=True, timeout=60).get_signed()
each()
forks(each)
""",
    "a link that another thread waits on": """
link, out = udp()
out.mav.heartbeat_send(1, 2, 3, 4, 5)
while link.recv_match(blocking=True, timeout=0.01):  # all that is needed is imported
    pass
def receive():
    while True:
        link.recv_match(blocking=True)
threading.Thread(target=receive, daemon=True).start()
def child():
    own, to_own = udp()
    to_own.mav.heartbeat_send(1, 2, 3, 4, 5)
    assert own.recv_match(blocking=True, timeout=60)
    link.recv_match()
forks(child, times=5)
""",
    "a link that another thread sends on": """
link, out = udp()
out.mav.heartbeat_send(1, 2, 3, 4, 5)
def send():
    while True:
        out.mav.heartbeat_send(1, 2, 3, 4, 5)
for _ in range(2):
    threading.Thread(target=send, daemon=True).start()
def child():
    out.mav.heartbeat_send(1, 2, 3, 4, 5)
    threads = [threading.Thread(target=out.mav.heartbeat_send, args=(1, 2, 3, 4, 5)) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
forks(child, times=5)
""",
    "messages that are sent for the first time": """
import time
link, out = udp()
out.mav.heartbeat_send(1, 2, 3, 4, 5)  # what Python imports to send at all
begun = threading.Event()
def send():
    begun.set()
    out.mav.system_time_send(1, 2)
    out.mav.attitude_send(1, 2, 3, 4, 5, 6, 7)
    out.mav.battery_status_send(0, 0, 0, 0, [0] * 10, 0, 0, 0, 0)
threading.Thread(target=send, daemon=True).start()
begun.wait()
def child():
    own, to_own = udp()
    to_own.mav.system_time_send(1, 2)
    to_own.mav.battery_status_send(0, 0, 0, 0, [0] * 10, 0, 0, 0, 0)
    assert own.recv_match(type="SYSTEM_TIME", blocking=True, timeout=60)
forks(child, times=5)
known = set(sys.modules)
out.mav.gps_raw_int_send(0, 3, 1, 2, 3, 4, 5, 6, 7, 8)
assert set(sys.modules) == known
""",
    "a parser that another thread feeds": """
from mavwire.dialects.v20 import common
mav = common.MAVLink(None)
frame = common.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3).pack(mav)
mav.parse_buffer(frame)
def parse():
    while True:
        mav.parse_buffer(frame * 1000)
threading.Thread(target=parse, daemon=True).start()
def child():
    assert mav.parse_buffer(frame)
forks(child, times=5)
""",
    "a log that another thread reads": """
log, other = connect(path), mavwire.open_log(path)
def read():
    while True:
        count(log)
        log.rewind()
        sum(1 for _ in other)
threading.Thread(target=read, daemon=True).start()
def child():
    log.rewind()
    count(log)
    assert sum(1 for _ in other) == 2000
forks(child, times=5)
""",
    "a loop": """
import asyncio
async def hear():
    async with aio.connect("udpin:127.0.0.1:0") as link:
        out = connect(f"udpout:127.0.0.1:{link.sync.port.getsockname()[1]}")
        out.mav.heartbeat_send(1, 2, 3, 4, 5)
        assert await link.recv_match(type="HEARTBEAT", timeout=60)
def each():
    asyncio.run(hear())
each()
forks(each, each)
""",
    "a bridge": """
bridge = mavwire.Bridge(["udpin:127.0.0.1:0"])
bridge.start()
frames = bridge.frames()
def child():
    try:
        bridge.stats()
    except mavwire.bridge.BridgeError:
        pass
    bridge.stop()
    with mavwire.Bridge(["udpin:127.0.0.1:0"]) as own:
        assert own.stats()["links"]
forks(child, lambda: bridge.stats() and bridge.stop())
""",
}


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "flight.tlog"
    traffic.generate(path, 2000)
    return path


@pytest.mark.parametrize("name", CASES)
def test_what_is_in_use_survives_a_fork(name: str, log: Path) -> None:
    done = python(FORKS + CASES[name], str(log))
    assert (done.returncode, done.stderr) == (0, ""), name
