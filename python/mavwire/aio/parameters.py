"""Parameters of a vehicle: read one, set one, read them all."""

from __future__ import annotations

import math
from typing import Any

from mavwire.links.modes import MAV_AUTOPILOT_PX4
from mavwire.links.param_bytes import decoded, encoded, with_value_bytes

from .deadline import deadline_after, is_over
from .errors import ParameterError
from .vehicle import RETRIES, TIMEOUT, Vehicle

# Parameters that are asked for again at a time, when some of the list did not arrive.
REQUESTS_AT_ONCE = 20


def _is_same(kept: float, value: float, bytewise: bool) -> bool:
    """Whether a vehicle has the value that it was sent; a float of four bytes is not as exact."""
    if bytewise and isinstance(kept, int):
        return kept == value
    return math.isclose(kept, value, rel_tol=1e-6, abs_tol=1e-9)


class Parameters(Vehicle):
    """The part of a link that reads and sets parameters."""

    async def param_get(
        self, name: str, *, sysid: int | None = None, compid: int | None = None,
        retries: int = RETRIES, timeout: float = TIMEOUT,
    ) -> float:  # fmt: skip
        """The value of a parameter, an `int` for an integer. TimeoutError if there is no answer, which
        is what vehicles say about parameters that they do not have."""
        target = self._target(sysid, compid)
        return decoded(await self._read(name, target, retries, timeout), self._bytewise(target[0]))

    async def param_set(
        self, name: str, value: float, *, sysid: int | None = None, compid: int | None = None,
        retries: int = RETRIES, timeout: float = TIMEOUT,
    ) -> float:  # fmt: skip
        """Set a parameter and return what the vehicle has then.

        Its type is asked for first. A vehicle may tell the old value meanwhile, to somebody else or
        belatedly: ParameterError if no attempt made it tell the new one. ValueError for a value that
        the type cannot hold, TimeoutError if there is no answer.
        """
        target = self._target(sysid, compid)
        bytewise = self._bytewise(target[0])
        kind = (await self._read(name, target, retries, timeout)).param_type
        data = encoded(value, kind, bytewise)
        reader = self._feed.reader(_is_value(name, target))
        kept = None
        for _ in range(1 + retries):
            self._send_value(name, data, kind, target)
            deadline = deadline_after(self._loop, timeout)
            while (msg := await reader.next(deadline)) is not None:
                kept = decoded(msg, bytewise)
                if _is_same(kept, value, bytewise):
                    return kept
                if is_over(self._loop, deadline):
                    break
        if kept is not None:
            raise ParameterError(name, value, kept)
        raise TimeoutError(f"no answer to setting {name} after {1 + retries} attempts")

    def _send_value(self, name: str, data: bytes, kind: int, target: tuple[int, int]) -> None:
        mav = self.sync.mav
        msg = mav.param_set_encode(*target, name.encode(), 0.0, kind)
        mav.send(with_value_bytes(msg, data, type(mav)))

    async def param_fetch_all(
        self, *, sysid: int | None = None, compid: int | None = None,
        retries: int = RETRIES, timeout: float = TIMEOUT,
    ) -> dict[str, float]:  # fmt: skip
        """All parameters by name. Parameters that do not arrive are asked for again, one by one; TimeoutError if
        nothing comes `retries` times in a row."""
        target = self._target(sysid, compid)
        bytewise = self._bytewise(target[0])
        reader = self._feed.reader(_is_value(None, target))
        found: dict[int, Any] = {}
        count: int | None = None
        silences = 0
        self.sync.mav.param_request_list_send(*target)
        deadline = deadline_after(self._loop, timeout)
        while count is None or len(found) < count:
            msg = await reader.next(deadline)
            if msg is not None:
                count = msg.param_count
                # An answer to somebody who asked by name may have no index, and one that is known
                # brings nothing new: it does not put off asking again.
                if msg.param_index < count and msg.param_index not in found:
                    silences = 0
                    deadline = deadline_after(self._loop, timeout)
                if msg.param_index < count:
                    found[msg.param_index] = msg
                if not is_over(self._loop, deadline):
                    continue
            silences += 1
            if silences > retries:
                raise TimeoutError(f"{len(found)} of {count or 'unknown'} parameters received")
            self._ask_again(target, count, found)
            deadline = deadline_after(self._loop, timeout)
        return {str(msg.param_id): decoded(msg, bytewise) for _, msg in sorted(found.items())}

    def _ask_again(self, target: tuple[int, int], count: int | None, found: dict[int, Any]) -> None:
        if count is None:
            self.sync.mav.param_request_list_send(*target)
            return
        missing = [index for index in range(count) if index not in found]
        for index in missing[:REQUESTS_AT_ONCE]:
            self.sync.mav.param_request_read_send(*target, b"", index)

    async def _read(self, name: str, target: tuple[int, int], retries: int, timeout: float) -> Any:
        """The PARAM_VALUE of a parameter."""
        reader = self._feed.reader(_is_value(name, target))
        for _ in range(1 + retries):
            self.sync.mav.param_request_read_send(*target, name.encode(), -1)
            msg = await reader.next(deadline_after(self._loop, timeout))
            if msg is not None:
                return msg
        raise TimeoutError(
            f"no parameter {name} from system {target[0]} after {1 + retries} attempts"
        )

    def _bytewise(self, sysid: int) -> bool:
        system = self.sync.sysid_state.get(sysid)
        return system is not None and system.mav_autopilot == MAV_AUTOPILOT_PX4


def _is_value(name: str | None, target: tuple[int, int]) -> Any:
    """Whether a message is the target's PARAM_VALUE, of one parameter if it is named."""
    sysid, compid = target

    def wants(msg: Any) -> bool:
        return (
            msg.get_type() == "PARAM_VALUE"
            and msg.get_srcSystem() == sysid
            and compid in (0, msg.get_srcComponent())
            and (name is None or msg.param_id == name)
        )

    return wants
