"""What waits to be sent under `mavwire.aio`, whoever has put it there."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from mavwire import aio, mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.aio_tools import LOOPS, WAIT, eventually, run
from unit.link_tools import heartbeat

# More than the system keeps with small buffers.
MUCH = 1 << 17


@pytest.fixture(autouse=True)
def mavlink20():
    mavutil.set_wire_protocol("2.0")
    yield
    mavutil.set_wire_protocol(None)


@asynccontextmanager
async def silent_peer() -> AsyncIterator[tuple[Any, Any, Any]]:
    """A link with more to send than its peer has read, which another than `link.mav` has put there; and the peer."""
    accepted: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
    server = await asyncio.start_server(lambda *ends: accepted.set_result(ends), "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    async with aio.connect(f"tcp:127.0.0.1:{port}") as link:
        reader, writer = await accepted
        reader._transport.pause_reading()
        # The system keeps megabytes otherwise.
        link.sync.port.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 14)
        peer = writer.get_extra_info("socket")
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 14)
        while len(link.sync._writer.unsent) < MUCH:
            link.sync.write(heartbeat())
        yield link, reader, writer
        writer.close()
    server.close()


async def swallow(reader: Any) -> None:
    while await reader.read(1 << 16):
        pass


@pytest.mark.parametrize("loop", LOOPS)
def test_drain_waits_for_what_others_than_mav_sent(loop):
    async def main():
        async with silent_peer() as (link, reader, _):
            for _ in range(5):
                with pytest.raises(TimeoutError):
                    await asyncio.wait_for(link.drain(), 0.001)
            assert not link._live.outgoing._drained
            reader._transport.resume_reading()
            reading = asyncio.create_task(swallow(reader))
            await asyncio.wait_for(link.drain(), WAIT)
            assert not link.sync._writer.unsent
        await reading

    run(main(), LOOPS[loop])


@pytest.mark.parametrize("loop", LOOPS)
def test_what_reading_has_put_into_the_queue_is_sent(loop):
    """Answers to a WebSocket's pings are such."""

    async def main():
        async with silent_peer() as (link, reader, writer):
            writer.write(heartbeat(3))
            assert (await link.recv_match(timeout=WAIT)).get_seq() == 3
            reader._transport.resume_reading()
            reading = asyncio.create_task(swallow(reader))
            await eventually(lambda: not link.sync._writer.unsent)
        await reading

    run(main(), LOOPS[loop])


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_frames_of_mavutil_s_link_do_not_cut_those_that_wait(tmp_path: Path) -> None:
    """R63. The child begins to read when it is told to."""
    program, gate, output = (tmp_path / name for name in ("program", "gate", "output"))
    os.mkfifo(gate)
    program.write_text(f"#!/bin/sh\nread line < {gate}\nexec cat 3>&1 > {output}\n")
    program.chmod(0o700)
    count = 5000

    async def main():
        async with aio.connect(f"exec:{program}") as link:
            for seq in range(count):
                link.mav.heartbeat_send(6, 8, 0, seq, 0)
            link.sync.write(heartbeat(9, sysid=9))
            link.mav.heartbeat_send(6, 8, 0, count, 0)
            assert link.sync._writer.unsent
            gate.write_text("go on\n")
            await asyncio.wait_for(link.drain(), WAIT)
            await eventually(lambda: output.exists() and output.stat().st_size >= 21 * (count + 2))
            assert (link.frames_dropped, link.sync.frames_dropped) == (0, 0)

    run(main())
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    messages = parser.parse_buffer(output.read_bytes())
    assert {msg.get_type() for msg in messages} == {"HEARTBEAT"}
    numbers = [9000 if msg.get_srcSystem() == 9 else msg.custom_mode for msg in messages]
    assert numbers == [*range(count), 9000, count]
