"""Signing on links: what links with one key share, timestamps over restarts, keys that stay secret."""

from __future__ import annotations

import errno
import json
import os
import sys
import threading
import time
from pathlib import Path

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.links import signing as signing_module
from mavwire.links import state as state_module
from mavwire.links import timestamp_store
from mavwire.links.timestamp_store import RESERVE, TimestampStore, keeper
from unit.link_tools import (
    KEY,
    WRONG_SIGNING,
    Capture,
    drain,
    heartbeat,
    pack,
    signed,
    signing_state,
    types,
)
from watchdog import watched

WAIT = 60
HEARTBEAT = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
SETUP = mavlink.MAVLink_setup_signing_message(1, 1, list(KEY[::-1]), 99)


pytestmark = pytest.mark.usefixtures("mavlink20")


def link_with_key(key=KEY, **kw) -> Capture:
    link = Capture()
    link.setup_signing(key, **{"initial_timestamp": 0, **kw})
    return link


def sent_timestamp(link: Capture) -> int:
    """The timestamp of the signature of the next HEARTBEAT that `link` sends."""
    link.tx.clear()
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    return int.from_bytes(link.tx[-12:-6], "little")


# -- links with one key


def test_what_one_link_heard_cannot_be_replayed_on_another():
    """R42."""
    first, second, other = link_with_key(), link_with_key(), link_with_key(bytes(32))
    frame = signed(HEARTBEAT, timestamp=100)
    first.rx += frame
    second.rx += frame
    assert types(drain(first)) == ["HEARTBEAT"]
    assert types(drain(second)) == ["BAD_DATA"]
    assert second.mav.signing.stream_timestamps == {(3, 1, 1): 100}
    assert other.mav.signing.stream_timestamps == {}


def test_each_link_counts_its_own_timestamps():
    """R34. Links of one key differ in their link ids."""
    first, second = link_with_key(initial_timestamp=1000), link_with_key(initial_timestamp=3)
    assert [sent_timestamp(first), sent_timestamp(second)] == [1000, 3]
    assert [sent_timestamp(first), sent_timestamp(second)] == [1001, 4]
    assert first.mav.signing.link_id != second.mav.signing.link_id


def test_another_key_ends_the_sharing():
    """R56: links may have different keys."""
    first, second = link_with_key(), link_with_key()
    second.setup_signing(bytes(32), initial_timestamp=5)
    first.rx += signed(HEARTBEAT, timestamp=100)
    drain(first)
    assert second.mav.signing.stream_timestamps == {}
    assert (first.mav.signing.secret_key, second.mav.signing.secret_key) == (KEY, bytes(32))
    second.setup_signing(KEY, initial_timestamp=0)
    assert second.mav.signing.stream_timestamps == {(3, 1, 1): 100}
    second.disable_signing()
    assert first.mav.signing.secret_key == KEY
    assert (second.mav.signing.secret_key, second.mav.signing.timestamp) == (None, 0)


def test_a_link_that_is_set_up_again_takes_the_timestamp_it_is_given():
    link = link_with_key(initial_timestamp=1000)
    link.setup_signing(KEY, initial_timestamp=3)
    assert sent_timestamp(link) == 3


# -- timestamps


def test_timestamps_follow_the_clock_unless_one_is_given(monkeypatch):
    """R35: a sender that is silent for minutes does not fall behind."""
    link = Capture()
    monkeypatch.setattr(time, "time", lambda: signing_module.EPOCH + 1)
    link.setup_signing(KEY)
    assert link.mav.signing.timestamp == 100_000
    assert sent_timestamp(link) > 1000 * 100_000
    link.setup_signing(KEY, initial_timestamp=7)
    assert [sent_timestamp(link), sent_timestamp(link)] == [7, 8]


def test_a_stored_timestamp_survives_a_clock_that_went_back(tmp_path):
    """R36."""
    path = tmp_path / "timestamps"
    link = link_with_key(initial_timestamp=5_000_000, timestamp_store=path)
    before = sent_timestamp(link)
    signing_module._with_key.clear()
    restarted = link_with_key(initial_timestamp=7, timestamp_store=str(path))
    assert before < sent_timestamp(restarted) <= before + 2 * RESERVE


def test_received_timestamps_are_stored_too(tmp_path):
    path = tmp_path / "timestamps"
    link = link_with_key(timestamp_store=path)
    link.rx += signed(HEARTBEAT, timestamp=1 << 40)
    drain(link)
    assert TimestampStore(path).load() > 1 << 40


