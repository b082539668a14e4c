"""Loops and peers for the tests of mavwire.aio."""

from __future__ import annotations

import asyncio
import importlib.util
import socket
import traceback
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from typing import Any

import pytest
from mavwire import aio
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import pack

# No test takes as long: what waits for ever fails.
LIMIT = 240.0
WAIT = 60.0


class Unwatching(asyncio.SelectorEventLoop):
    """A loop that watches no descriptors, as the proactor loop of Windows does not."""

    def add_reader(self, fd: Any, callback: Any, *args: Any) -> Any:
        raise NotImplementedError

    def add_writer(self, fd: Any, callback: Any, *args: Any) -> Any:
        raise NotImplementedError


def uvloop() -> asyncio.AbstractEventLoop:
    module: Any = pytest.importorskip("uvloop", reason="uvloop is not installed")
    loop: asyncio.AbstractEventLoop = module.new_event_loop()
    return loop


LOOPS: dict[str, Callable[[], asyncio.AbstractEventLoop]] = {
    "asyncio": asyncio.SelectorEventLoop,
    "uvloop": uvloop,
    "unwatching": Unwatching,
}


def run(
    main: Coroutine[Any, Any, Any],
    loop: Callable[[], asyncio.AbstractEventLoop] = asyncio.SelectorEventLoop,
) -> Any:
    """Run `main` in a loop of its own; what the loop's exception handler gets fails the test."""

    async def limited() -> Any:
        failures: list[Any] = []
        asyncio.get_running_loop().set_exception_handler(lambda _, found: failures.append(found))
        async with asyncio.timeout(LIMIT):
            result = await main
        assert not failures
        return result

    try:
        with asyncio.Runner(loop_factory=loop) as runner:
            return runner.run(limited())
    finally:
        main.close()  # which was not awaited where the loop could not be made


async def refusals(receive: Callable[[], Coroutine[Any, Any, Any]], count: int) -> list[int]:
    """Through how many calls the error comes that `receive` raises, each time it is called."""
    lengths = []
    for _ in range(count):
        try:
            await receive()
        except aio.LinkClosedError as error:
            lengths.append(len(traceback.extract_tb(error.__traceback__)))
    return lengths


class Peer:
    """The other end of a UDP link."""

    def __init__(self, port: int) -> None:
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.connect(("127.0.0.1", port))
        self.sock.setblocking(False)
        self.seq = 0

    def send(self, msg: Any, sysid: int = 1, compid: int = 1) -> None:
        self.sock.send(pack(msg, self.seq, sysid, compid))
        self.seq = (self.seq + 1) & 255

    def attitudes(self, *numbers: int, sysid: int = 1, compid: int = 1) -> None:
        """ATTITUDE messages that `number` tells apart."""
        for number in numbers:
            self.send(attitude(number), sysid, compid)


@asynccontextmanager
async def udp_link(**options: Any) -> AsyncIterator[tuple[aio.Link, Peer]]:
    """A listening UDP link that has heard its peer, and the peer."""
    async with aio.connect("udpin:127.0.0.1:0", dialect="all", **options) as link:
        peer = Peer(link.sync.port.getsockname()[1])
        try:
            peer.send(heartbeat())
            await link.wait_heartbeat(timeout=WAIT)
            yield link, peer
        finally:
            peer.sock.close()


def heartbeat() -> Any:
    return mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)


def attitude(number: int) -> Any:
    return mavlink.MAVLink_attitude_message(number, 0.5, 0, 0, 0, 0, 0)


def number(msg: Any) -> int:
    return int(msg.time_boot_ms)


async def take(messages: Any, count: int) -> list[int]:
    """The numbers of the next ATTITUDEs of a stream."""
    found: list[int] = []
    while len(found) < count:
        msg = await asyncio.wait_for(anext(messages), WAIT)
        if msg.get_type() == "ATTITUDE":
            found.append(number(msg))
    return found


async def eventually(condition: Callable[[], Any]) -> None:
    """Wait until `condition()`, which the loop's other work brings about."""
    async with asyncio.timeout(WAIT):
        while not condition():
            await asyncio.sleep(0.005)


def has(module: str) -> bool:
    return importlib.util.find_spec(module) is not None
