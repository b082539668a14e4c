"""Comparing what is sent: the twin packs first, and a frame that differs does not go out."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from mavwire.shadow import _observe
from mavwire.shadow._mismatch import ShadowMismatch
from mavwire.shadow._observe import Raised
from mavwire.shadow._twin import IFLAG_SIGNED, SIGNATURE_LEN, Counterpart


class Tap:
    """A filter between a `MAVLink` and its file, which looks at the frames that pass."""

    def __init__(self, target: Any) -> None:
        self.target = target
        self.expected: Expected | None = None

    def write(self, frame: bytes) -> Any:
        """Writes the frame if it is the one expected."""
        if self.expected is not None:
            self.expected.meet(frame)
        return self.target.write(frame)


class Expected:
    """The frame of the twin. `again(timestamp)` makes it with another signing timestamp."""

    def __init__(
        self,
        counterpart: Counterpart,
        operation: str,
        theirs: Any,
        timestamp: int,
        again: Callable[[int], Any],
    ) -> None:
        self._counterpart = counterpart
        self._operation = operation
        self._theirs = theirs
        self._timestamp = timestamp
        self._again = again
        self.met = False

    def meet(self, ours: Any) -> None:
        """Compares a frame or an exception, once; what follows on a call comes from user code."""
        if self.met:
            return
        self.met = True
        if ours == self._theirs:
            return
        self._timestamp_moved(ours)
        theirs = self._theirs
        if ours == theirs:
            return
        frames = isinstance(ours, bytes) and isinstance(theirs, bytes)
        if frames and self._counterpart.equal_but_for_nan(ours, theirs):
            return
        frame = next((one for one in (theirs, ours) if isinstance(one, bytes)), b"")
        raise ShadowMismatch(self._operation, "frame", ours, theirs, None, frame)

    def _timestamp_moved(self, ours: Any) -> None:
        """Lets the twin follow where another thread has received, and so moved, the timestamp."""
        signed = isinstance(ours, bytes) and len(ours) > SIGNATURE_LEN and ours[2] & IFLAG_SIGNED
        if not signed:
            return
        timestamp = int.from_bytes(ours[-SIGNATURE_LEN + 1 : -6], "little")
        if timestamp > self._timestamp:
            self._theirs = self._again(timestamp)


class Frames(list[bytes]):
    """The file of a sending twin."""

    write = list.append


class Sender:
    """The sending half of a shadow."""

    def __init__(self, counterpart: Counterpart, namespace: dict[str, Any]) -> None:
        self.lock = threading.RLock()
        self.busy = False
        self._counterpart = counterpart
        self._twin = counterpart.twin()
        self._namespace = namespace

    def comparable(self, mav: Any, info: Any, force_mavlink1: Any) -> bool:
        """Whether both packages mean to send the same, which in MAVLink 1 they do not always.

        pymavlink appends extension fields and signatures there, which MAVLink 1 does not have.
        """
        is_v2 = float(self._namespace["WIRE_PROTOCOL_VERSION"]) == 2 and not force_mavlink1
        plain = info.min_len == info.max_len and not mav.signing.sign_outgoing
        return is_v2 or plain

    def compare(
        self,
        mav: Any,
        tap: Tap,
        operation: str,
        ours: Callable[[], Any],
        theirs: Callable[[Any], Any],
    ) -> None:
        """`ours()`, the frame of which has to be what `theirs(twin)` writes."""
        twin = self._twin

        def sent_at(timestamp: int) -> Any:
            """The frame that the twin sends, or what it raises."""
            self._counterpart.synchronise(twin, mav, with_buffer=False)
            twin.signing.timestamp = timestamp
            twin.file = frames = Frames()
            result = _observe.outcome(lambda: theirs(twin))
            return result if isinstance(result, Raised) else b"".join(frames)

        now = mav.signing.timestamp
        expected = Expected(self._counterpart, operation, sent_at(now), now, sent_at)
        tap.expected, self.busy = expected, True
        try:
            ours()
        except ShadowMismatch:
            raise
        except Exception as error:
            # After the frame was met it is the file or a callback that failed.
            expected.meet(_observe.raised(error))
            raise
        finally:
            tap.expected, self.busy = None, False
        expected.meet(b"")
        names = _observe.SENDING
        states = [{name: getattr(one, name) for name in names} for one in (mav, twin)]
        if mav.send_callback is None and states[0] != states[1]:
            raise ShadowMismatch(operation, *_observe.first_difference(*states), None, b"")
