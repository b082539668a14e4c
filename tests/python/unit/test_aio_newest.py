"""The newest value instead of a backlog: `latest` and `age` on all links, `newest` and `wait_newer` in loops."""

from __future__ import annotations

import asyncio
import math

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.aio_tools import attitude, eventually, number, run, udp_link
from unit.link_tools import T0, Capture, drain, heartbeat, pack, record

pytestmark = pytest.mark.usefixtures("mavlink20")


@pytest.fixture
def link(monkeypatch):
    """A link that has heard two systems, one of which has two components, at times 100, 101, ..."""
    now = iter(range(100, 200))
    monkeypatch.setattr("time.time", lambda: float(next(now)))
    link = Capture()
    link.rx += heartbeat()
    link.rx += pack(attitude(1), 1) + pack(attitude(2), 0, sysid=2)
    link.rx += pack(attitude(3), 2) + pack(attitude(4), 0, compid=100)
    drain(link)
    monkeypatch.setattr("time.time", lambda: 150.0)
    return link


def test_the_newest_message_by_system_and_component(link):
    assert number(link.latest("ATTITUDE")) == 4
    assert [number(link.latest("ATTITUDE", sysid)) for sysid in (1, 2)] == [4, 2]
    assert [number(link.latest("ATTITUDE", compid=compid)) for compid in (1, 100)] == [3, 4]
    assert link.latest("ATTITUDE", 3) is link.latest("VFR_HUD") is None
    assert link.latest("ATTITUDE", 1, 7) is link.latest("HEARTBEAT", 2) is None


def test_its_age(link):
    newest = link.latest("ATTITUDE")
    assert link.age("ATTITUDE") == 150.0 - newest._timestamp > 0
    assert link.age("ATTITUDE", 2) > link.age("ATTITUDE", compid=1) > link.age("ATTITUDE")
    assert link.age("VFR_HUD") == math.inf
    age = link.age("ATTITUDE")
    assert link.latest("ATTITUDE", max_age=age) is newest
    assert link.latest("ATTITUDE", max_age=age - 0.5) is None


def test_a_clock_that_is_set_back_makes_nothing_younger_than_new(link, monkeypatch):
    monkeypatch.setattr("time.time", lambda: 1.0)
    assert link.age("ATTITUDE") == 0.0


def test_the_target_that_is_set_counts(link):
    link.target_system = 2
    assert number(link.latest("ATTITUDE")) == 2


def test_the_age_in_a_log_is_that_of_its_records(tmp_path):
    path = tmp_path / "a.tlog"
    frames = [heartbeat(), pack(attitude(1), 1), heartbeat(2)]
    path.write_bytes(b"".join(record(f, T0 + n * 2_000_000) for n, f in enumerate(frames)))
    log = mavutil.mavlink_connection(str(path))
    drain(log)
    assert log.age("ATTITUDE") == pytest.approx(2.0)
    assert log.age("HEARTBEAT") == 0.0
    log.close()


def test_instances():
    link = Capture()
    for id in (0, 1, 0):
        msg = mavlink.MAVLink_battery_status_message(id, 0, 0, 0, [0] * 10, id, 0, 0, 50)
        link.rx += pack(msg)
    drain(link)
    assert link.latest("BATTERY_STATUS[1]", 1).id == 1
    assert link.latest("BATTERY_STATUS", 1).id == 0


# -- in a loop


def test_a_slow_consumer_gets_the_present():
    async def main():
        async with udp_link() as (link, peer):
            newest = link.newest("ATTITUDE", sysid=1)
            for round in range(3):
                first = 100 * round
                peer.attitudes(*range(first, first + 20))
                await eventually(lambda: link.sync.mav_count == 1 + 20 * (round + 1))  # noqa: B023
                assert number(await anext(newest)) == first + 19
                assert number(link.latest("ATTITUDE")) == first + 19
                assert 0 <= link.age("ATTITUDE") < 60
            waiting = asyncio.ensure_future(anext(newest))
            peer.attitudes(5, sysid=2)
            peer.attitudes(6, compid=9)
            assert number(await waiting) == 6
            await link.close()
            assert [msg async for msg in newest] == []

    run(main())


def test_a_quick_consumer_gets_each_once():
    async def main():
        async with udp_link() as (link, peer):
            found = []
            newest = link.newest("ATTITUDE")
            for count in range(20):
                peer.attitudes(count)
                found.append(number(await anext(newest)))
            assert found == list(range(20))

    run(main())


def test_waiting_for_a_newer_one():
    async def main():
        async with udp_link() as (link, peer):
            with pytest.raises(TimeoutError, match="no newer ATTITUDE"):
                await link.wait_newer("ATTITUDE", timeout=0.02)
            peer.attitudes(1)
            old = await link.wait_newer("ATTITUDE")
            with pytest.raises(TimeoutError):
                await link.wait_newer("ATTITUDE", timeout=0.02)
            waiting = asyncio.ensure_future(link.wait_newer("ATTITUDE", compid=1))
            await asyncio.sleep(0)
            peer.attitudes(2, compid=7)
            peer.attitudes(3)
            new = await waiting
            assert number(new) == 3
            # One that has come already counts, for who knows an older one.
            assert await link.wait_newer("ATTITUDE", than=old) is new

    run(main())


def test_instances_in_a_loop():
    def battery(id, current):
        return mavlink.MAVLink_battery_status_message(id, 0, 0, 0, [0] * 10, current, 0, 0, 50)

    async def main():
        async with udp_link() as (link, peer):
            newest = link.newest("BATTERY_STATUS[1]")
            waiting = asyncio.ensure_future(anext(newest))
            for current in range(5):
                peer.send(battery(0, 100 + current))
            peer.send(battery(1, 7))
            peer.send(battery(0, 200))
            assert (await waiting).current_battery == 7
            waiting = asyncio.ensure_future(anext(newest))
            peer.send(battery(1, 8))
            assert (await waiting).current_battery == 8

    run(main())
