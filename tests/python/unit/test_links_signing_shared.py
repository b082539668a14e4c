"""Signing that is set up from several threads and processes: each link is a stream of its own, and all streams of a key
are known to each link."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.links import signing as signing_module
from mavwire.links import state
from mavwire.links.link_ids import claim
from mavwire.links.timestamp_store import TimestampStore
from unit.faults import ENVIRONMENT, python
from unit.link_tools import KEY, Capture, at_once, drain, signed, types
from watchdog import watched

fcntl = pytest.importorskip("fcntl", reason="without locks nothing is known of other processes")

WAIT = 60

# Says its link id and what it sends, and stays until its standard input ends.
PROGRAM = """
import sys
import threading
from mavwire import mavutil
path, link_id = sys.argv[1:]
class Link(mavutil.mavfile):
    def write(self, frame):
        print(self.mav.signing.link_id, frame.hex(), flush=True)
link = Link(None, "output")
link.setup_signing(bytes(range(32)), timestamp_store=path, link_id=None if link_id == "-" else int(link_id))
link.mav.heartbeat_send(6, 8, 0, 0, 0)
sys.stdin.read()
"""


class Program:
    """Another process that signs."""

    def __init__(self, store: object, link_id: str = "-") -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, str(store), link_id],
            env={**ENVIRONMENT, "MAVLINK20": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        number, frame = self.process.stdout.readline().split()
        self.link_id, self.frame = int(number), bytes.fromhex(frame)

    def kill(self) -> None:
        self.process.kill()
        self.process.communicate(timeout=WAIT)

    def end(self) -> str:
        """What it said on standard error."""
        said: str = self.process.communicate(timeout=WAIT)[1]
        return said


@pytest.fixture(autouse=True)
def first_link(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As in a process that has set up no link yet."""
    monkeypatch.setattr(state, "global_link_id", 0)
    mavutil.set_wire_protocol("2.0")
    mavutil.set_dialect("all")
    yield
    mavutil.set_wire_protocol(None)
    mavutil.set_dialect("all")


def sent(link: Capture) -> bytes:
    """The next frame of a link."""
    link.tx.clear()
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    return bytes(link.tx)


# -- processes


def test_processes_that_share_a_store_are_all_believed(tmp_path):
    """R39: with one link id the first would be mute until its clock has passed what the second began with."""
    path = tmp_path / "timestamps"
    ours, listener = Capture(), Capture()
    listener.setup_signing(KEY, link_id=9)
    ours.setup_signing(KEY, timestamp_store=path)
    listener.rx += sent(ours)
    other = Program(path)
    listener.rx += other.frame + sent(ours)
    assert types(drain(listener)) == ["HEARTBEAT"] * 3
    assert listener.mav.signing.badsig_count == 0
    assert (ours.mav.signing.link_id, other.link_id, other.end()) == (1, 2, "")


def test_processes_do_not_follow_the_target_to_one_link_id(tmp_path):
    """R57 is for a link id of 0, which nobody has who shares a store, unless asked for."""
    link = Capture()
    link.setup_signing(KEY, timestamp_store=tmp_path / "timestamps")
    link.rx += signed(mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3), 1 << 47, link_id=2)
    assert [msg.get_signed() for msg in drain(link)] == [True]
    assert (link.target_system, link.mav.signing.link_id) == (1, 1)


def test_link_ids_are_free_again_when_a_process_has_ended(tmp_path):
    """Receivers have room for few streams."""
    path = tmp_path / "timestamps"
    first = Program(path)
    first.kill()
    second = Program(path)
    assert (first.link_id, second.link_id, second.end()) == (1, 1, "")


def test_links_of_this_process_go_round_those_of_others(tmp_path):
    path = tmp_path / "timestamps"
    links = [Capture() for _ in range(4)]
    with open(f"{path}.link2", "wb") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        links[0].setup_signing(KEY, timestamp_store=path)
        links[1].setup_signing(KEY, timestamp_store=path)
        links[2].setup_signing(KEY)
        links[3].setup_signing(KEY, timestamp_store=str(path))
    assert [link.mav.signing.link_id for link in links] == [1, 3, 4, 5]
    assert mavutil.global_link_id == 6


