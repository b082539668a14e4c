"""Logs in a loop: everything in order, in step with the state, and others get their turn."""

from __future__ import annotations

import asyncio
import os

import pytest
from mavwire import aio, mavutil, traffic
from unit.aio_tools import attitude, eventually, number, refusals, run
from unit.link_tools import T0, drain, heartbeat, pack, record


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 5000, seed=3)
    return str(path)


def expected(path, **kw):
    log = mavutil.mavlink_connection(path)
    found = [(msg.get_type(), msg._timestamp) for msg in drain(log, **kw)]
    log.close()
    return found


def test_everything_in_order_and_the_end(path):
    async def main():
        async with aio.connect(path) as log:
            found = [(msg.get_type(), msg._timestamp) async for msg in log]
            assert found == expected(path)
            assert await log.recv_match() is await log.recv_msg() is None
            log.sync.rewind()
            assert (await log.recv_msg()).get_type() == found[0][0]
            assert log.dropped == log.frames_dropped == 0

    run(main())


def test_types_and_conditions(path):
    async def main():
        async with aio.connect(path) as log:
            condition = "VFR_HUD.alt>VFR_HUD.groundspeed"
            found = []
            while (msg := await log.recv_match(condition, ["ATTITUDE", "VFR_HUD"])) is not None:
                found.append((msg.get_type(), msg._timestamp))
        assert found == expected(path, condition=condition, type=["ATTITUDE", "VFR_HUD"])
        async with aio.connect(path) as log:
            found = [(msg.get_type(), msg._timestamp) async for msg in log.stream("ATTITUDE")]
        assert found == expected(path, type="ATTITUDE") != []

    run(main())


def test_the_state_is_in_step_with_the_message(path):
    async def main():
        async with aio.connect(path) as log:
            async for msg in log.stream("HEARTBEAT"):
                assert log.messages["HEARTBEAT"] == msg or msg.get_srcSystem() != log.target_system
                assert log.latest("HEARTBEAT", msg.get_srcSystem())._timestamp == msg._timestamp

    run(main())


def test_reading_leaves_time_for_others(path):
    """Counted in turns of the loop, whether messages are used or passed over."""

    async def main():
        turns = 0

        async def others():
            nonlocal turns
            while True:
                turns += 1
                await asyncio.sleep(0)

        async with aio.connect(path) as log:
            counting = asyncio.create_task(others())
            count = len([msg async for msg in log])
            assert count == 5000
            assert turns >= count // 256
            log.sync.rewind()
            turns = 0
            assert await log.recv_match(type="NOTHING") is None
            assert turns >= count // 256
            counting.cancel()

    run(main())


def test_two_tasks_share_a_log(path):
    async def main():
        async with aio.connect(path) as log:

            async def read():
                return [msg._timestamp async for msg in log]

            found = await asyncio.gather(read(), read())
            assert sorted(n for one in found for n in one) == sorted(
                time for _, time in expected(path)
            )

    run(main())


def test_timeouts_and_cancelling(path):
    async def main():
        async with aio.connect(path) as log:
            assert await log.recv_match(type="NOTHING", timeout=0) is None
            reading = asyncio.ensure_future(log.recv_match(type="NOTHING"))
            await asyncio.sleep(0)
            reading.cancel()
            with pytest.raises(asyncio.CancelledError):
                await reading
            assert await log.recv_match() is not None

    run(main())


def test_closing_ends_reading(path):
    async def main():
        async with aio.connect(path) as log:
            await log.close()
            assert [msg async for msg in log] == []
            with pytest.raises(aio.LinkClosedError):
                await log.recv_match()
            assert len(set(await refusals(log.recv_match, 5))) == 1, "errors do not grow"

    run(main())


def test_a_log_that_grows(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(record(heartbeat(1), T0))

    async def main():
        async with aio.connect(str(path), append=True) as log:
            for seq in range(1, 4):
                assert [msg.get_seq() async for msg in log] == [seq]
                with path.open("ab") as file:
                    file.write(record(heartbeat(seq + 1), T0 + seq))

    run(main())


def test_writing_a_log(tmp_path):
    path = tmp_path / "new.tlog"

    async def main():
        async with aio.connect(str(path), write=True) as log:
            log.sync.write(record(heartbeat()))
            await log.drain()

    run(main())
    assert path.read_bytes() == record(heartbeat())


def test_progress_is_told_in_the_loop(path):
    async def main():
        told = []
        loop = asyncio.get_running_loop()

        def progress(percent):
            assert asyncio.get_running_loop() is loop
            told.append(percent)

        async with aio.connect(path, progress_callback=progress):
            await eventually(lambda: told and told[-1] == 100)

    run(main())


def test_newest_steps_through_a_log(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(b"".join(record(pack(attitude(n), n), T0 + n) for n in range(10)))

    async def main():
        async with aio.connect(os.fspath(path)) as log:
            found = [number(msg) async for msg in log.newest("ATTITUDE", sysid=1)]
            assert found[-9:] == list(range(1, 10))

    run(main())
