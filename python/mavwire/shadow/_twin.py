"""pymavlink's `MAVLink` beside one of mavwire's: brought to the same state, then asked the same.

The twin is pymavlink's class with two deliberate differences applied to it (docs/compatibility.md),
so that links with a signing key compare exactly: a signature that is wrong leaves no trace, and
messages of unknown ids are under the same policy as all others.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

from mavwire.shadow import _observe

COPIED = (*_observe.SENDING, *_observe.RECEIVING, "robust_parsing", "srcSystem", "srcComponent")
COPIED_SIGNING = (*_observe.SIGNING, "timestamp", "secret_key", "link_id", "sign_outgoing")
GLOBALS = ("WIRE_PROTOCOL_VERSION", "MAVLINK_IGNORE_CRC")
STX_V1 = 0xFE
IFLAG_SIGNED = 1
SIGNATURE_LEN = 13


def twin_class(module: ModuleType) -> type:
    """The twins' class around `module.MAVLink`."""
    base: Any = module.MAVLink

    class Twin(base):
        def check_signature(self, msgbuf: Any, srcSystem: int, srcComponent: int) -> bool:
            signing = self.signing
            before = signing.timestamp, dict(signing.stream_timestamps)
            good = bool(super().check_signature(msgbuf, srcSystem, srcComponent))
            if not good:
                signing.timestamp, signing.stream_timestamps = before
            return good

        def decode(self, msgbuf: Any) -> Any:
            msg = super().decode(msgbuf)
            unknown = isinstance(msg, module.MAVLink_unknown)
            if unknown and self.signing.secret_key is not None:
                self._pass_unknown(msg, msgbuf)
            return msg

        def _pass_unknown(self, msg: Any, msgbuf: bytearray) -> None:
            signing = self.signing
            v1 = msgbuf[0] == STX_V1
            if not v1 and msgbuf[2] & IFLAG_SIGNED:
                signing.sig_count += 1
                if self.check_signature(msgbuf, msgbuf[5], msgbuf[6]):
                    signing.goodsig_count += 1
                    msg._signed, msg._link_id = True, msgbuf[-SIGNATURE_LEN]
                    return
                signing.badsig_count += 1
            msgid = msgbuf[5] if v1 else int.from_bytes(msgbuf[7:10], "little")
            if signing.allow_unsigned_callback is not None:
                if signing.allow_unsigned_callback(self, msgid):
                    signing.unsigned_count += 1
                    return
                signing.reject_count += 1
            raise module.MAVError("Invalid signature")

    return Twin


class Counterpart:
    """The common parts of the twins of one dialect module."""

    def __init__(self, module: ModuleType, namespace: dict[str, Any]) -> None:
        self.module = module
        self._namespace = namespace
        self._make = twin_class(module)
        # Reads frames without a key, to look into what is sent.
        self.reader: Any = module.MAVLink(None)

    def twin(self) -> Any:
        """A new twin."""
        return self._make(None)

    def synchronise(self, twin: Any, mav: Any, with_buffer: bool) -> None:
        """Brings `twin` to the state that `mav` is in."""
        for name in GLOBALS:
            setattr(self.module, name, self._namespace[name])
        for name in COPIED:
            setattr(twin, name, getattr(mav, name))
        for name in COPIED_SIGNING:
            setattr(twin.signing, name, getattr(mav.signing, name))
        if with_buffer:
            twin.buf, twin.buf_index = bytearray(mav.buf), 0

    def message(self, msg: Any) -> Any:
        """pymavlink's message object with the attributes of `msg`, None if it has no such message."""
        import copy

        info = msg._info
        made_by: Any = getattr(self.module, f"MAVLink_{info.name.lower()}_message", None)
        if made_by is None or (made_by.crc_extra, made_by.fieldnames) != (
            info.crc_extra,
            info.fieldnames,
        ):
            return None
        theirs = made_by.__new__(made_by)
        # Of a copy, because showing all attributes changes how a message is stored.
        theirs.__dict__.update(vars(copy.copy(msg)))
        theirs._header = self.module.MAVLink_header(info.id)
        return theirs

    def equal_but_for_nan(self, ours: bytes, theirs: bytes) -> bool:
        """Whether two frames differ only in the bits of NaNs, which pymavlink does not keep."""
        if len(ours) != len(theirs):
            return False
        our, their = (self._read(frame) for frame in (ours, theirs))
        if not (isinstance(our, _observe.Seen) and isinstance(their, _observe.Seen)):
            return False
        same = (our.fields, our.header) == (their.fields, their.header)
        return same and "nan" in our.fields

    def _read(self, frame: bytes) -> Any:
        return _observe.outcome(lambda: _observe.message(self.reader.decode(bytearray(frame))))


class Answers:
    """The answers of `allow_unsigned_callback` in mavwire's run, which are repeated in the twin's."""

    def __init__(self, mav: Any) -> None:
        self._signing = mav.signing
        self._asked: Callable[[Any, int], Any] | None = mav.signing.allow_unsigned_callback
        self._given: list[tuple[int, bool | Exception]] = []

    def __enter__(self) -> Answers:
        if self._asked is not None:
            self._signing.allow_unsigned_callback = self._ask
        return self

    def __exit__(self, *_: object) -> None:
        # Unless it was replaced in the meantime.
        if self._signing.allow_unsigned_callback == self._ask:
            self._signing.allow_unsigned_callback = self._asked

    def _ask(self, mav: Any, msgid: int) -> bool:
        assert self._asked is not None
        self._given.append((msgid, False))
        try:
            answer = bool(self._asked(mav, msgid))
        except Exception as error:
            self._given[-1] = (msgid, error)
            raise
        self._given[-1] = (msgid, answer)
        return answer

    @property
    def user_code_ran(self) -> bool:
        """Whether the callback was asked, which may have changed anything."""
        return bool(self._given)

    def repeat(self, twin: Any) -> None:
        """Lets the twin have the same answers, in the same order."""
        given = iter(self._given)

        def answer(_mav: Any, msgid: int) -> bool:
            asked, said = next(given, (None, False))
            if isinstance(said, Exception):
                raise said
            return (asked, said) == (msgid, True)

        twin.signing.allow_unsigned_callback = None if self._asked is None else answer
