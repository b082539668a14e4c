"""Signing set up by `mavwire.aio`: timestamps are stored before they are used."""

from __future__ import annotations

import asyncio
import threading

import pytest
from mavwire.links import state
from mavwire.links.signing import MAX_TIMESTAMP, UNITS_PER_SECOND
from mavwire.links.timestamp_store import RESERVE, TimestampStore
from unit.aio_tools import WAIT, eventually, run, udp_link
from unit.link_tools import KEY, WRONG_SIGNING, signing_state

HOUR = 3600 * UNITS_PER_SECOND


class Memory:
    """A store that knows who used it."""

    def __init__(self, stored=0):
        self.stored = stored
        self.users = []
        self.error = None

    def load(self):
        self.users.append(threading.get_ident())
        return self.stored

    def save(self, timestamp):
        self.users.append(threading.get_ident())
        if self.error is not None:
            raise self.error
        self.stored = max(self.stored, timestamp)


def test_a_loop_does_not_wait_for_the_set_up():
    async def main():
        async with udp_link() as (link, _):
            store = Memory()
            await link.setup_signing(KEY, timestamp_store=store, link_id=7)
            signing = link.mav.signing
            assert (signing.secret_key, signing.link_id, signing.sign_outgoing) == (KEY, 7, True)
            assert threading.get_ident() not in store.users
            first = store.stored
            for _ in range(20):
                signing.timestamp += RESERVE // 2
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                assert signing.timestamp < store.stored
            assert store.stored >= first + 8 * RESERVE

    run(main())


def test_a_leap_is_stored_before_it_is_used():
    async def main():
        async with udp_link() as (link, _):
            store = Memory()
            await link.setup_signing(KEY, timestamp_store=store)
            link.mav.signing.timestamp += HOUR
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert link.mav.signing.timestamp < store.stored

    run(main())


def test_timestamps_go_on_from_what_was_stored(tmp_path):
    path = tmp_path / "stamps"

    async def main():
        async with udp_link() as (link, _):
            await link.setup_signing(KEY, timestamp_store=path)
            return link.mav.signing.timestamp, TimestampStore(path).load()

    used, stored = run(main())
    assert used < stored
    again, _ = run(main())
    assert again >= stored


def test_what_cannot_be_set_up_changes_nothing(tmp_path):
    async def main():
        async with udp_link() as (link, _):
            state = signing_state(link)
            with pytest.raises(FileNotFoundError):
                await link.setup_signing(KEY, timestamp_store=tmp_path / "missing" / "stamps")
            for wrong in WRONG_SIGNING:
                for store in (tmp_path / "stamps", None):
                    arguments = {"secret_key": KEY, "timestamp_store": store, **wrong}
                    with pytest.raises((OverflowError, TypeError, ValueError)):
                        await link.setup_signing(**arguments)
            assert signing_state(link) == state
            assert list(tmp_path.iterdir()) == []
            await link.setup_signing(KEY)
            assert link.mav.signing.secret_key == KEY

    run(main())


def test_a_store_is_good_to_the_last_timestamp(tmp_path):
    """R51."""
    path = tmp_path / "stamps"

    async def main():
        async with udp_link() as (link, _):
            near = MAX_TIMESTAMP - 1000
            await link.setup_signing(KEY, initial_timestamp=near, timestamp_store=path)
            assert link.mav.signing.timestamp == near
            assert TimestampStore(path).load() == MAX_TIMESTAMP
            await link.setup_signing(KEY, timestamp_store=path)
            assert link.mav.signing.timestamp == MAX_TIMESTAMP

    run(main())


def test_processes_that_share_a_store_have_link_ids_of_their_own(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")
    monkeypatch.setattr(state, "global_link_id", 0)
    path = tmp_path / "stamps"

    async def main():
        async with udp_link() as (link, _):
            with open(f"{path}.link1", "wb") as other:
                fcntl.flock(other, fcntl.LOCK_EX)
                await link.setup_signing(KEY, timestamp_store=path)
            assert link.mav.signing.link_id == 2

    run(main())


def test_a_set_up_that_was_cancelled_does_not_come_later():
    begun, go_on = threading.Event(), threading.Event()

    class Slow(Memory):
        def load(self):
            begun.set()
            assert go_on.wait(WAIT)
            return super().load()

    async def main():
        async with udp_link() as (link, _):
            store = Slow()
            task = asyncio.create_task(link.setup_signing(KEY, timestamp_store=store))
            await eventually(begun.is_set)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            go_on.set()
            await eventually(
                lambda: "mavwire.aio" not in [one.name for one in threading.enumerate()]
            )
            assert store.stored
            assert link.mav.signing.secret_key is None

    run(main())
