"""Many links in one loop: idle ones do not wake it, busy ones leave time for the others. Counted, not timed."""

from __future__ import annotations

import asyncio
import selectors
from contextlib import AsyncExitStack

from mavwire import aio
from mavwire.aio.feed import Feed
from mavwire.aio.pump import PORTION
from mavwire.aio.watching import POLL_INTERVAL
from mavwire.dialects.v20 import all as mavlink
from unit.aio_tools import LIMIT, Peer, eventually, run, udp_link
from unit.link_tools import heartbeat

LINKS = 100
# Turns of a loop that nobody wakes but for work; polling a hundred links would take thousands.
FEW = 10
# Large datagrams that a socket holds under the usual limits of Linux.
FLOOD = 100


class Counting(asyncio.SelectorEventLoop):
    """A loop that counts how often it wakes up."""

    def __init__(self):
        super().__init__(selectors.DefaultSelector())
        self.turns = 0
        select = self._selector.select

        def counting(timeout=None):
            self.turns += 1
            return select(timeout)

        self._selector.select = counting


async def many(stack):
    """Links and their peers."""
    found = []
    for _ in range(LINKS):
        link = await stack.enter_async_context(aio.connect("udpin:127.0.0.1:0"))
        peer = Peer(link.sync.port.getsockname()[1])
        stack.callback(peer.sock.close)
        found.append((link, peer))
    return found


def test_idle_links_do_not_wake_the_loop():
    async def main():
        loop = asyncio.get_running_loop()
        async with AsyncExitStack() as stack:
            links = await many(stack)
            waiting = [asyncio.create_task(link.recv_match(type="ATTITUDE")) for link, _ in links]
            await asyncio.sleep(0.05)
            before = loop.turns
            await asyncio.sleep(0.5)
            assert loop.turns - before <= FEW
            # A message wakes it for itself, not for each link.
            before = loop.turns
            links[50][1].attitudes(1)
            await waiting[50]
            assert loop.turns - before <= FEW
            for task in waiting:
                task.cancel()
            await asyncio.gather(*waiting, return_exceptions=True)

    run(main(), Counting)


def test_tasks_wake_for_what_they_want_alone(monkeypatch):
    waits = []
    wait = Feed.wait

    async def counting(*args):
        waits.append(args)
        return await wait(*args)

    monkeypatch.setattr(Feed, "wait", counting)

    async def main():
        async with udp_link() as (link, peer):
            waits.clear()
            waiting = [asyncio.create_task(anext(link.stream("SYSTEM_TIME"))) for _ in range(10)]
            await asyncio.sleep(0)
            peer.attitudes(*range(200))
            await eventually(lambda: link.sync.mav_count == 201)
            assert len(waits) == 10
            peer.send(mavlink.MAVLink_system_time_message(1, 2))
            assert {msg.time_boot_ms for msg in await asyncio.gather(*waiting)} == {2}
            assert len(waits) == 10

    run(main())


def test_a_flood_on_one_link_leaves_time_for_the_others():
    async def main():
        loop = asyncio.get_running_loop()
        async with AsyncExitStack() as stack:
            links = await many(stack)
            flooded, flooder = links[0]
            flood = heartbeat(0, sysid=9) * 60  # messages in a datagram
            for _ in range(FLOOD):
                flooder.sock.send(flood)
            for _, peer in links[1:]:
                peer.attitudes(1)
            before = loop.turns
            for link, _ in links[1:]:
                await link.wait_newer("ATTITUDE", than=flooded, sysid=1, timeout=LIMIT)
            turns = loop.turns - before
            assert turns <= FEW
            assert flooded.sync.mav_count <= (turns + 1) * PORTION
            await eventually(lambda: flooded.sync.mav_count == FLOOD * 60)

    run(main(), Counting)


def test_without_watching_links_are_looked_at_a_hundred_times_a_second():
    """What a proactor loop costs."""

    class Unwatching(Counting):
        def add_reader(self, *args):
            raise NotImplementedError

    async def main():
        loop = asyncio.get_running_loop()
        async with AsyncExitStack() as stack:
            await many(stack)
            before, began = loop.turns, loop.time()
            await eventually(lambda: loop.turns - before >= 100)
            most = LINKS * (loop.time() - began) / POLL_INTERVAL
            assert loop.turns - before <= 2 * most + 100

    run(main(), Unwatching)
