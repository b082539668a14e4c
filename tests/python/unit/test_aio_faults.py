"""Odd arguments, cancelled tasks and a lack of descriptors under `mavwire.aio`."""

from __future__ import annotations

import asyncio
import errno
import gc
import os
import socket
import sys
import threading
from pathlib import Path

import pytest
from mavwire import aio, mavutil, traffic
from mavwire.aio.background import in_background
from mavwire.aio.deadline import deadline_after
from unit.aio_tools import LOOPS, WAIT, attitude, eventually, run, udp_link
from unit.faults import python
from unit.link_tools import KEY

NAN = float("nan")


@pytest.mark.parametrize("kind", [str, Path, os.fsencode])
def test_a_log_is_named_by_a_path_of_any_kind(kind, tmp_path):
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 100, seed=3)

    async def main():
        async with aio.connect(kind(path)) as log:
            assert len([msg async for msg in log]) == 100

    run(main())


def test_signing_takes_what_mavutils_takes_in_its_order():
    def allow(mav, msgid):
        return True

    async def main():
        async with udp_link() as (link, _):
            await link.setup_signing(KEY, False, allow, 5_000_000, 9)
            signing = link.mav.signing
            assert (signing.sign_outgoing, signing.link_id) == (False, 9)
            assert signing.allow_unsigned_callback is not None
            assert signing.timestamp >= 5_000_000

    run(main())


@pytest.mark.parametrize("loop", LOOPS)
def test_a_time_that_is_no_number_is_refused_and_nobody_waits(loop):
    async def main():
        async with udp_link() as (link, _):
            waits = [
                lambda: link.recv_match(timeout=NAN),
                lambda: link.wait_heartbeat(timeout=NAN),
                lambda: link.wait_newer("HEARTBEAT", timeout=NAN),
                lambda: link.param_get("A", sysid=1, timeout=NAN),
                lambda: link.param_set("A", 1, sysid=1, timeout=NAN),
                lambda: link.param_fetch_all(sysid=1, timeout=NAN),
                lambda: link.command(1, sysid=1, timeout=NAN),
                lambda: link.request_message("HEARTBEAT", sysid=1, timeout=NAN),
                lambda: link.set_message_interval("HEARTBEAT", NAN, sysid=1),
            ]
            for wait in waits:
                with pytest.raises(ValueError, match="nan is not"):
                    await wait()
            for rate in (-5, float("inf")):
                with pytest.raises(ValueError, match="is not"):
                    await link.set_message_interval("HEARTBEAT", rate, sysid=1)
            with pytest.raises(TypeError, match="not by 30"):
                await link.request_message(30, sysid=1)

    run(main(), LOOPS[loop])


def test_a_time_without_end_never_comes():
    async def main():
        loop = asyncio.get_running_loop()
        assert deadline_after(loop, None) is deadline_after(loop, float("inf")) is None
        assert deadline_after(loop, 1) > loop.time()

    run(main())


def test_who_is_cancelled_does_not_wait_for_a_peer_that_reads_slowly():
    async def main():
        async def drain():
            raise AssertionError("it waits")

        with pytest.raises(asyncio.CancelledError):
            async with aio.connect("udpout:127.0.0.1:9") as link:
                link._live.outgoing.drain = drain
                raise asyncio.CancelledError
        assert not link.connected

    run(main())


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of descriptors differ")
def test_without_descriptors_a_server_says_so_once():
    program = """
import asyncio, os, resource, socket
from mavwire import aio
from unit.link_tools import heartbeat

async def main():
    async with aio.connect("tcpin:127.0.0.1:0") as link:
        client = socket.socket()
        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (64, hard))
        used = []
        try:
            while True:
                used.append(os.open("/dev/null", os.O_RDONLY))
        except OSError:
            pass
        client.connect(link.sync.listen.getsockname())
        client.sendall(heartbeat(5))
        await asyncio.sleep(0.5)
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        for one in used:
            os.close(one)
        assert (await link.recv_match(timeout=60)).get_seq() == 5

asyncio.run(main())
"""
    done = python(program)
    told = "tcpin:127.0.0.1:0: a client cannot be served: [Errno 24] Too many open files; trying again\n"
    assert (done.returncode, done.stderr) == (0, told)


def test_errors_of_hooks_do_not_stop_reading():
    def hook(link, msg):
        raise OSError(errno.EMFILE, "no file for a log")

    async def main():
        failures = []
        asyncio.get_running_loop().set_exception_handler(lambda _, found: failures.append(found))
        async with udp_link() as (link, peer):
            link.sync.message_hooks.append(hook)
            for number in range(5):
                peer.send(attitude(number))
                await eventually(lambda number=number: len(failures) > number)

    run(main())


