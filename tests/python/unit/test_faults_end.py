"""Programs that end with links, logs and bridges open, threads that share them, and clocks that step."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mavwire import Bridge, mavutil, open_log, traffic
from mavwire.links import signing
from unit.faults import python
from unit.link_tools import KEY, Capture, heartbeat
from watchdog import watched

DAY = 86_400

LIVE = """
import asyncio, os, sys, threading
os.environ["MAVLINK20"] = "1"
import mavwire
from mavwire import aio, mavutil
log, recorded, way = sys.argv[1:]
links = [mavutil.mavlink_connection(device) for device in ("udpin:127.0.0.1:0", "tcpin:127.0.0.1:0", "mcast:", log)]
link = links[0]
link.setup_logfile(recorded)
link.setup_signing(bytes(32))
out = mavutil.mavlink_connection(f"udpout:127.0.0.1:{link.port.getsockname()[1]}")
out.setup_signing(bytes(32))
for n in range(100):
    out.mav.heartbeat_send(1, 2, 3, n, 5)
    assert link.recv_match(blocking=True, timeout=60)
bridge = mavwire.Bridge(["udpin:127.0.0.1:0", "tcp:127.0.0.1:1"])
bridge.start()
frames = bridge.frames()
other = mavwire.open_log(log)
messages = iter(other)
next(messages)
ways = [lambda: link.recv_match(blocking=True), lambda: [frames.next(60) for _ in range(9)],
        lambda: [sum(1 for _ in other) for _ in range(1000)], lambda: out.mav.heartbeat_send(1, 2, 3, 4, 5)]
def forever(call):
    while True:
        call()
for call in ways[: 3 if way == "error" else 4]:
    threading.Thread(target=forever, args=(call,), daemon=True).start()
async def hang():
    link = await aio.connect("udpin:127.0.0.1:0")
    asyncio.get_running_loop().create_task(link.recv_msg())
asyncio.run(hang())
if way == "error":
    raise SystemExit("over")
if way == "exit":
    sys.exit(0)