def test_timestamps_are_stored_before_they_are_used():
    class Store:
        saved = 0
        saves = 0

        def load(self):
            return self.saved

        def save(self, timestamp):
            self.saved = timestamp
            self.saves += 1

    store = Store()
    link = link_with_key(timestamp_store=store)
    for jump in (1, 0, RESERVE, 1, 0, 3 * RESERVE, 0):
        link.mav.signing.timestamp += jump
        assert sent_timestamp(link) < store.saved
    assert store.saves == 3
    link.disable_signing()
    link.mav.signing.secret_key = KEY
    link.mav.signing.sign_outgoing = True
    link.mav.signing.timestamp = 9 * RESERVE
    assert sent_timestamp(link) == 9 * RESERVE
    assert store.saves == 3


def test_no_thread_uses_what_another_one_still_stores():
    class Store:
        saved = 0

        def load(self):
            return 0

        def save(self, timestamp):
            if threading.current_thread() is storing:
                begun.set()
                assert go_on.wait(WAIT)
            self.saved = timestamp

    store, begun, go_on, storing = Store(), threading.Event(), threading.Event(), None
    keep = keeper(store, 0)
    storing = threading.Thread(target=keep, args=(2 * RESERVE,))
    storing.start()
    assert begun.wait(WAIT)
    try:
        assert keep(2 * RESERVE + 1) <= store.saved == 3 * RESERVE + 1
    finally:
        go_on.set()
        storing.join(WAIT)
    assert store.saved == 3 * RESERVE + 1


def test_an_earlier_timestamp_of_another_thread_does_not_stay_in_place_of_a_later_one():
    class Store:
        saved = 0

        def load(self):
            return 0

        def save(self, timestamp):
            if threading.current_thread() is slow:
                begun.set()
                assert go_on.wait(WAIT)
            self.saved = timestamp
            if timestamp == 3 * RESERVE + 1:
                go_on.set()
                if threading.current_thread() is not slow:
                    slow.join(WAIT)

    store, begun, go_on, slow = Store(), threading.Event(), threading.Event(), None
    keep = keeper(store, 0)
    slow = threading.Thread(target=keep, args=(2 * RESERVE,))
    slow.start()
    assert begun.wait(WAIT)
    assert keep(2 * RESERVE + 1) <= store.saved == 3 * RESERVE + 1


def test_a_store_stays_where_it_is_when_the_folder_is_changed(tmp_path, monkeypatch):
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    link = link_with_key(timestamp_store="timestamps")
    monkeypatch.chdir(tmp_path / "elsewhere")
    link.mav.signing.timestamp += 2 * RESERVE
    assert sent_timestamp(link) < TimestampStore(tmp_path / "timestamps").load()
    assert list(Path().iterdir()) == []


def test_a_store_that_fails_later_is_reported_once_and_stops_nothing(tmp_path, caplog):
    folder = tmp_path / "folder"
    folder.mkdir()
    link = link_with_key(timestamp_store=folder / "timestamps")
    folder.rename(tmp_path / "elsewhere")
    for _ in range(3):
        link.mav.signing.timestamp += 2 * RESERVE
        assert sent_timestamp(link)
    assert [record.getMessage()[:38] for record in caplog.records] == [
        "signing timestamps are not stored: [Er"
    ]


def test_two_slots_take_turns_and_half_a_write_is_not_believed(tmp_path):
    store = TimestampStore(tmp_path / "timestamps")
    assert store.load() == 0
    for timestamp in (5, 3, 9, 10, 1 << 47):
        store.save(timestamp)
    assert store.load() == 1 << 47
    content = bytearray(store.path.read_bytes())
    newest = content.index((1 << 47).to_bytes(8, "little"))
    content[newest] = 0xFF
    store.path.write_bytes(content)
    assert store.load() == 10
    store.path.write_bytes(bytes(3))  # the disk lost power
    assert store.load() == 0
    assert store.path.stat().st_mode & 0o077 == 0


