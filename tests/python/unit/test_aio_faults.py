"""Odd arguments, cancelled tasks and a lack of descriptors under `mavwire.aio`."""

from __future__ import annotations

import asyncio
import os
import sys
from pathlib import Path

import pytest
from mavwire import aio, traffic
from mavwire.aio.deadline import deadline_after
from unit.aio_tools import LOOPS, run, udp_link
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
def test_without_descriptors_a_server_says_so_now_and_then():
    program = """
import asyncio, os, resource, socket
from mavwire import aio
from unit.link_tools import heartbeat

async def main():
    failures = []
    asyncio.get_running_loop().set_exception_handler(lambda _, found: failures.append(found))
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
        await asyncio.sleep(1.5)
        assert 1 <= len(failures) < 100, len(failures)
        for one in used:
            os.close(one)
        assert (await link.recv_match(timeout=60)).get_seq() == 5

asyncio.run(main())
"""
    done = python(program)
    assert (done.returncode, done.stderr) == (0, "")
