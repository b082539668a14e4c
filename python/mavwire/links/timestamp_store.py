"""Signing timestamps that survive a restart, also with a wrong clock.

A file holds two slots; the one with the smaller timestamp is overwritten and the larger one read, so
that a write which was cut short loses nothing. The stored timestamp is ahead of the one in use, so that
writing now and then is enough (MAVLink guide, Message Signing: at least once a minute).
"""

from __future__ import annotations

import errno
import os
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from io import FileIO
from time import monotonic

from . import Any, Callable, warn
from .signing_time import MAX_TIMESTAMP, UNITS_PER_SECOND

# How far ahead is stored: ten seconds. Restarting more often than that runs ahead of the clock.
RESERVE = 10 * UNITS_PER_SECOND
# A timestamp and its checksum, which tells a whole slot from half of one.
SLOT = 8 + 4
# Where each slot begins: far enough apart for no write to touch both.
SLOT_OFFSETS = (0, 4096)
SIZE = SLOT_OFFSETS[-1] + SLOT
# How long others may take who store at the same time, on a slow card: when signing begins, and later, when sending waits.
FIRST_PATIENCE = 10.0
LOCK_PATIENCE = 1.0
LOCK_INTERVAL = 0.005


class TimestampStore:
    """A file that remembers a signing timestamp, for any number of links and processes."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = path
        # Daemons change their folder.
        self._path = os.path.abspath(os.fsdecode(path))

    def load(self) -> int:
        """The timestamp to go on from; 0 where nothing was stored. OSError if it cannot be read, or is
        another kind of file."""
        try:
            with _opened(self._path, "r") as file:
                return max(self._slots(file.fileno()))
        except FileNotFoundError:
            return 0

    def save(self, timestamp: int) -> None:
        """Store `timestamp` for good, unless a later one is; OSError if that fails."""
        self._save(timestamp, LOCK_PATIENCE)

    def _save(self, timestamp: int, patience: float) -> None:
        with _made(self._path) as file, _locked(file.fileno(), self._path, patience):
            self._put(file.fileno(), timestamp)

    def _put(self, fd: int, timestamp: int) -> None:
        """Write `timestamp` over the earlier of both, unless one is as late."""
        slots = self._slots(fd)
        if timestamp <= max(slots):
            return
        os.lseek(fd, SLOT_OFFSETS[slots.index(min(slots))], os.SEEK_SET)
        if os.write(fd, _packed(timestamp)) < SLOT:
            if not any(slots):  # what is left would be taken for somebody's file
                os.ftruncate(fd, 0)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), self._path)
        os.fsync(fd)

    def _slots(self, fd: int) -> list[int]:
        """The timestamps in the slots; 0 for one that was never written, or not to its end."""
        os.lseek(fd, 0, os.SEEK_SET)
        content = os.read(fd, SIZE)
        slots = [_unpacked(content[start : start + SLOT]) for start in SLOT_OFFSETS]
        # A disk that lost power may hold zeros where nothing was written yet.
        if os.fstat(fd).st_size > SIZE or (not any(slots) and any(content)):
            reason = "is no timestamp store: name a file of its own, or remove this one"
            raise OSError(errno.EINVAL, reason, self._path)
        return slots

    def _claim(self, link_id: int) -> bool:
        """Whether `link_id` is this process's until it ends, as far as all others use this file."""
        from .link_ids import claim

        return claim(self._path, link_id)


def store_of(given: Any) -> Any:
    """The store that is meant by a path of a file or an object with `load` and `save`; TypeError for
    what is neither."""
    if hasattr(given, "load"):
        return given
    is_path = isinstance(given, (str, bytes, os.PathLike))
    if not is_path:
        reason = "timestamp_store is a path, or an object with load and save"
        raise TypeError(f"{reason}, not {given!r}")
    return TimestampStore(given)


def _opened(path: str, mode: str) -> FileIO:
    """The file at `path`. It owns its descriptor from the beginning, so that none is left open, nor locked, wherever a
    signal handler raises. OSError for what is no file, which opening may wait for, as for a pipe, or may change.
    """
    if not stat.S_ISREG(os.stat(path).st_mode):
        raise OSError(errno.EINVAL, "is no file that could be a timestamp store", path)
    return FileIO(path, mode)


def _made(path: str) -> FileIO:
    """The file at `path`, to read and to write, made if there is none."""
    try:
        return _opened(path, "r+")
    except FileNotFoundError:
        pass
    try:
        # Where `path` is a link to a file that is not there yet, that one is made.
        return FileIO(os.path.realpath(path), "x+", opener=partial(os.open, mode=0o600))
    except FileExistsError:  # another process has made it meanwhile
        return _opened(path, "r+")


@contextmanager
def _locked(fd: int, path: str, patience: float) -> Iterator[None]:
    """Keep others out, where the platform can: two that overwrite the same slot would leave the smaller timestamp.
    OSError where it takes more than `patience` seconds.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    deadline = monotonic() + patience
    try:
        while True:
            try:
                fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if monotonic() > deadline:
                    reason = f"was locked by others for {patience} s"
                    raise OSError(errno.EAGAIN, reason, path) from None
            time.sleep(LOCK_INTERVAL)
        yield
    finally:
        # A process that was forked meanwhile may have a copy of `fd`. There the generator ends when it is closed.
        try:
            fcntl.flock(fd, fcntl.LOCK_UN)
        except OSError as error:
            if error.errno != errno.EBADF:
                raise


def _packed(timestamp: int) -> bytes:
    from binascii import crc32

    number = timestamp.to_bytes(8, "little")
    return number + crc32(number).to_bytes(4, "little")


def _unpacked(slot: bytes) -> int:
    timestamp = int.from_bytes(slot[:8], "little")
    return timestamp if slot == _packed(timestamp) else 0


def ahead(timestamp: int, lead: int) -> int:
    """`timestamp` and `lead`, within the 48 bits: what lies beyond could not be loaded again."""
    return min(timestamp + lead, MAX_TIMESTAMP)


def keeper(store: Any, timestamp: int) -> Callable[[int], int]:
    """A function that stores a timestamp ahead of the one given and returns it.

    `timestamp` is the first one, which is stored now: a store that fails at once raises what it
    likes. One that fails later does not stop the link; it is reported once.
    """
    mark = wanted = ahead(timestamp, RESERVE)
    is_ours = isinstance(store, TimestampStore) and type(store).save is TimestampStore.save
    if is_ours:
        store._save(mark, FIRST_PATIENCE)
    else:
        store.save(mark)
    failed = False

    def keep(timestamp: int) -> int:
        nonlocal mark, wanted, failed
        if timestamp < mark:
            return mark
        later = ahead(timestamp, RESERVE)
        # Said before it is stored: who overwrites it with an earlier one, in a store of the user's, stores it again.
        wanted = max(wanted, later)
        try:
            store.save(later)
            while later < (newest := max(wanted, mark)):
                later = newest
                store.save(later)
        except Exception as error:  # a store of the user's own fails in ways of its own
            if not failed:
                warn("signing timestamps are not stored: %s", error)
            failed = True
        # Not before: another thread goes on at once with what lies below.
        mark = max(mark, later)
        return mark

    return keep
