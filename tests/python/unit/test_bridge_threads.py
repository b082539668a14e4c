"""A bridge, several threads, asyncio's loop and the end of the program."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from mavwire import Bridge, open_log
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import LIMIT, run_alone
from unit.link_tools import at_once

BEAT = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


def test_a_handler_that_sends_interrupts_one_that_sends() -> None:
    program = """
import signal
from mavwire import Bridge
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import LIMIT

class Beat(mavlink.MAVLink_heartbeat_message):
    def pack(self, *args, **options):
        signal.raise_signal(signal.SIGTERM)
        return super().pack(*args, **options)

fields = (6, 8, 0, 0, 4, 3)
signal.signal(signal.SIGTERM, lambda *_: bridge.send(mavlink.MAVLink_heartbeat_message(*fields)))
with Bridge() as bridge, bridge.frames() as batches:
    numbers = []
    for _ in range(10):
        bridge.send(Beat(*fields))
    while len(numbers) < 20:
        numbers += [frame[4] for frame in batches.next(LIMIT).frames()]
# A frame that was interrupted may leave a gap of one, and no number comes twice.
assert numbers == sorted(set(numbers)) and numbers[-1] < 30, numbers
"""
    run_alone(program)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_batches_fetched_in_a_child_end() -> None:
    """The thread that was fetching them is the parent's."""
    program = """
import asyncio, os, warnings
from mavwire import Bridge
warnings.simplefilter("ignore")

async def fetch():
    return [len(batch) async for batch in batches]

with Bridge() as bridge:
    batches = bridge.frames()
    try:
        asyncio.run(asyncio.wait_for(fetch(), 0.01))
    except TimeoutError:
        pass
    child = os.fork()
    if child == 0:
        os._exit(len(asyncio.run(asyncio.wait_for(fetch(), 60))))
    assert os.waitpid(child, 0)[1] == 0
"""
    run_alone(program)


def test_a_program_that_just_ends_leaves_a_whole_recording(tmp_path: Path) -> None:
    """A thread inside the bridge keeps it to the end."""
    program = f"""
import threading
from mavwire import Bridge
from mavwire.bridge import Recording
from unit.link_tools import heartbeat
bridge = Bridge(record=Recording({str(tmp_path)!r}, flush_interval=1000)).start()
batches = bridge.frames()
threading.Thread(target=lambda: [None for _ in batches], daemon=True).start()
seen = bridge.frames(max_batch=100, max_latency=60)
bridge.send(b"".join(heartbeat(n) for n in range(100)))
assert len(seen.next(60)) == 100
"""
    run_alone(program)
    (log,) = tmp_path.iterdir()
    assert len(list(open_log(log))) == 100


def test_threads_that_send_number_their_frames_one_after_the_other() -> None:
    count, threads = 2000, 4
    interval = sys.getswitchinterval()
    with Bridge() as bridge, bridge.frames() as batches:

        def send(_: int) -> None:
            for _ in range(count):
                bridge.send(BEAT)

        sys.setswitchinterval(1e-5)
        try:
            at_once(send, threads)
        finally:
            sys.setswitchinterval(interval)
        numbers: list[int] = []
        while len(numbers) < count * threads:
            batch = batches.next(LIMIT)
            assert batch
            numbers += [frame[4] for frame in batch.frames()]
    assert numbers == [n % 256 for n in range(count * threads)]