"""


@pytest.mark.skipif(os.name != "posix", reason="multicast and closing differ elsewhere")
@pytest.mark.parametrize(("way", "code"), [("end", 0), ("exit", 0), ("error", 1)])
def test_a_program_ends_with_everything_open(way: str, code: int, tmp_path: Path) -> None:
    """What a link recorded is in its file."""
    log, recorded = tmp_path / "flight.tlog", tmp_path / "recorded.tlog"
    traffic.generate(log, 2000)
    for _ in range(2):
        done = python(LIVE, str(log), str(recorded), way)
        assert (done.returncode, done.stderr) == (code, "over\n" if code else "")
        modes = [msg.custom_mode for msg in open_log(recorded)]
        assert modes[:100] == list(range(100))


def at_once(*jobs: Callable[[], object]) -> list[BaseException]:
    """Run jobs in threads; what they raised."""
    raised: list[BaseException] = []

    def run(job: Callable[[], object]) -> None:
        try:
            job()
        except BaseException as error:
            raised.append(error)

    threads = [threading.Thread(target=run, args=(job,), daemon=True) for job in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
        assert not thread.is_alive()
    return raised


def test_threads_share_a_log_by_mavutil(tmp_path: Path) -> None:
    """Each message goes to one of them, whatever the others ask for."""
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 4000)
    with mavutil.mavlink_connection(str(path)) as log, watched():
        seen: list[list[int]] = [[] for _ in range(6)]

        def read(own: list[int]) -> None:
            while (msg := log.recv_msg()) is not None:
                own.append(msg.get_seq())

        assert at_once(*(lambda own=own: read(own) for own in seen)) == []
        assert sum(map(len, seen)) == 4000

        def jump() -> None:
            for _ in range(50):
                log.rewind()
                log.recv_match(type="ATTITUDE")

        assert at_once(jump, jump, lambda: read([]), lambda: read([])) == []
        log.rewind()
        assert sum(1 for _ in iter(log.recv_msg, None)) == 4000


def test_a_log_is_closed_under_threads_that_read_it(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 4000)
    for _ in range(10):
        log = mavutil.mavlink_connection(str(path))
        started = threading.Barrier(3)

        def read(log: Any = log, started: Any = started) -> None:
            started.wait()
            while log.recv_msg() is not None:
                pass

        def close(log: Any = log, started: Any = started) -> None:
            started.wait()
            log.close()

        assert all(isinstance(one, (OSError, ValueError)) for one in at_once(read, read, close))


def test_threads_share_the_tables_of_a_log(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 4000)
    log = open_log(path)
    whole = {name: len(log[name]) for name in ("ATTITUDE", "HEARTBEAT", "GPS_RAW_INT")}

    def look() -> None:
        for name, count in whole.items():
            assert len(log[name]) == len(open_log(path)[name]) == count

    assert at_once(*[look] * 6) == []


def test_threads_share_a_bridge() -> None:
    """They send, look, add and remove links, and wait for frames while it is stopped."""
    bridge = Bridge(["udpin:127.0.0.1:0"])
    bridge.start()

    def change() -> None:
        for _ in range(20):
            bridge.remove(bridge.add("udpin:127.0.0.1:0", name=f"{threading.get_ident()}"))

    def use() -> None:
        for seq in range(100):
            bridge.send(heartbeat(seq))
            bridge.stats()

    def wait() -> None:
        for _ in bridge.frames():
            pass

    waiting = [threading.Thread(target=wait, daemon=True) for _ in range(3)]
    for thread in waiting:
        thread.start()
    assert at_once(change, change, use, use) == []
    bridge.stop()
    for thread in waiting:
        thread.join(60)
        assert not thread.is_alive()


class Clock:
    """`time.time` with a clock on the wall that somebody sets."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.ahead = 0.0
        real = time.time
        monkeypatch.setattr(time, "time", lambda: real() + self.ahead)


def test_a_clock_that_steps_disturbs_no_link(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """R34, R35. Timeouts and peers are a matter of time that passes, signatures only ever move on."""
    clock = Clock(monkeypatch)
    monkeypatch.setenv("MAVLINK20", "1")
    path = tmp_path / "flight.tlog"
    steps = [0, DAY, -400 * DAY, 7, -3 * DAY, 400 * DAY]
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, watched():
        link.setup_logfile(str(path))
        address = f"127.0.0.1:{link.port.getsockname()[1]}"
        with mavutil.mavlink_connection(f"udpout:{address}") as out:
            for one in (link, out):
                one.setup_signing(KEY)
            stamps = []
            for step in steps:
                clock.ahead = step
                out.mav.heartbeat_send(1, 2, 3, 4, 5)
                msg = link.recv_match(blocking=True, timeout=60)
                assert msg.get_signed(), step
                stamps.append(int.from_bytes(msg.get_msgbuf()[-12:-6], "little"))
                assert len(link.clients) == 1, "the peer has not been silent"
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                assert out.recv_match(blocking=True, timeout=60).get_signed(), step
                threading.Timer(0.02, lambda: setattr(clock, "ahead", -1000 * DAY)).start()
                assert link.recv_match(blocking=True, timeout=0.1) is None
        assert stamps == sorted(set(stamps))
    times = [msg._timestamp for msg in open_log(path)]
    assert [round((one - times[0]) / DAY) for one in times] == [round(one / DAY) for one in steps]


def test_signing_begins_behind_a_clock_that_was_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock of 1970, as computers without a battery have it, signs from the epoch of signing on."""
    clock = Clock(monkeypatch)
    clock.ahead = -time.time()
    assert signing.signing_timestamp(time.time()) == 0
    link = Capture()
    link.setup_signing(KEY)
    before = link.mav.signing.timestamp
    clock.ahead = 0.0
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert before < DAY * 100_000 < link.mav.signing.timestamp