def test_a_link_id_that_two_processes_ask_for_is_warned_of(tmp_path):
    path = tmp_path / "timestamps"
    Capture().setup_signing(KEY, timestamp_store=path, link_id=7)
    Capture().setup_signing(KEY, timestamp_store=path, link_id=7)
    other = Program(path, "7")
    assert other.link_id == 7
    assert "another process signs with link id 7, too" in other.end()


def test_the_last_link_id_is_used_whoever_has_it(tmp_path, caplog):
    path = tmp_path / "timestamps"
    mavutil.global_link_id = 254
    link = Capture()
    with open(f"{path}.link254", "wb") as one, open(f"{path}.link255", "wb") as other:
        for file in (one, other):
            fcntl.flock(file, fcntl.LOCK_EX)
        link.setup_signing(KEY, timestamp_store=path)
    assert (link.mav.signing.link_id, mavutil.global_link_id) == (255, 255)
    assert "another process signs with link id 255" in caplog.text


def test_where_ids_cannot_be_kept_apart_that_is_said(tmp_path, caplog):
    path = tmp_path / "timestamps"
    (tmp_path / "timestamps.link1").mkdir()
    link = Capture()
    link.setup_signing(KEY, timestamp_store=path)
    assert (link.mav.signing.link_id, link.mav.signing.secret_key) == (1, KEY)
    assert caplog.text.count("give each a link_id") == 1


def test_a_file_system_without_locks_is_no_obstacle(tmp_path, caplog, monkeypatch):
    def refuse(fd, how):
        raise OSError(37, "No locks available")

    monkeypatch.setattr(fcntl, "flock", refuse)
    assert claim(tmp_path / "timestamps", 3)
    assert "No locks available" in caplog.text


# -- threads


def test_threads_that_ask_for_one_link_id_are_one_process(tmp_path, monkeypatch):
    path, lock, answers = tmp_path / "timestamps", fcntl.flock, []

    def meanwhile(fd, how):
        monkeypatch.setattr(fcntl, "flock", lock)
        answers.append(claim(path, 7))  # by another thread
        lock(fd, how)

    monkeypatch.setattr(fcntl, "flock", meanwhile)
    answers.append(claim(path, 7))
    assert answers == [True, True]


def test_a_link_id_is_this_process_s_once_it_is_locked(tmp_path, monkeypatch):
    path, lock, answers = tmp_path / "timestamps", fcntl.flock, []
    inside, go = threading.Event(), threading.Event()

    def refuse(fd, how):
        monkeypatch.setattr(fcntl, "flock", lock)
        inside.set()
        assert go.wait(WAIT)
        raise BlockingIOError(errno.EAGAIN, "another process has it")

    monkeypatch.setattr(fcntl, "flock", refuse)
    first = threading.Thread(target=lambda: answers.append(claim(path, 7)))
    first.start()
    assert inside.wait(WAIT)
    holder = os.open(f"{os.path.realpath(path)}.link7", os.O_RDWR | os.O_CREAT)
    lock(holder, fcntl.LOCK_EX)
    second = threading.Thread(target=lambda: answers.append(claim(path, 7)))
    second.start()
    go.set()
    for thread in (first, second):
        thread.join(WAIT)
    os.close(holder)
    assert answers == [False, False]


class Dawdling:
    """Stands for the state of all links, where reading a number takes a moment."""

    number = 0

    @property
    def global_link_id(self) -> int:
        number = self.number
        time.sleep(0.001)
        return number

    @global_link_id.setter
    def global_link_id(self, number: int) -> None:
        self.number = number


def test_links_that_threads_set_up_have_different_ids(monkeypatch):
    monkeypatch.setattr(signing_module, "state", Dawdling())
    links = [[Capture() for _ in range(5)] for _ in range(6)]
    at_once(lambda number: [link.setup_signing(KEY) for link in links[number]], len(links))
    numbers = [link.mav.signing.link_id for own in links for link in own]
    assert sorted(numbers) == list(range(30))


class Guarded(list):
    """The links with a key, which one thread at a time may look through or change."""

    users = most = 0

    def __iter__(self):
        self.users += 1
        self.most = max(self.most, self.users)
        time.sleep(0.002)
        yield from list(super().__iter__())
        self.users -= 1

    def __setitem__(self, place, items) -> None:
        self.most = max(self.most, self.users + 1)
        super().__setitem__(place, items)


