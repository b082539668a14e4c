"""`mavwire.aio`: receiving by several tasks, cancellation, timeouts, slow consumers, errors, closing."""

from __future__ import annotations

import asyncio
import threading

import pytest
from mavwire import aio, mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.aio_tools import LOOPS, WAIT, attitude, eventually, number, refusals, run, take, udp_link
from unit.link_tools import heartbeat as heartbeat_frame
from unit.link_tools import pack


@pytest.fixture(params=LOOPS)
def loop(request):
    return LOOPS[request.param]


def test_messages_arrive_in_order(loop):
    async def main():
        async with udp_link() as (link, peer):
            stream = link.stream("ATTITUDE")
            peer.attitudes(*range(300))
            assert await take(stream, 300) == list(range(300))
            assert (link.dropped, link.sync.mav_loss) == (0, 0)
            assert link.connected and "udpin" not in repr(link)

    run(main(), loop)


def test_a_link_is_opened_by_await_too():
    async def main():
        link = await aio.connect("udpin:127.0.0.1:0", source_system=7)
        assert link.mav.srcSystem == 7
        await link.close()
        await link.close()

    run(main())


def test_wrong_arguments_are_raised():
    async def main():
        with pytest.raises(ValueError, match="not a number"):
            await aio.connect("udpin:127.0.0.1:port")
        with pytest.raises(ValueError, match="resync"):
            await aio.connect("udpin:127.0.0.1:0", resync="never")
        with pytest.raises(ValueError, match="backlog of 0"):
            await aio.connect("udpin:127.0.0.1:0", backlog=0)
        with pytest.raises(FileNotFoundError):
            await aio.connect("/nowhere/flight.tlog")
        with pytest.raises(OSError, match="cannot be found"):
            await aio.connect("udpout:host.invalid:14550")

    run(main())


def test_every_task_receives_everything():
    async def main():
        async with udp_link() as (link, peer):

            async def by_loop():
                found = []
                async for msg in link:
                    if msg.get_type() == "ATTITUDE":
                        found.append(number(msg))
                        if len(found) == 50:
                            return found

            async def by_match():
                return [number(await link.recv_match(type="ATTITUDE")) for _ in range(50)]

            tasks = [asyncio.create_task(task()) for task in (by_loop, by_match, by_match)]
            await asyncio.sleep(0)  # they begin to receive
            peer.attitudes(*range(50))
            assert await asyncio.gather(*tasks) == [list(range(50))] * 3

    run(main())


def test_nothing_is_missed_between_two_calls():
    async def main():
        async with udp_link() as (link, peer):
            assert await link.recv_match(timeout=0) is None
            peer.attitudes(1, 2, 3, 4)
            found = [number(await link.recv_match(type="ATTITUDE"))]
            await asyncio.sleep(0.05)  # the others arrive meanwhile
            peer.attitudes(5)
            found += [number(await link.recv_match(type=["ATTITUDE"])) for _ in range(4)]
            assert found == [1, 2, 3, 4, 5]

    run(main())


def test_waits_that_others_await_miss_nothing():
    """Each wait has a task of its own here; the place is that of the task that called."""

    async def main():
        async with udp_link() as (link, peer):
            assert await link.recv_match(timeout=0) is None
            found = []
            for count in range(10):
                seen = link.sync.mav_count
                peer.attitudes(2 * count, 2 * count + 1)
                await eventually(lambda seen=seen: link.sync.mav_count == seen + 2)
                (one,) = await asyncio.gather(link.recv_msg())
                other = await asyncio.ensure_future(link.recv_match(timeout=WAIT))
                found += [number(one), number(other)]
            assert found == list(range(20))

    run(main())


def test_waits_of_one_task_do_not_take_from_each_other():
    async def main():
        async with udp_link() as (link, peer):
            waits = asyncio.gather(
                link.recv_match(type="ATTITUDE"), link.recv_match(type="HEARTBEAT"),
                link.recv_match(condition="ATTITUDE.time_boot_ms>=2"),
            )  # fmt: skip
            peer.sock.send(heartbeat_frame(7))
            peer.attitudes(1, 2)
            first, beat, later = await waits
            assert [number(first), beat.get_seq(), number(later)] == [1, 7, 2]
            peer.attitudes(3)
            assert number(await link.recv_match(type="ATTITUDE")) == 3

    run(main())


