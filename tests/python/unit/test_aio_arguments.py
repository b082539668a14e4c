"""What `mavwire.aio` takes: paths as mavutil does, signing's arguments in their order, and no time that is none."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path

import pytest
from mavwire import aio, traffic
from mavwire.aio.deadline import deadline_after
from unit.aio_tools import LOOPS, run, udp_link
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

    run(main(), LOOPS[loop])


def test_a_time_without_end_never_comes():
    async def main():
        loop = asyncio.get_running_loop()
        assert deadline_after(loop, None) is deadline_after(loop, float("inf")) is None
        assert deadline_after(loop, 1) > loop.time()

    run(main())