def test_threads_wait_for_each_other_to_share_streams(monkeypatch):
    """R42b."""
    guarded = Guarded()
    monkeypatch.setattr(signing_module, "_with_key", guarded)
    links = [Capture() for _ in range(6)]

    def work(number: int) -> None:
        for _ in range(5):
            links[number].setup_signing(KEY)
            links[number].disable_signing()
        links[number].setup_signing(KEY)

    at_once(work, len(links))
    assert guarded.most == 1
    listened = [link.mav.signing.stream_timestamps for link in links]
    links[0].mav.signing.stream_timestamps = {(1, 2, 3): 4}
    assert listened == [{}] * 6
    assert [link.mav.signing.stream_timestamps for link in links] == [{(1, 2, 3): 4}] * 6


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_fork_while_another_thread_stores_a_timestamp(tmp_path):
    """Neither process holds up the other, nor a third one, as long as it lives."""
    program = """
import os, signal, sys, threading
from mavwire.links.timestamp_store import TimestampStore
store, inside, go = TimestampStore(sys.argv[1]), threading.Event(), threading.Event()
home, fsync = os.getpid(), os.fsync
def held(fd):
    if os.getpid() == home and threading.current_thread().name == "held":
        inside.set()
        go.wait()
    fsync(fd)
os.fsync = held
thread = threading.Thread(target=store.save, args=[1000], name="held", daemon=True)
thread.start()
inside.wait()
child_goes, parent_says = os.pipe()
pid = os.fork()
if pid == 0:
    signal.alarm(60)
    os.read(child_goes, 1)
    store.save(3000)
    os._exit(0)
go.set()
thread.join()
signal.alarm(60)
store.save(2000)
os.write(parent_says, b"x")
assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
assert store.load() == 3000
os._exit(0)
"""
    done = python(program, str(tmp_path / "timestamps"))
    assert (done.returncode, done.stderr) == (0, "")


def test_a_store_whose_unlocking_fails_is_not_left_locked(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")
    lock = fcntl.flock

    def fail(fd, operation):
        if operation == fcntl.LOCK_UN:
            raise OSError(errno.ENOLCK, "No locks available")
        lock(fd, operation)

    store = TimestampStore(tmp_path / "store")
    with monkeypatch.context() as patch:
        patch.setattr(fcntl, "flock", fail)
        with pytest.raises(OSError, match="No locks"):
            store.save(1)
    with watched(WAIT):
        store.save(2)
    assert store.load() == 2


def test_a_store_that_is_replaced_while_it_stores_has_no_say_over_the_next(tmp_path):
    """A peer may have been a day ahead of what the next store begins with."""
    saved: list[int] = []

    class Slow:
        link: Any = None

        def load(self) -> int:
            return 0

        def save(self, timestamp: int) -> None:
            if self.link is not None:  # another thread, while this one waits for the disk
                link, self.link = self.link, None
                link.setup_signing(KEY, initial_timestamp=0, timestamp_store=Next())

    class Next:
        def load(self) -> int:
            return 0

        def save(self, timestamp: int) -> None:
            saved.append(timestamp)

    link, slow = Capture(), Slow()
    link.setup_signing(KEY, timestamp_store=slow)
    link.mav.signing.timestamp = 1 << 47
    slow.link = link
    sent(link)
    (first,) = saved
    link.mav.signing.timestamp = first + 1
    sent(link)
    assert len(saved) == 2


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_fork_while_another_thread_sets_up_a_link(tmp_path):
    program = """
import os, signal, sys, threading
from mavwire.links import signing
from unit.link_tools import KEY, Capture
link, held = Capture(), threading.Event()
def hold():
    with signing.section:
        held.set()
        threading.Event().wait()
threading.Thread(target=hold, daemon=True).start()
held.wait()
pid = os.fork()
if pid == 0:
    signal.alarm(60)
    link.setup_signing(KEY, timestamp_store=sys.argv[1])
    link.disable_signing()
    os._exit(0)
assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
os._exit(0)
"""
    done = python(program, str(tmp_path / "timestamps"))
    assert (done.returncode, done.stderr) == (0, "")