def test_a_cancelled_wait_loses_nothing(loop):
    async def main():
        async with udp_link() as (link, peer):
            await link.recv_match(timeout=0)
            for count in range(1, 21):
                wait = asyncio.ensure_future(link.recv_match(type="ATTITUDE"))
                await asyncio.sleep(0)
                peer.attitudes(count)
                # Cancelled before, while and after it is woken.
                for _ in range(count % 4):
                    await asyncio.sleep(0.001)
                wait.cancel()
                got = await asyncio.gather(wait, return_exceptions=True)
                if isinstance(got[0], asyncio.CancelledError):
                    assert number(await link.recv_match(type="ATTITUDE")) == count
                else:
                    assert number(got[0]) == count

    run(main(), loop)


def test_a_cancelled_iteration_loses_nothing():
    async def main():
        async with udp_link() as (link, peer):
            for stream in (link.stream("ATTITUDE"), aiter(link)):
                for count in range(10):
                    wait = asyncio.create_task(anext(stream))
                    await asyncio.sleep(0)
                    seen = link.sync.mav_count
                    peer.attitudes(count)
                    await eventually(lambda seen=seen: link.sync.mav_count > seen)
                    if wait.cancel():
                        with pytest.raises(asyncio.CancelledError):
                            await wait
                        assert await take(stream, 1) == [count]
                    else:
                        assert number(wait.result()) == count

    run(main())


def test_wait_for_and_timeouts():
    async def main():
        async with udp_link() as (link, peer):
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(link.recv_match(type="ATTITUDE"), 0.02)
            assert await link.recv_match(type="ATTITUDE", timeout=0.02) is None
            assert await link.recv_match(timeout=-1) is None
            with pytest.raises(TimeoutError, match="no heartbeat"):
                await link.wait_heartbeat(sysid=9, timeout=0.02)
            peer.attitudes(1)
            assert number(await asyncio.wait_for(link.recv_match(type="ATTITUDE"), WAIT)) == 1

    run(main())


def test_a_timeout_passes_over_what_did_not_match():
    """As in mavutil: what came while something else was waited for is gone."""

    async def main():
        async with udp_link() as (link, peer):
            wait = asyncio.ensure_future(link.recv_match(type="STATUSTEXT", timeout=0.05))
            await asyncio.sleep(0)
            peer.attitudes(1)
            assert await wait is None
            assert await link.recv_match(type="ATTITUDE", timeout=0) is None

    run(main())


def test_a_slow_consumer_gets_the_newest_backlog_and_a_count():
    async def main():
        async with udp_link(backlog=10) as (link, peer):
            slow, rare = link.stream("ATTITUDE"), link.stream("STATUSTEXT")
            watching = asyncio.create_task(anext(rare))
            for count in range(50):
                peer.attitudes(count)
                await eventually(lambda count=count: link.sync.mav_count > count + 1)
            assert await take(slow, 10) == list(range(40, 50))
            assert (slow.dropped, link.dropped) == (40, 40)
            # What a wait has looked at and did not want is no drop.
            watching.cancel()
            await asyncio.gather(watching, return_exceptions=True)
            peer.send(mavlink.MAVLink_statustext_message(6, b"hello"))
            assert (await anext(rare)).text == "hello"
            assert rare.dropped == 0

    run(main())


def test_several_tasks_share_a_stream():
    async def main():
        async with udp_link() as (link, peer):
            stream = link.stream("ATTITUDE")
            tasks = [asyncio.create_task(take(stream, 10)) for _ in range(3)]
            await asyncio.sleep(0)
            peer.attitudes(*range(30))
            found = await asyncio.gather(*tasks)
            assert sorted(n for one in found for n in one) == list(range(30))
            assert all(one == sorted(one) for one in found)

    run(main())


def test_a_task_that_comes_first_takes_a_message_from_one_that_was_woken():
    async def main():
        async with udp_link() as (link, peer):
            stream = link.stream()
            told, found = asyncio.Event(), []
            link.sync.message_hooks.append(lambda link, msg: told.set())

            async def take_next():
                found.append(number(await anext(stream)))

            async def take_when_told():
                await told.wait()  # which comes before who waits for a message hears of it
                await take_next()

            tasks = [asyncio.create_task(task()) for task in (take_next, take_when_told)]
            await asyncio.sleep(0)
            peer.attitudes(1)
            await eventually(lambda: found)
            peer.attitudes(2)
            await asyncio.wait_for(asyncio.gather(*tasks), WAIT)
            assert found == [1, 2]

    run(main())


def test_filters_by_sender():
    async def main():
        async with udp_link() as (link, peer):
            stream = link.stream("ATTITUDE", sysid=2, compid=5)
            peer.attitudes(1)
            peer.attitudes(2, sysid=2)
            peer.attitudes(3, sysid=2, compid=5)
            peer.attitudes(4, sysid=3, compid=5)
            peer.attitudes(5, sysid=2, compid=5)
            assert await take(stream, 2) == [3, 5]

    run(main())


