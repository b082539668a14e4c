"""`connect`: opening a link without blocking the loop."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Generator
from typing import Any, TypedDict, Unpack

from mavwire.dialects import UPSTREAM
from mavwire.links import state
from mavwire.links.connection import CLIENTS

from .background import close_in_background, in_background
from .feed import check_backlog
from .link import BACKLOG, Link

DEFAULT_RETRIES = 3


class Options(TypedDict, total=False):
    """The keyword arguments of `mavutil.mavlink_connection`."""

    baud: int
    source_system: int
    source_component: int
    planner_format: bool | None
    write: bool
    append: bool
    robust_parsing: bool
    notimestamps: bool
    input: bool
    dialect: str | None
    autoreconnect: bool
    zero_time_base: bool
    retries: int
    reconnect_delay: float
    use_native: bool
    force_connected: bool
    progress_callback: Callable[[int], Any] | None
    udp_timeout: float
    resync: str | None


def connect(
    device: str | os.PathLike[str] | bytes, *, backlog: int = BACKLOG, **options: Unpack[Options]
) -> Connecting:
    """Open a link or a log: `async with connect(...) as link`, or `link = await connect(...)`.

    `device` and `options` are those of `mavutil.mavlink_connection`. `backlog` is how many messages
    are kept for readers that are busy.
    """
    return Connecting(os.fsdecode(device), backlog, dict(options))


class Connecting:
    """A link that is about to be opened: awaited it is the `Link`, and a context closes it too."""

    def __init__(self, device: str, backlog: int, options: dict[str, Any]) -> None:
        self._device = device
        self._backlog = backlog
        self._options = options
        self._link: Link | None = None

    def __await__(self) -> Generator[Any, None, Link]:
        return self._open().__await__()

    async def __aenter__(self) -> Link:
        self._link = await self._open()
        return self._link

    async def __aexit__(self, *exc_info: object) -> None:
        if self._link is not None:
            await self._link.__aexit__(*exc_info)

    async def _open(self) -> Link:
        check_backlog(self._backlog)
        options = dict(self._options)
        delay: float = options.get("reconnect_delay", 1.0)
        attempts = 1
        if self._device.startswith(tuple(CLIENTS)):
            attempts = max(options.get("retries", DEFAULT_RETRIES), 1)
            options["retries"] = 1  # the pauses between the attempts are the loop's
        progress = options.get("progress_callback")
        if progress is not None:
            loop = asyncio.get_running_loop()
            options["progress_callback"] = lambda percent: loop.call_soon_threadsafe(
                progress, percent
            )
        sync = await self._attempt(attempts, delay, options)
        try:
            return Link(sync, backlog=self._backlog)
        except BaseException:
            await close_in_background(lambda: _close(sync))
            raise

    async def _attempt(self, attempts: int, delay: float, options: dict[str, Any]) -> Any:
        for left in reversed(range(attempts)):
            try:
                return await in_background(lambda: _open(self._device, options), _close)
            except OSError:
                if not left:
                    raise
                await asyncio.sleep(delay)
        raise AssertionError("there is at least one attempt")


def _open(device: str, options: dict[str, Any]) -> Any:
    """Open a link. Connecting, looking up a name, opening a port or reading a log's index may block."""
    from mavwire import mavutil

    if state.current_dialect == state.DEFAULT_DIALECT and "MAVLINK_DIALECT" not in os.environ:
        options = {"dialect": UPSTREAM, **options}
    sync = mavutil.mavlink_connection(device, **options)
    sends_to_a_host = getattr(sync, "destination_addr", None) and hasattr(sync, "_destination")
    if sends_to_a_host and sync._destination() is None:
        sync.close()
        raise OSError(f"the address of {device} cannot be found")
    return sync


def _close(sync: Any) -> None:
    if hasattr(sync, "close"):
        sync.close()