def test_what_nobody_takes_is_discarded_beside_the_loop(monkeypatch):
    async def main():
        loop = asyncio.get_running_loop()
        threads, go_on = [], threading.Event()

        def discard(result):
            threads.append((result, threading.get_ident()))

        early = asyncio.create_task(in_background(lambda: go_on.wait(WAIT), discard))
        await asyncio.sleep(0)
        early.cancel()
        go_on.set()
        await eventually(lambda: threads)

        call = loop.call_soon_threadsafe

        def call_and_cancel(callback, *arguments):
            # Between the result and the task that waits for it.
            call(lambda: (callback(*arguments), late.cancel()))

        monkeypatch.setattr(loop, "call_soon_threadsafe", call_and_cancel)
        late = asyncio.create_task(in_background(lambda: "late", discard))
        with pytest.raises(asyncio.CancelledError):
            await late
        await eventually(lambda: len(threads) == 2)
        assert [result for result, _ in threads] == [True, "late"]
        assert threading.get_ident() not in [thread for _, thread in threads]

    run(main())


class Threads:
    """No thread can be had while there are `none`."""

    def __init__(self, monkeypatch):
        self.none, self.refused, start = False, 0, threading.Thread.start

        def attempt(thread):
            if self.none:
                self.refused += 1
                raise RuntimeError("can't start new thread")
            start(thread)

        monkeypatch.setattr(threading.Thread, "start", attempt)

    def start(self, function, arguments):
        thread = threading.Thread(target=function, args=arguments, daemon=True)
        thread.start()


def test_without_a_thread_a_connection_is_made_again_later(monkeypatch):
    async def main():
        with socket.create_server(("127.0.0.1", 0)) as server:
            device = f"tcp:127.0.0.1:{server.getsockname()[1]}"
            link = await aio.connect(device, autoreconnect=True, reconnect_delay=0.01)
            threads = Threads(monkeypatch)
            monkeypatch.setattr("mavwire.links.reconnecting.start_new_thread", threads.start)
            threads.none = True
            server.accept()[0].close()
            await eventually(lambda: threads.refused > 2)
            assert not link.connected
            threads.none = False
            await eventually(lambda: link.connected)
            server.accept()[0].close()
            threads.none = True
            await link.close()
            assert link.sync.port is None

    run(main())


def test_without_a_thread_a_name_is_looked_up_later(monkeypatch):
    async def main():
        link = await aio.connect("udpout:127.0.0.1:14550")
        threads = Threads(monkeypatch)
        threads.none = True
        failures = []
        asyncio.get_running_loop().set_exception_handler(lambda _, told: failures.append(told))
        address = link.sync.resolved_destination_addr
        link.sync._lookup_due, link.sync._next_lookup = True, 0.0
        for _ in range(3):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            await eventually(lambda: link.sync._next_lookup > 0)
        gc.collect()
        assert (threads.refused, failures) == (1, [])
        assert link.sync.resolved_destination_addr == address
        await link.close()

    run(main())


def test_without_a_thread_what_nobody_takes_is_discarded_all_the_same(monkeypatch):
    async def main():
        discarded, go_on = [], threading.Event()
        threads = Threads(monkeypatch)
        task = asyncio.create_task(in_background(lambda: go_on.wait(WAIT), discarded.append))
        await asyncio.sleep(0)
        task.cancel()
        threads.none = True
        go_on.set()
        await eventually(lambda: discarded == [True])

    run(main())


@pytest.mark.parametrize("error", [StopIteration(3), KeyError("x"), SystemExit(2)])
def test_whatever_is_raised_beside_the_loop_comes(error):
    """Futures refuse StopIteration, which a coroutine cannot raise either."""

    def fail():
        raise error

    async def main():
        with pytest.raises((RuntimeError, KeyError, SystemExit)) as caught:
            await in_background(fail)
        assert error in (caught.value, caught.value.__cause__)

    run(main())


def test_a_link_that_cannot_be_had_is_closed_beside_the_loop(monkeypatch):
    closed = []

    class Sync:
        def close(self):
            closed.append(threading.get_ident())

    monkeypatch.setattr(mavutil, "mavlink_connection", lambda *_, **__: Sync())
    monkeypatch.setattr("mavwire.aio.connecting.Link", None)

    async def main():
        with pytest.raises(TypeError):
            await aio.connect("exec:vehicle")
        assert len(closed) == 1
        assert threading.get_ident() not in closed

    run(main())


def test_a_backlog_that_holds_nothing_is_refused_before_anything_is_opened(monkeypatch):
    opened = []
    monkeypatch.setattr(mavutil, "mavlink_connection", lambda *_, **__: opened.append(1))

    async def main():
        with pytest.raises(ValueError, match="backlog of 0"):
            await aio.connect("exec:vehicle", backlog=0)
        assert opened == []

    run(main())
