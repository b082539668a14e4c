"""One call that reads a whole log lets the other threads of the program run."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from mavwire import mavutil
from unit.link_tools import heartbeat, record

WAIT = 60.0
RECORDS = 250_000


@pytest.fixture(autouse=True, params=[1e-5, 5e-3])
def switch_interval(request: pytest.FixtureRequest) -> Iterator[None]:
    """A short one, and Python's own."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(request.param)
    yield
    sys.setswitchinterval(before)


@pytest.mark.parametrize("kind", ["mavlogfile", "mavmmaplog"])
def test_other_threads_run_while_nothing_fits(kind: str, tmp_path: Path) -> None:
    """A thread sees how far the log is read, in the midst of a single call."""
    path = tmp_path / "long.tlog"
    path.write_bytes(b"".join(record(heartbeat(seq)) for seq in range(250)) * (RECORDS // 250))
    log = getattr(mavutil, kind)(str(path))
    seen: set[float] = set()
    stop = threading.Event()

    def watch() -> None:
        while not stop.is_set():
            seen.add(log.percent)

    watcher = threading.Thread(target=watch)
    watcher.start()
    deadline = time.monotonic() + WAIT
    try:
        while len(seen) < 10 and time.monotonic() < deadline:
            log._restart()
            assert log.recv_match(type="ATTITUDE") is None
    finally:
        stop.set()
        watcher.join(WAIT)
    log.close()
    assert len(seen) >= 10
