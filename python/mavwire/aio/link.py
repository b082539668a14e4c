"""`Link`: one link of mavutil in an asyncio loop."""

from __future__ import annotations

import asyncio
import logging
import math
import weakref
from collections.abc import Callable, Coroutine, Iterable
from contextlib import suppress
from functools import partial
from typing import Any

from mavwire.links.mavfile import IDLE_INTERVAL, mavfile
from mavwire.links.signing import prepared
from mavwire.links.tlog import mavlogfile

from .background import close_in_background, in_background
from .deadline import deadline_after
from .errors import EndOfLogError, LinkClosedError
from .feed import Feed, Position
from .filters import message_filter
from .log_feed import LogFeed
from .outgoing import Outgoing
from .parameters import Parameters
from .pump import Pump
from .stream import Newest, Stream, newer
from .texts import Texts
from .transports import transport_of

BACKLOG = 4096
# How long closing waits for a peer to take what was sent to it.
CLOSE_TIMEOUT = 1.0

logger = logging.getLogger("mavwire.aio")


def _of_sync(name: str, doc: str) -> Any:
    """A property that is an attribute of the link of mavutil."""
    return property(
        lambda self: getattr(self.sync, name),
        lambda self, value: setattr(self.sync, name, value),
        doc=doc,
    )


