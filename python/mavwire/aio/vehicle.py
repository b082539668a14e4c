"""Waiting for a vehicle, commanding it, and asking it for messages."""

from __future__ import annotations

import asyncio
import math
from typing import Any

from mavwire import component_metadata
from mavwire.component_metadata import Kind
from mavwire.links import state

from .deadline import deadline_after
from .errors import CommandError, NoVehicleError
from .files import read_file
from .filters import Wants, message_filter

MAV_CMD_SET_MESSAGE_INTERVAL = 511
MAV_CMD_REQUEST_MESSAGE = 512
MAV_RESULT_ACCEPTED = 0
MAV_RESULT_IN_PROGRESS = 5

# How often something is sent when no answer comes, and how long each time is waited for one.
RETRIES = 3
TIMEOUT = 1.5
# How long a file transfer may stand still.
FILE_TIMEOUT = 10.0
# How long a vehicle that said that it is at work may take until it says so again.
PROGRESS_TIMEOUT = 30.0
MAX_CONFIRMATION = 255


class Vehicle:
    """The part of a link that talks to its target, or to the vehicle that is named."""

    sync: Any
    _feed: Any
    _loop: asyncio.AbstractEventLoop

    def __init__(self) -> None:
        # An acknowledgement names the command alone: equal ones must not be under way together.
        self._under_way: dict[tuple[int, int, int], asyncio.Lock] = {}

    async def wait_heartbeat(
        self, sysid: int | None = None, *, timeout: float | None = None
    ) -> Any:
        """The next HEARTBEAT of a vehicle, or of the one named; ground stations, gimbals and the like
        do not count. From then on it is the target, if there was none. TimeoutError."""
        is_heartbeat = message_filter(self.sync, "HEARTBEAT", None, sysid)

        def wants(msg: Any) -> object:
            return (
                is_heartbeat is not None
                and is_heartbeat(msg)
                and self.sync.probably_vehicle_heartbeat(msg)
            )

        deadline = deadline_after(self._loop, timeout)
        msg = await self._feed.reader(wants).next(deadline)
        if msg is None:
            raise TimeoutError(f"no heartbeat of a vehicle within {timeout} s")
        return msg

    async def command(
        self,
        command: int,
        *params: float,
        sysid: int | None = None,
        compid: int | None = None,
        retries: int = RETRIES,
        timeout: float = TIMEOUT,
    ) -> Any:
        """Send COMMAND_LONG with up to seven `params`, again up to `retries` times until it is
        acknowledged; the COMMAND_ACK.

        A vehicle that reports progress gets more time. CommandError if it does not accept,
        TimeoutError if it does not answer within `timeout` seconds each time.
        """
        if len(params) > 7:
            raise ValueError(f"a command has seven parameters, not {len(params)}")
        target = self._target(sysid, compid)
        padded = (*params, *[0.0] * (7 - len(params)))
        lock = self._under_way.setdefault((*target, command), asyncio.Lock())
        async with lock:
            reader = self._feed.reader(self._acknowledges(command, *target))
            for attempt in range(1 + retries):
                confirmation = min(attempt, MAX_CONFIRMATION)
                self.sync.mav.command_long_send(*target, command, confirmation, *padded)
                ack = await reader.next(deadline_after(self._loop, timeout))
                while ack is not None and ack.result == MAV_RESULT_IN_PROGRESS:
                    ack = await reader.next(self._loop.time() + PROGRESS_TIMEOUT)
                if ack is not None:
                    return _accepted(command, ack)
        raise TimeoutError(
            f"no answer to {_entry('MAV_CMD', command)} from system {target[0]} "
            f"after {1 + retries} attempts"
        )

    async def request_message(
        self, type: str, *params: float, sysid: int | None = None, compid: int | None = None,
        retries: int = RETRIES, timeout: float = TIMEOUT,
    ) -> Any:  # fmt: skip
        """Ask for one message of `type` and return it; `params` are what REQUEST_MESSAGE takes for it.

        It is asked for again if it does not come. Raises as `command` does; ValueError for a type
        that the dialect does not have.
        """
        target = self._target(sysid, compid)
        number = message_id(type)
        reader = self._feed.reader(message_filter(self.sync, type, None, target[0]))
        for _ in range(1 + retries):
            patience = timeout
            try:
                await self.command(
                    MAV_CMD_REQUEST_MESSAGE, number, *params,
                    sysid=target[0], compid=target[1], retries=0, timeout=timeout,
                )  # fmt: skip
            except TimeoutError:
                patience = 0.0  # only the acknowledgement may have been lost
            msg = await reader.next(deadline_after(self._loop, patience))
            if msg is not None:
                return msg
        raise TimeoutError(f"no {type} of system {target[0]} after {1 + retries} attempts")

    async def set_message_interval(
        self, type: str, hz: float | None, *, sysid: int | None = None, compid: int | None = None,
        retries: int = RETRIES, timeout: float = TIMEOUT,
    ) -> Any:  # fmt: skip
        """Ask for messages of `type` at a rate; 0 is none at all, None the vehicle's own rate.

        Raises as `command` does; ValueError for a type that the dialect does not have, or no rate.
        """
        if hz is not None and not 0 <= hz < math.inf:
            raise ValueError(f"a rate is a number of messages a second, which {hz} is not")
        if hz is None:
            interval = 0.0
        else:
            interval = 1e6 / hz if hz > 0 else -1.0
        return await self.command(
            MAV_CMD_SET_MESSAGE_INTERVAL, message_id(type), interval,
            sysid=sysid, compid=compid, retries=retries, timeout=timeout,
        )  # fmt: skip

    async def read_file(
        self, path: str, *, sysid: int | None = None, compid: int | None = None,
        limit: int = component_metadata.MAX_BYTES, timeout: float = FILE_TIMEOUT,
    ) -> bytes:  # fmt: skip
        """The content of a file of the vehicle, read over MAVFTP.

        OSError for one that cannot be read or has more than `limit` bytes; TimeoutError if nothing comes for
        `timeout` seconds.
        """
        return await read_file(self, path, self._target(sysid, compid), limit, timeout)

    async def component_metadata(
        self, kind: Kind, *, sysid: int | None = None, compid: int | None = None
    ) -> bytes:
        """A metadata file of the vehicle, which may be compressed: `mavwire.events` reads those of events.

        LookupError if the vehicle offers none of this kind. Raises as `request_message` and `read_file` do.
        """
        answer = await self.request_message("COMPONENT_METADATA", sysid=sysid, compid=compid)
        path = component_metadata.path_of(answer.uri)
        general = await self.read_file(path, sysid=sysid, compid=compid)
        if kind == Kind.GENERAL:
            return general
        path = component_metadata.path_of(component_metadata.uri_of(general, kind))
        return await self.read_file(path, sysid=sysid, compid=compid)

    def _target(self, sysid: int | None, compid: int | None) -> tuple[int, int]:
        """Whom to address. NoVehicleError if nobody was named or heard."""
        if sysid is None:
            sysid = self.sync.target_system
        if not sysid:
            raise NoVehicleError(
                "no vehicle was heard yet: await link.wait_heartbeat(), or name a sysid"
            )
        return sysid, self.sync.target_component if compid is None else compid

    def _acknowledges(self, command: int, sysid: int, compid: int) -> Wants:
        """Whether a message is the target's COMMAND_ACK to us. Vehicles that do not say whom they
        answer have 0 there."""
        us = self.sync.mav.srcSystem, self.sync.mav.srcComponent

        def wants(msg: Any) -> bool:
            return (
                msg.get_type() == "COMMAND_ACK"
                and msg.command == command
                and msg.get_srcSystem() == sysid
                and compid in (0, msg.get_srcComponent())
                and getattr(msg, "target_system", 0) in (0, us[0])
                and getattr(msg, "target_component", 0) in (0, us[1])
            )

        return wants


def message_id(type: str) -> int:
    """The id of a message of the current dialect. ValueError if it has none of that name."""
    if not isinstance(type, str):
        raise TypeError(f"a message is named by its type, such as 'ATTITUDE', not by {type!r}")
    number: int | None = getattr(state.mavlink, f"MAVLINK_MSG_ID_{type}", None)
    if number is None:
        raise ValueError(f"the dialect {state.current_dialect} has no message {type}")
    return number


def _accepted(command: int, ack: Any) -> Any:
    if ack.result != MAV_RESULT_ACCEPTED:
        raise CommandError(_entry("MAV_CMD", command), _entry("MAV_RESULT", ack.result), ack)
    return ack


def _entry(enum: str, value: int) -> str:
    """The name of an enum's entry, or its number."""
    entry = state.mavlink.enums.get(enum, {}).get(value)
    return f"{enum} {value}" if entry is None else str(entry.name)