def test_a_store_that_somebody_keeps_locked_stops_nothing(tmp_path, caplog, monkeypatch):
    fcntl = pytest.importorskip("fcntl")
    monkeypatch.setattr(timestamp_store, "FIRST_PATIENCE", 0.02)
    monkeypatch.setattr(timestamp_store, "LOCK_PATIENCE", 0.01)
    store = TimestampStore(tmp_path / "store")
    keep = keeper(store, 1)
    with store.path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        assert [keep(n * RESERVE) for n in (2, 3, 4)] == [n * RESERVE for n in (3, 4, 5)]
        reason = f"was locked by others for 0.01 s: '{store.path}'"
        assert [reason in record.getMessage() for record in caplog.records] == [True]
        for one in (store, TimestampStore(store.path)):  # also one that another link has used
            with pytest.raises(OSError, match=r"was locked .* 0\.02 s"):
                keeper(one, 1)
        with pytest.raises(OSError, match=r"was locked .* 0\.01 s"):
            TimestampStore(store.path).save(1)
    assert keep(9 * RESERVE) == TimestampStore(store.path).load() == 10 * RESERVE


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_pipe_is_no_store(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    for action in (TimestampStore(path).load, lambda: TimestampStore(path).save(5)):
        with pytest.raises(OSError, match=f"is no file .*{path}"), watched():
            action()


def test_a_store_may_be_a_link_to_a_file_that_is_made(tmp_path):
    path = tmp_path / "timestamps"
    path.symlink_to("elsewhere")
    assert TimestampStore(path).load() == 0
    TimestampStore(path).save(5)
    assert (TimestampStore(path).load(), path.is_symlink()) == (5, True)


def test_a_folder_is_no_store(tmp_path):
    for use in (TimestampStore(tmp_path).load, lambda: TimestampStore(tmp_path).save(7)):
        with pytest.raises(OSError, match="is no file"):
            use()


@pytest.mark.parametrize("content", [*map(bytes, map(range, (2, 5, 12, 32))), bytes(4108) + b"x"])
def test_another_file_is_no_store_and_stays_as_it_is(tmp_path, content):
    path = tmp_path / "key"
    path.write_bytes(content)
    for use in (TimestampStore(path).load, lambda: TimestampStore(path).save(7)):
        with pytest.raises(OSError, match="no timestamp store") as caught:
            use()
        assert caught.value.filename == str(path)
    with pytest.raises(OSError, match="no timestamp store"):
        link_with_key(timestamp_store=path)
    assert path.read_bytes() == content


def test_a_store_that_is_shared_keeps_the_latest(tmp_path):
    """R36."""
    slow, quick = (TimestampStore(tmp_path / "timestamps") for _ in range(2))
    for timestamp in (100, 50, 200, 70, 80):
        (quick if timestamp % 100 == 0 else slow).save(timestamp)
    content = (tmp_path / "timestamps").read_bytes()
    assert slow.load() == 200
    assert (100).to_bytes(8, "little") in content, "the one before is there, should a write be cut"


def test_a_store_is_good_to_the_last_timestamp(tmp_path):
    """R51."""
    path, last = tmp_path / "timestamps", signing_module.MAX_TIMESTAMP
    link = link_with_key(initial_timestamp=last - 1, timestamp_store=path)
    assert [sent_timestamp(link), sent_timestamp(link)] == [last - 1, last]
    assert TimestampStore(path).load() == last
    assert sent_timestamp(link_with_key(timestamp_store=path)) == last


@pytest.mark.parametrize("name", [".", "missing/timestamps"])
def test_a_store_that_cannot_be_read_or_written_changes_nothing(tmp_path, name):
    link = Capture()
    state = signing_state(link)
    with pytest.raises(OSError):
        link.setup_signing(KEY, timestamp_store=tmp_path / name)
    assert signing_state(link) == state


def test_half_a_timestamp_is_not_stored(tmp_path, monkeypatch):
    """The disk is full."""
    store = TimestampStore(tmp_path / "timestamps")
    write = os.write
    monkeypatch.setattr(os, "write", lambda fd, data: write(fd, data[:5]))
    with pytest.raises(OSError, match="No space") as caught:
        store.save(7)
    assert (caught.value.errno, store.load()) == (errno.ENOSPC, 0)
    monkeypatch.undo()
    store.save(8)
    assert store.load() == 8


@pytest.mark.parametrize("base", [object, TimestampStore])
def test_a_store_may_fail_in_any_way(base, caplog, tmp_path):
    class Store(base):
        works = False

        def load(self):
            return 5

        def save(self, timestamp):
            if not self.works:
                raise RuntimeError("no database")

    store = Store() if base is object else Store(tmp_path / "timestamps")
    with pytest.raises(RuntimeError, match="no database"):
        link_with_key(timestamp_store=store)
    store.works = True
    link = link_with_key(timestamp_store=store)
    store.works = False
    assert (sent_timestamp(link), caplog.text) == (5, "")
    link.mav.signing.timestamp += 2 * RESERVE
    assert sent_timestamp(link) == 6 + 2 * RESERVE
    assert "no database" in caplog.text


def test_a_verified_timestamp_cannot_use_up_the_48_bits(tmp_path):
    """R51."""
    link = link_with_key(timestamp_store=tmp_path / "timestamps")
    link.rx += signed(HEARTBEAT, timestamp=(1 << 48) - 1)
    assert types(drain(link)) == ["HEARTBEAT"]
    first = sent_timestamp(link)
    assert sent_timestamp(link) == first + 1 < 1 << 48
    assert TimestampStore(tmp_path / "timestamps").load() < 1 << 48


def test_a_peer_years_ahead_moves_us_a_day_at_most(tmp_path):
    """R51."""
    day = 24 * 3600 * signing_module.UNITS_PER_SECOND
    link = Capture()
    link.setup_signing(KEY, timestamp_store=tmp_path / "timestamps")
    before = link.mav.signing.timestamp
    link.rx += signed(HEARTBEAT, timestamp=before + 5 * 365 * day)
    assert [msg.get_signed() for msg in drain(link)] == [True]
    latest = signing_module.signing_timestamp(time.time()) + day + 1
    assert before + day <= link.mav.signing.timestamp <= latest
    assert TimestampStore(tmp_path / "timestamps").load() <= latest + RESERVE


# -- all or nothing


REFUSED = (OverflowError, TypeError, ValueError)


@pytest.mark.parametrize("nobody", [None, False, 0])
def test_without_a_callback_nobody_is_asked(nobody):
    link = Capture()
    link.setup_signing(KEY, allow_unsigned_callback=nobody)
    link.rx += heartbeat()
    assert types(drain(link)) == ["BAD_DATA"]


@pytest.mark.parametrize("wrong", WRONG_SIGNING, ids=str)
@pytest.mark.parametrize("before", [None, KEY], ids=["unsigned", "signed"])
def test_a_set_up_that_is_refused_changes_nothing(wrong, before, tmp_path):
    link = Capture()
    if before:
        link.setup_signing(before, initial_timestamp=5, link_id=7)
    state = signing_state(link)
    arguments = {"secret_key": bytes(32), "timestamp_store": tmp_path / "timestamps", **wrong}
    with pytest.raises(REFUSED):
        link.setup_signing(**arguments)
    assert signing_state(link) == state
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "wrong", [WRONG_SIGNING[-1], WRONG_SIGNING[-2], {"secret_key": None}], ids=str
)
def test_what_a_set_up_refuses_is_named(wrong):
    (name,) = wrong
    with pytest.raises(TypeError, match=f"^{name} is "):
        Capture().setup_signing(**{"secret_key": KEY, **wrong})


