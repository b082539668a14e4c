"""Signing set up by `mavwire.aio`: timestamps are stored before they are used, and not by the loop."""

from __future__ import annotations

import threading

import pytest
from mavwire.aio.timestamps import AheadStore
from mavwire.links.signing import UNITS_PER_SECOND
from mavwire.links.timestamp_store import RESERVE, TimestampStore
from unit.aio_tools import eventually, run, udp_link
from unit.link_tools import KEY

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


def test_a_loop_does_not_wait_for_the_store():
    async def main():
        async with udp_link() as (link, _):
            store = Memory()
            await link.setup_signing(KEY, timestamp_store=store, link_id=7)
            signing = link.mav.signing
            assert (signing.secret_key, signing.link_id, signing.sign_outgoing) == (KEY, 7, True)
            first = store.stored
            for _ in range(20):
                signing.timestamp += RESERVE // 2
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                assert signing.timestamp < store.stored
                # As a disk would have written in the seconds that passed.
                await eventually(lambda: store.stored > signing.timestamp + 2 * RESERVE)
            assert store.stored >= first + 8 * RESERVE
            assert threading.get_ident() not in store.users

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
            with pytest.raises(FileNotFoundError):
                await link.setup_signing(KEY, timestamp_store=tmp_path / "missing" / "stamps")
            with pytest.raises(ValueError, match="32 bytes"):
                await link.setup_signing(KEY[1:], timestamp_store=tmp_path / "stamps")
            assert link.mav.signing.secret_key is None
            assert not (tmp_path / "stamps").exists()
            await link.setup_signing(KEY)
            assert link.mav.signing.secret_key == KEY

    run(main())


def test_a_store_that_begins_to_fail_is_met_when_the_rest_is_used_up():
    memory = Memory(stored=5 * HOUR)
    store = AheadStore(memory, HOUR)
    assert store.load() == 5 * HOUR
    last = memory.stored
    memory.error = OSError("the disk is full")
    store.save(last)
    with pytest.raises(OSError, match="disk is full"):
        store.save(last + 1)
    memory.error = None
    store.save(last + 1)
    assert memory.stored > last + 1
