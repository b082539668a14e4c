"""Comparing what is received: the same bytes to mavwire and to its twin, then the answers."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from mavwire.shadow import _observe
from mavwire.shadow._mismatch import ShadowMismatch
from mavwire.shadow._observe import Raised
from mavwire.shadow._twin import Answers, Counterpart

MAX_SHOWN = 600


class CallbackWatch:
    """Sees messages before the user's receive callback does, which may change them or raise."""

    def __init__(self, mav: Any) -> None:
        self._mav = mav
        self._callback: Callable[..., object] | None = mav.callback
        self.seen: list[_observe.Seen] = []
        self.aborted = False

    @property
    def active(self) -> bool:
        """Whether there is a callback at all."""
        return self._callback is not None

    def __enter__(self) -> CallbackWatch:
        if self.active:
            self._mav.callback = self._call
        return self

    def __exit__(self, *_: object) -> None:
        # Unless it was replaced in the meantime.
        if self.active and self._mav.callback == self._call:
            self._mav.callback = self._callback

    def _call(self, msg: Any, *args: Any, **kwargs: Any) -> None:
        assert self._callback is not None
        self.seen.append(_observe.message(msg))
        try:
            self._callback(msg, *args, **kwargs)
        except BaseException:
            self.aborted = True
            raise


class Receiver:
    """The receiving half of a shadow."""

    def __init__(self, counterpart: Counterpart) -> None:
        self.lock = threading.RLock()
        self.busy = False
        self._counterpart = counterpart
        self._twin = counterpart.twin()
        self._stale = True
        self._fed = 0

    def skip(self) -> None:
        """Something is received without comparing; the twin's buffer goes out of date."""
        self._stale = True

    def compare(self, mav: Any, operation: str, data: Any, ours: Callable[[Any], Any]) -> Any:
        """`ours(data)`, after comparing it with what the twin says."""
        twin = self._twin
        stale = self._stale or twin.buf_len() != mav.buf_len()
        self._counterpart.synchronise(twin, mav, with_buffer=stale)
        self._stale = True
        start = None if operation == "decode" else self._fed - mav.buf_len()
        their_data = bytearray(data) if isinstance(data, bytearray) else data
        before = twin.total_bytes_received
        with Answers(mav) as answers, CallbackWatch(mav) as watch:
            result = self._ours(ours, data)
        answers.repeat(twin)
        theirs = _observe.outcome(lambda: getattr(twin, operation)(their_data))
        self._fed += twin.total_bytes_received - before
        if not watch.aborted:
            where = (operation, start, data)
            self._check(_seen(result, watch.seen), _seen(theirs, None), *where)
            if not watch.active and not answers.user_code_ran:
                state = _observe.receiving_state
                self._check(state(mav), state(twin), *where)
            self._stale = False
        if isinstance(result, Exception):
            raise result
        return result

    def _ours(self, ours: Callable[[Any], Any], data: Any) -> Any:
        """The result of `ours`, or its exception."""
        self.busy = True
        try:
            return ours(data)
        except Exception as error:
            return error
        finally:
            self.busy = False

    def _check(self, ours: Any, theirs: Any, operation: str, start: int | None, data: Any) -> None:
        if ours == theirs:
            return
        frame = bytes(data[:MAX_SHOWN]) if isinstance(data, bytes | bytearray) else b""
        if isinstance(ours, list) and isinstance(theirs, list):
            index = next(
                (i for i, pair in enumerate(zip(ours, theirs, strict=False)) if pair[0] != pair[1]),
                min(len(ours), len(theirs)),
            )
            if start is not None:
                start += sum(len(one.frame) for one in ours[:index])
            ours, theirs = (one[index] if index < len(one) else None for one in (ours, theirs))
        for one in (theirs, ours):
            frame = getattr(one, "frame", frame)
        part, our, their = _observe.first_difference(ours, theirs)
        raise ShadowMismatch(operation, part, our, their, start, frame)


def _seen(result: Any, messages: list[_observe.Seen] | None) -> Any:
    """An answer as comparable values; `messages` are those that a callback saw."""
    if isinstance(result, Exception):
        return _observe.raised(result)
    if result is None or isinstance(result, Raised):
        return result
    if isinstance(result, list):
        return messages or [_observe.message(msg) for msg in result]
    return messages[0] if messages else _observe.message(result)