def test_a_text_is_no_key_and_is_not_shown():
    for set_up in (Capture().setup_signing, Capture().send_signing_key):
        with pytest.raises(TypeError, match="^secret_key is 32 bytes, not of type str$"):
            set_up("a text of thirty-two characters.")


def test_a_number_of_links_that_is_none_is_refused(monkeypatch, tmp_path):
    """`global_link_id` is for programs to assign, too."""
    for wrong in (300, None):
        monkeypatch.setattr(state_module, "global_link_id", wrong)
        with pytest.raises(REFUSED, match="link_id is"):
            link_with_key(timestamp_store=tmp_path / "timestamps")
    assert list(tmp_path.iterdir()) == []


class Interrupting:
    """Stands for the links with a key, and sends whenever it is asked: what another thread could do there."""

    def __init__(self, link: Capture) -> None:
        self.link = link

    def __iter__(self):
        self.link.mav.send(HEARTBEAT)
        return iter(())

    def __setitem__(self, *_): ...


def test_what_is_sent_in_the_middle_of_a_set_up_has_all_of_it_or_nothing(monkeypatch):
    link = Capture()
    monkeypatch.setattr(signing_module, "_with_key", Interrupting(link))
    link.setup_signing(KEY, initial_timestamp=5, link_id=9)
    link.disable_signing()
    *frames, unsigned = [bytes(link.tx[at : at + 34]) for at in range(0, len(link.tx), 34)]
    assert frames
    for number, frame in enumerate(frames):
        assert (frame[2], frame[21]) == (1, 9)
        assert int.from_bytes(frame[22:28], "little") == 5 + number
    assert (len(unsigned), unsigned[2]) == (21, 0)


# -- policy


def test_the_ready_made_callback_lets_only_the_radio_pass():
    """R46."""
    link = link_with_key(allow_unsigned_callback=mavutil.allow_radio_status)
    link.rx += pack(mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7))
    link.rx += heartbeat()
    received = drain(link)
    assert types(received) == ["RADIO_STATUS", "BAD_DATA"]
    assert not received[0].get_signed()
    assert mavutil.allow_radio_status(None, 166)