class Link(Parameters):
    """A link or a log, opened by `connect`, or around a link of mavutil that nobody else reads.

    Every task that receives has its own place in what arrives, which begins with the first call:
    tasks do not take messages from each other. `backlog` messages are kept for those that are busy;
    what they come too late for is counted in `dropped`. Not for use from other threads.
    """

    def __init__(self, sync: Any, *, backlog: int = BACKLOG) -> None:
        self.sync = sync
        self._loop = asyncio.get_running_loop()
        self._positions: weakref.WeakKeyDictionary[Any, Position] = weakref.WeakKeyDictionary()
        self._nobody = Position(0)
        self._closing: asyncio.Task[None] | None = None
        self._live: _Live | None = None
        self._feed: Feed | LogFeed
        if not isinstance(sync, mavfile) or isinstance(sync, mavlogfile):
            self._feed = LogFeed(self._loop, sync)
        else:
            self._feed = Feed(self._loop, backlog)
            self._live = _Live(self._loop, sync, self._feed)
        super().__init__()

    def __repr__(self) -> str:
        address = getattr(self.sync, "address", None) or type(self.sync).__name__
        return f"<{type(self).__name__} {address}>"

    # -- receiving

    def __aiter__(self) -> Stream:
        """Every message that arrives, from where this task stopped receiving."""
        return Stream(self._feed.reader(None, self._position()))

    def recv_msg(self) -> Coroutine[Any, Any, Any]:
        """Await the next message of any kind; None at the end of a log."""
        return self.recv_match()

    def recv_match(
        self,
        condition: str | None = None,
        type: str | Iterable[str] | None = None,
        timeout: float | None = None,
        *,
        sysid: int | None = None,
        compid: int | None = None,
    ) -> Coroutine[Any, Any, Any]:
        """Await the next message of `type` (a name or several) for which `condition` holds.

        Messages before it are passed over, for this task. None after `timeout` seconds and at the
        end of a log; LinkClosedError when the link was closed or lost for good. With a timeout of 0 only
        what is there counts. Cancelling the wait passes over nothing.
        """
        # Not a coroutine function: the task that calls counts, even if it is another that awaits.
        wants = message_filter(self.sync, type, condition, sysid, compid)
        reader = self._feed.reader(wants, self._position(), condition is not None)
        return self._next(reader, timeout)

    async def _next(self, reader: Any, timeout: float | None) -> Any:
        deadline = deadline_after(self._loop, timeout)
        try:
            return await reader.next(deadline)
        except EndOfLogError:
            return None

    def stream(
        self,
        type: str | Iterable[str] | None = None,
        condition: str | None = None,
        *,
        sysid: int | None = None,
        compid: int | None = None,
    ) -> Stream:
        """The wanted messages from now on, to be iterated over with `async for`."""
        wants = message_filter(self.sync, type, condition, sysid, compid)
        return Stream(self._feed.reader(wants, None, condition is not None))

    def texts(self, *, sysid: int | None = None, compid: int | None = None) -> Texts:
        """Status texts from now on, for `async for`. A text that several messages carry is one text."""
        return Texts(self.stream("STATUSTEXT", sysid=sysid, compid=compid))

    def _position(self) -> Position:
        """Where the calling task stopped receiving; the end of the feed if it has not begun."""
        try:
            task: Any = asyncio.current_task()
        except RuntimeError:
            task = None
        if task is None or isinstance(self._feed, LogFeed):
            return self._nobody
        position = self._positions.get(task)
        if position is None:
            position = self._positions[task] = Position(self._feed.count)
        return position

    # -- the newest

    def latest(
        self, type: str, sysid: int | None = None, compid: int | None = None,
        max_age: float | None = None,
    ) -> Any:  # fmt: skip
        """The newest message of `type` from a system (the target) or one of its components; None if
        there is none, or none that is at most `max_age` seconds old."""
        if isinstance(self.sync, mavfile):
            return self.sync.latest(type, sysid, compid, max_age)
        return self.sync.messages.get(type)  # of a dataflash log, which is of one vehicle

    def age(self, type: str, sysid: int | None = None, compid: int | None = None) -> float:
        """Seconds since the newest message of `type`; infinite while there is none."""
        if isinstance(self.sync, mavfile):
            return self.sync.age(type, sysid, compid)
        msg = self.sync.messages.get(type)
        return math.inf if msg is None else float(self.sync.timestamp - msg._timestamp)

    def newest(self, type: str, sysid: int | None = None, compid: int | None = None) -> Newest:
        """The newest message of `type` whenever it is newer than the last one, for `async for`: a
        slow consumer gets the present instead of a backlog."""
        reader = self._newest_reader(type, sysid, compid)
        return Newest(reader, lambda: self.latest(type, sysid, compid))

    async def wait_newer(
        self, type: str, than: Any = None, sysid: int | None = None, compid: int | None = None,
        timeout: float | None = None,
    ) -> Any:  # fmt: skip
        """The newest message of `type` as soon as it is another than `than`, which is the one that is
        there now if none is given. TimeoutError after `timeout` seconds."""
        deadline = deadline_after(self._loop, timeout)
        reader = self._newest_reader(type, sysid, compid)
        than = self.latest(type, sysid, compid) if than is None else than
        msg = await newer(reader, lambda: self.latest(type, sysid, compid), than, deadline)
        if msg is None:
            raise TimeoutError(f"no newer {type} within {timeout} s")
        return msg

    def _newest_reader(self, type: str, sysid: int | None, compid: int | None) -> Any:
        name = type.partition("[")[0]  # of an instance, as in BATTERY_STATUS[1]
        return self._feed.reader(message_filter(self.sync, name, None, sysid, compid))

    # -- sending

    @property
    def mav(self) -> Any:
        """The `MAVLink` object: `link.mav.heartbeat_send(...)` sends at once or queues, and never
        blocks."""
        return self.sync.mav

    async def drain(self) -> None:
        """Wait until the system has taken what was sent: for a stream whose peer reads slowly."""
        if self._live is not None:
            await self._live.outgoing.drain()

    async def setup_signing(
        self,
        secret_key: bytes,
        sign_outgoing: bool = True,
        allow_unsigned_callback: Callable[[Any, int], bool] | None = None,
        initial_timestamp: int | None = None,
        link_id: int | None = None,
        timestamp_store: Any = None,
        max_ahead: float | None = None,
    ) -> None:
        """`sync.setup_signing`, with the same arguments and errors. A thread reads a `timestamp_store`;
        sending writes to it every ten seconds."""
        policy = (secret_key, sign_outgoing, allow_unsigned_callback, initial_timestamp, link_id)
        made = partial(prepared, *policy, timestamp_store, max_ahead)
        self.sync._begin_signing(made() if timestamp_store is None else await in_background(made))

    # -- state

    messages: dict[str, Any] = _of_sync("messages", "Type -> newest message of the target system.")
    target_system: int = _of_sync(
        "target_system", "The system that is addressed: the first vehicle heard, unless it is set."
    )
    target_component: int = _of_sync("target_component", "The component addressed; 0 is all.")
    flightmode: str = _of_sync("flightmode", "The target's flight mode by name.")

    @property
    def connected(self) -> bool:
        """Whether the link has its other end, as far as it can know: datagrams and logs always do."""
        return self._closing is None and (self._live is None or self._live.connected)

    @property
    def dropped(self) -> int:
        """Messages that readers came too late for, added up over all of them."""
        return self._feed.dropped

    @property
    def frames_dropped(self) -> int:
        """Frames that were not sent because nobody was there or had stopped reading."""
        return 0 if self._live is None else self._live.outgoing.dropped

    # -- closing

    async def close(self) -> None:
        """Send what is queued, if that is quick, and close. Waiting tasks get `LinkClosedError`."""
        await self._closed(drains=True)

    async def _closed(self, *, drains: bool) -> None:
        if self._closing is None:
            self._closing = self._loop.create_task(self._close(drains))
        await asyncio.shield(self._closing)

    async def _close(self, drains: bool) -> None:
        if self._live is not None:
            if drains:
                with suppress(TimeoutError):
                    async with asyncio.timeout(CLOSE_TIMEOUT):
                        await self._live.outgoing.drain()
            self._live.stop()
        self._feed.end(LinkClosedError(f"{self!r} is closed"))
        if hasattr(self.sync, "close"):
            await close_in_background(self.sync.close)

    async def __aenter__(self) -> Link:
        return self

    async def __aexit__(self, kind: object = None, *_: object) -> None:
        # A cancelled task, as by Ctrl-C, does not wait for a peer that reads slowly.
        await self._closed(drains=kind is not asyncio.CancelledError)