def test_a_condition_sees_the_message_itself():
    """However many have come since."""

    async def main():
        async with udp_link() as (link, peer):
            stream = link.stream("ATTITUDE", "ATTITUDE.time_boot_ms==3")
            peer.attitudes(*range(10))
            await eventually(lambda: link.sync.mav_count == 11)
            assert await take(stream, 1) == [3]

    run(main())


def test_a_condition_that_cannot_be_evaluated_is_raised_where_it_waits():
    async def main():
        async with udp_link() as (link, peer):
            wait = asyncio.ensure_future(link.recv_match(condition="1 +"))
            await asyncio.sleep(0)
            peer.attitudes(1)
            with pytest.raises(SyntaxError):
                await wait
            stream = link.stream("ATTITUDE")
            peer.attitudes(2)
            assert await take(stream, 1) == [2]

    run(main())


def test_errors_of_hooks_and_of_strict_parsing_reach_who_waits():
    async def main():
        async with udp_link() as (link, peer):
            link.mav.robust_parsing = False
            damaged = bytearray(pack(attitude(1)))
            damaged[-1] ^= 1
            wait = asyncio.ensure_future(link.recv_match(type="ATTITUDE"))
            await asyncio.sleep(0)
            peer.sock.send(damaged)
            with pytest.raises(mavlink.MAVError):
                await wait
            wait = asyncio.ensure_future(link.recv_match(type="ATTITUDE"))
            await asyncio.sleep(0)
            peer.attitudes(2)
            assert number(await wait) == 2

            def hook(_link, msg):
                if number(msg) == 3:
                    raise ZeroDivisionError

            link.sync.message_hooks.append(hook)
            found = []
            asyncio.get_running_loop().set_exception_handler(lambda _, what: found.append(what))
            peer.attitudes(3)
            await eventually(lambda: found)
            assert isinstance(found[0]["exception"], ZeroDivisionError)
            stream = link.stream("ATTITUDE")
            peer.attitudes(4)
            assert await take(stream, 1) == [4]

    run(main())


def test_closing_ends_what_waits(loop):
    async def main():
        async with udp_link() as (link, peer):
            stream = link.stream("ATTITUDE")
            peer.attitudes(1)
            waiting = asyncio.create_task(link.recv_match(type="SYSTEM_TIME"))

            async def iterate():
                return [number(msg) async for msg in stream]

            iterating = asyncio.create_task(iterate())
            await eventually(lambda: link.sync.mav_count == 2)
            await link.close()
            assert await iterating == [1]
            with pytest.raises(aio.LinkClosedError, match="is closed"):
                await waiting
            assert not link.connected
            # This task's place is that of its first call; what came since is still to be had.
            assert [number(msg) async for msg in link] == [1]
            assert [msg async for msg in link] == []
            assert len(set(await refusals(link.recv_match, 5))) == 1, "errors do not grow"
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert link.frames_dropped == 1
            await link.drain()

    run(main(), loop)


def test_a_link_of_mavutil_that_is_closed_behind_the_back_ends():
    async def main():
        async with udp_link() as (link, _):
            wait = asyncio.ensure_future(link.recv_match(type="SYSTEM_TIME"))
            await asyncio.sleep(0)
            link.sync.close()
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            with pytest.raises(aio.LinkClosedError):
                await wait

    run(main())


def test_a_recording_is_whole_when_the_link_is_closed(tmp_path):
    async def main():
        async with udp_link() as (link, peer):
            link.sync.setup_logfile(str(tmp_path / "flight.tlog"))
            link.sync.setup_logfile_raw(str(tmp_path / "flight.raw"))
            peer.attitudes(*range(50))
            await eventually(lambda: link.sync.mav_count == 51)
        log = mavutil.mavlink_connection(str(tmp_path / "flight.tlog"))
        assert [number(log.recv_msg()) for _ in range(50)] == list(range(50))
        assert log.recv_msg() is None
        raw = (tmp_path / "flight.raw").read_bytes()
        assert len(mavlink.MAVLink(None).parse_buffer(raw)) == 50
        for file in (link.sync.logfile, link.sync.logfile_raw):
            file.close()

    run(main())


def test_no_thread_is_left_behind():
    async def main():
        before = set(threading.enumerate())
        async with udp_link() as (_, peer):
            peer.attitudes(1)
            await eventually(lambda: before.issuperset(threading.enumerate()))
        await eventually(lambda: before.issuperset(threading.enumerate()))

    run(main())


def test_a_link_that_was_opened_by_mavutil():
    async def main():
        sync = mavutil.mavlink_connection("udpin:127.0.0.1:0")
        async with aio.Link(sync) as link:
            assert link.sync is sync
        assert sync.port.fileno() == -1

    run(main())