def test_a_callback_that_fails_lets_nothing_pass():
    """R45."""

    def callback(mav, msgid):
        raise KeyError(msgid)

    link = link_with_key(allow_unsigned_callback=callback)
    link.rx += heartbeat() + signed(HEARTBEAT, timestamp=100)
    with pytest.raises(KeyError):
        link.recv_msg()
    assert [msg.get_signed() for msg in drain(link)] == [True]
    assert link.mav.signing.unsigned_count == 0


def test_with_a_key_unsigned_frames_are_no_messages():
    """R43, R44, R47, R48."""
    link = link_with_key()
    unknown = bytearray(pack(SETUP))
    unknown[7:10] = (0xFF, 0xFF, 0xEE)
    link.rx += heartbeat() + heartbeat(v1=True) + unknown
    assert types(drain(link)) == ["BAD_DATA"] * 3
    link.rx += signed(HEARTBEAT, timestamp=100, link_id=9)
    (msg,) = drain(link)
    assert (msg.get_signed(), msg.get_link_id()) == (True, 9)
    assert link.mav_count == 1


def test_link_id_0_adopts_the_one_of_the_target_alone():
    """R57."""
    link = link_with_key(link_id=0)
    link.target_system, link.target_component = 2, 1
    link.rx += signed(HEARTBEAT, timestamp=100, link_id=9)
    drain(link)
    assert link.mav.signing.link_id == 0
    link.target_system = 1
    link.rx += signed(HEARTBEAT, timestamp=101, link_id=9)
    drain(link)
    assert link.mav.signing.link_id == 9
    link.rx += signed(HEARTBEAT, timestamp=102, link_id=10)
    drain(link)
    assert link.mav.signing.link_id == 9


def test_link_id_0_adopts_that_of_any_component_while_none_is_chosen():
    """R57."""
    link = link_with_key(link_id=0)
    link.rx += signed(HEARTBEAT, timestamp=100, link_id=9)
    drain(link)
    assert (link.target_system, link.target_component) == (1, 0)
    link.rx += signed(HEARTBEAT, timestamp=101, link_id=9)
    drain(link)
    assert link.mav.signing.link_id == 9
    link = link_with_key(link_id=0)
    link.target_system, link.target_component = 1, 2
    link.rx += signed(HEARTBEAT, timestamp=102, link_id=9)
    drain(link)
    assert link.mav.signing.link_id == 0


# -- the key


def test_a_key_is_sent_to_the_target_and_to_nobody_else():
    """R53."""
    link = Capture()
    with pytest.raises(ValueError, match="target_system"):
        link.send_signing_key(KEY)
    link.target_system, link.target_component = 5, 1
    with pytest.raises(ValueError, match="32 bytes"):
        link.send_signing_key(KEY[1:])
    link.send_signing_key(KEY, initial_timestamp=77)
    msg = mavlink.MAVLink(None).parse_buffer(bytes(link.tx))[0]
    assert (msg.get_type(), msg.target_system, msg.initial_timestamp) == ("SETUP_SIGNING", 5, 77)
    assert bytes(msg.secret_key) == KEY


def received_setup() -> list:
    """SETUP_SIGNING as it was built, as it was received, and as somebody changed it."""
    received = mavlink.MAVLink(None).parse_buffer(pack(SETUP))[0]
    changed = mavlink.MAVLink(None).parse_buffer(pack(SETUP))[0]
    changed.initial_timestamp = 3
    return [SETUP, received, changed]


@pytest.mark.parametrize("msg", received_setup(), ids=["built", "received", "changed"])
def test_texts_show_no_key(msg, capsys):
    """R53. The value itself is there for who asks for it."""
    shown = "255, " * 31 + "255"
    assert f"secret_key : [{shown}]" in str(msg)
    assert json.loads(msg.to_json())["secret_key"] == [255] * 32
    mavutil.dump_message_verbose(sys.stdout, msg)
    assert f"secret_key: [{shown}]" in capsys.readouterr().out
    assert list(msg.secret_key) == list(KEY[::-1])
    assert list(msg.to_dict()["secret_key"]) == list(KEY[::-1])


def test_reprs_of_links_show_no_key():
    """R56."""
    link = link_with_key()
    for shown in (repr(link), repr(link.mav), repr(link.mav.signing), str(link.mav.signing)):
        assert "\\x01\\x02" not in shown
