"""The `MAVLink` class of a dialect module in shadow mode.

It takes the module's own class as base and replaces it, also for the native core: parsing
and sending go the very ways they go without a shadow. Comparing stops where a program replaces the
methods it is about, since then it is the program that answers.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from mavwire import _native
from mavwire.shadow import _reference
from mavwire.shadow._mismatch import warn_no_counterpart
from mavwire.shadow._receive import Receiver
from mavwire.shadow._send import Sender, Tap
from mavwire.shadow._twin import Counterpart

RECEIVING = ("parse_char", "parse_buffer", "decode", "check_signature")


class Shadow:
    """The twins of one link: one to receive and one to send."""

    def __init__(self, counterpart: Counterpart, namespace: dict[str, Any]) -> None:
        self.counterpart = counterpart
        self.receiver = Receiver(counterpart)
        self.sender = Sender(counterpart, namespace)


def _replaced(mav: Any, shadowed: type, names: tuple[str, ...]) -> bool:
    """Whether a subclass or the instance has its own version of one of the methods."""
    own = vars(mav)
    return any(
        name in own or getattr(type(mav), name) is not getattr(shadowed, name) for name in names
    )


class _Comparing:
    """The methods that a shadow adds to a `MAVLink` class. They compare calls where possible."""

    _shadow: Shadow | None = None
    # The class itself, to see what a subclass or an instance replaces.
    _shadowed: type
    _tap: Any

    def _receive(self, operation: str, data: Any, ours: Callable[[Any], Any]) -> Any:
        shadow = self._shadow
        if shadow is None:
            return ours(data)
        receiver = shadow.receiver
        with receiver.lock:
            if receiver.busy:  # called by another of these, or by a callback of it
                return ours(data)
            # A replaced `decode` decides about streams; what it asks of this one is compared.
            replaced = operation != "decode" and _replaced(self, self._shadowed, RECEIVING)
            # Errors for arguments of the wrong type differ on purpose.
            odd = operation == "decode" and not isinstance(data, bytearray)
            if replaced or odd or self.resync != "skip":  # type: ignore[attr-defined]
                receiver.skip()
                return ours(data)
            if hasattr(data, "__next__"):
                data = list(data)  # to be read twice
            return receiver.compare(self, operation, data, ours)

    def _send_message(self, msg: Any, force_mavlink1: Any, ours: Callable[..., None]) -> None:
        info = getattr(msg, "_info", None)
        known = isinstance(msg, _native.Message) and info is not None
        if not known or type(msg).pack is not _native.Message.pack:
            ours(msg, force_mavlink1)
            return
        shadow = self._shadow
        their_msg = shadow.counterpart.message(msg) if shadow is not None else None
        if their_msg is None:
            ours(msg, force_mavlink1)
            return
        self._compare_sending(
            "send",
            info,
            force_mavlink1,
            lambda: ours(msg, force_mavlink1),
            lambda twin: twin.send(their_msg, force_mavlink1),
        )

    def _compare_sending(
        self,
        operation: str,
        info: Any,
        force_mavlink1: Any,
        ours: Callable[[], None],
        theirs: Callable[[Any], Any],
    ) -> None:
        shadow, tap = self._shadow, self._tap
        if shadow is None or not isinstance(tap, Tap):
            ours()
            return
        sender = shadow.sender
        with sender.lock:
            if sender.busy or not sender.comparable(self, info, force_mavlink1):
                ours()
            else:
                sender.compare(self, tap, operation, ours, theirs)


def shadow_class(base: Any, namespace: dict[str, Any]) -> type:
    """`base`, the `MAVLink` of the module with these globals, with a shadow."""
    find = _counterpart_finder(namespace)

    class MAVLink(base, _Comparing):
        __doc__ = base.__doc__
        _tap = base.file

        def __init__(
            self, file: Any, srcSystem: int = 0, srcComponent: int = 0, use_native: bool = False
        ) -> None:
            super().__init__(file, srcSystem, srcComponent, use_native)
            counterpart = find()
            if counterpart is not None:
                self._shadow = Shadow(counterpart, namespace)

        @property
        def file(self) -> Any:
            return self._tap.target if isinstance(self._tap, Tap) else self._tap

        @file.setter
        def file(self, value: Any) -> None:
            self._tap = Tap(value)

        def parse_char(self, c: Any) -> Any:
            return self._receive("parse_char", c, super().parse_char)

        def parse_buffer(self, s: Any) -> Any:
            return self._receive("parse_buffer", s, super().parse_buffer)

        def decode(self, msgbuf: Any) -> Any:
            return self._receive("decode", msgbuf, super().decode)

        def send(self, mavmsg: Any, force_mavlink1: bool = False) -> None:
            self._send_message(mavmsg, force_mavlink1, super().send)

    MAVLink.__module__, MAVLink.__qualname__ = base.__module__, base.__qualname__
    # For the native core this is the module's class, not a subclass that replaces methods.
    MAVLink._mavlink_base = MAVLink
    MAVLink._shadowed = MAVLink
    for message, _ in base._dialect.messages():
        name = f"{message.lower()}_send"
        setattr(MAVLink, name, _ShadowSend(MAVLink, base, name, message))
    return MAVLink


def _counterpart_finder(namespace: dict[str, Any]) -> Callable[[], Counterpart | None]:
    """Finds pymavlink's module when the first link is made: importing it takes a while."""

    @functools.cache
    def find() -> Counterpart | None:
        module = _reference.counterpart(namespace["__name__"])
        if module is None:
            warn_no_counterpart(namespace["__name__"])
            return None
        return Counterpart(module, namespace)

    return find


class _ShadowSend:
    """`<message>_send` before its first use; replaces itself by the comparing function."""

    def __init__(self, owner: Any, base: Any, name: str, message: str) -> None:
        self._owner, self._base, self._name, self._message = owner, base, name, message

    def __get__(self, obj: Any, cls: type) -> Any:
        function = self._make()
        setattr(self._owner, self._name, function)
        return function.__get__(obj, cls)

    def _make(self) -> Callable[..., None]:
        owner, name = self._owner, self._name
        original = getattr(self._base, name)
        info = self._base._dialect.message_class(self._message)._info
        fields = len(info.fieldnames)
        replaceable = ("send", f"{self._message.lower()}_encode")

        @functools.wraps(original)
        def send(self: Any, *args: Any, **kwargs: Any) -> None:
            if _replaced(self, owner, replaceable):
                original(self, *args, **kwargs)
                return
            force = kwargs.get("force_mavlink1", args[fields] if len(args) > fields else False)
            self._compare_sending(
                name,
                info,
                force,
                lambda: original(self, *args, **kwargs),
                lambda twin: getattr(twin, name)(*args, **kwargs),
            )

        return send