class _Live:
    """The reader, the sender and the timers of a live link."""

    def __init__(self, loop: asyncio.AbstractEventLoop, sync: Any, feed: Feed) -> None:
        self._loop = loop
        self._sync = sync
        self._feed = feed
        self._transport = transport_of(sync)
        self.pump = Pump(loop, sync, feed, self._turned)
        self.outgoing = Outgoing(
            loop, self._transport.sender(), lambda: self.connected, self._failed, self._written
        )
        sync.mav.file = self.outgoing
        self._transport.moved = self._follow
        self.connected = False
        self._look_timer: asyncio.TimerHandle | None = None
        self._retry_timer: asyncio.TimerHandle | None = None
        if self._transport.is_there():
            self._begin()
        else:
            self._lost(None)
        self._look_later()

    def stop(self) -> None:
        """Stop reading, sending and reconnecting. The link is closed afterwards."""
        self.connected = False
        self.pump.stop()
        self.outgoing.stop()
        self._transport.stop()
        for timer in (self._look_timer, self._retry_timer):
            if timer is not None:
                timer.cancel()

    def _begin(self) -> None:
        self.connected = True
        self.pump.start()

    def _look_later(self) -> None:
        interval = self._transport.look_interval
        if interval is not None:
            self._look_timer = self._loop.call_later(interval, self._look)

    def _look(self) -> None:
        self._look_later()
        self._transport.look()
        self._follow()

    def _turned(self, error: Exception | None) -> None:
        """Reading is over for now; the link may have another descriptor, or none."""
        self.outgoing.follow()
        if error is not None:
            self._failed(error)
        elif not self._transport.is_there():
            self._lost(None)

    def _written(self) -> None:
        """Something was sent, by which the link may have learnt that its peer is gone."""
        if not self._transport.is_there():
            self._lost(None)
        else:
            self._follow()

    def _follow(self) -> None:
        """Watch the descriptors that the link has now."""
        self.outgoing.follow()
        self.pump.check()

    def _failed(self, error: Exception) -> None:
        if not self._transport.is_there() or self._transport.broke(error):
            self._lost(error)
        elif not self._feed.fail(error):
            context = {"message": "receiving failed and nobody waits", "exception": error}
            self._loop.call_exception_handler(context)

    def _lost(self, error: Exception | None) -> None:
        self.connected = False
        self.pump.stop()
        self.outgoing.stop()
        self._transport.let_go()
        address = self._sync.address
        if self._transport.reconnects:
            logger.info("%s: connection lost, connecting again", address)
            self._try_again()
            return
        end = LinkClosedError(f"{address}: the other end is gone")
        end.__cause__ = error
        self._feed.end(end)

    def _try_again(self) -> None:
        self._transport.try_again()
        if self._transport.is_there():
            logger.info("%s: connected", self._sync.address)
            self._begin()
        else:
            self._retry_timer = self._loop.call_later(IDLE_INTERVAL, self._try_again)
