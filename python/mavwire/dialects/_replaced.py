"""Replacement of message classes and of `mavlink_map` entries in a dialect module.

Messages are made natively, without a lookup of either. So a replacement adds Python methods to the module's
`MAVLink` class. They are called like methods that a program puts there itself: by `MAVLink` objects that are made
afterwards.
"""

from __future__ import annotations

from mavwire._hooks import IN_STANDARD_MODULE, ReplaceableModule
from mavwire.dialects import _methods

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, ClassVar

    from mavwire import _native

# Attributes of a decoded message other than its fields.
_DECODED = ("_msgbuf", "_payload", "_crc", "_header", "_signed", "_link_id")


class MessageMap(dict[int, "type[Any]"]):
    """Message id -> message class. Parsers that are made after a change use the new class."""

    def __init__(self, namespace: dict[str, Any], native: _native.Dialect) -> None:
        super().__init__({msgid: native.message_class(name) for name, msgid in native.messages()})
        self._originals = dict(self)
        self._namespace = namespace

    def _changed(self) -> None:
        decode_by_map(self._namespace, self._originals)

    def __setitem__(self, msgid: int, cls: type[Any]) -> None:
        if msgid not in self._originals:
            raise KeyError(
                f"message id {msgid} is not in this dialect: add the message to its XML, "
                "and load that with mavwire.dialects.load()"
            )
        super().__setitem__(msgid, cls)
        self._changed()

    def setdefault(self, msgid: int, cls: Any = None) -> Any:
        """As dict.setdefault."""
        if msgid not in self:
            self[msgid] = cls
        return self[msgid]

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy is an ordinary dictionary: changes to it have no effect on parsers."""
        return dict, (dict(self),)

    def __delitem__(self, msgid: int) -> None:
        super().__delitem__(msgid)
        self._changed()

    def pop(self, *args: Any) -> Any:
        """As dict.pop."""
        cls = super().pop(*args)
        self._changed()
        return cls

    def popitem(self) -> Any:
        """As dict.popitem."""
        item = super().popitem()
        self._changed()
        return item

    def clear(self) -> None:
        """As dict.clear."""
        super().clear()
        self._changed()

    def update(self, *args: Any, **kwargs: Any) -> None:
        """As dict.update."""
        for msgid, cls in dict(*args, **kwargs).items():
            self[msgid] = cls

    def __ior__(self, other: Any) -> MessageMap:  # type: ignore[override,misc]
        self.update(other)
        return self


def decode_by_map(namespace: dict[str, Any], originals: dict[int, type[Any]]) -> None:
    """Make the module's `MAVLink` use the classes of a changed `mavlink_map`, or the native ones once they are back."""
    base = _base(namespace)
    if namespace["mavlink_map"] == originals:
        if hasattr(vars(base).get("decode"), "by_map"):
            del base.decode
        return
    if "decode" in vars(base):
        return
    native_decode = base.decode

    def decode(self: Any, msgbuf: bytearray) -> Any:
        """Decode a frame into a message of its class in `mavlink_map`."""
        message = native_decode(self, msgbuf)
        msgid = message.get_msgId()
        if msgid < 0:
            return message
        cls = namespace["mavlink_map"].get(msgid)
        if cls is originals.get(msgid):
            return message
        return (
            namespace["MAVLink_unknown"](msgid, msgbuf) if cls is None else _as_class(cls, message)
        )

    decode.by_map = True  # type: ignore[attr-defined]
    base.decode = decode


def _as_class(cls: Callable[..., Any], message: Any) -> Any:
    """A message of the program's class with the fields, header and frame of `message`."""
    names = ((f"_{name}_raw", name) for name in message.fieldnames)
    made = cls(*(getattr(message, raw if hasattr(message, raw) else name) for raw, name in names))
    for name in _DECODED:
        setattr(made, name, getattr(message, name))
    return made


def _base(namespace: dict[str, Any]) -> Any:
    return namespace["MAVLink"]._mavlink_base


class DialectModule(ReplaceableModule):
    """A dialect module. Programs may replace its classes and `mavlink_map`."""

    _not_called: ClassVar[dict[str, str]] = {
        **dict.fromkeys("hashlib json logging os struct sys time".split(), IN_STANDARD_MODULE),
        **dict.fromkeys(("mcrf4xx", "x25crc"), "checksums are computed natively"),
        "MAVLink_header": "headers are made natively: change the header of each message instead",
    }
    _dialect: _native.Dialect

    def _use(self, name: str, before: Any, value: Any, is_original: bool) -> None:
        if name == "mavlink_map":
            decode_by_map(vars(self), self._originals[name]._originals)
        elif (message := _message_of(name)) is not None:
            self._use_class(message, value, is_original)

    def _use_class(self, message: str, cls: Any, is_original: bool) -> None:
        """Make `<message>_encode` and `_send` use the program's message class."""
        base, lower = _base(vars(self)), message.lower()
        if is_original:
            for suffix, make in (("encode", _methods.make_encode), ("send", _methods.make_send)):
                method = _methods.LazyFunction(message, make)
                method.__set_name__(base, suffix)
                setattr(base, f"{lower}_{suffix}", method)
            return

        message_class = base._dialect.message_class(message)
        setattr(base, f"{lower}_encode", _methods.make_encode(base, message_class, cls))
        setattr(
            base, f"{lower}_send", _methods.make_send(base, message_class, _methods.encode_and_send)
        )


def _message_of(name: str) -> str | None:
    if not (name.startswith("MAVLink_") and name.endswith("_message")) or name == "MAVLink_message":
        return None
    return name.removeprefix("MAVLink_").removesuffix("_message").upper()
