"""Fills a module's namespace with a dialect.

Constants are there from the start (2,500 of them take microseconds); message classes, ``enums``, ``mavlink_map`` and the
standard modules that pymavlink's generated code leaks come on first access through the module's ``__getattr__``.
"""

from __future__ import annotations

import os
import sys

from mavwire import _native
from mavwire._hooks import make_replaceable
from mavwire.dialects import _classes, _replaced, _x25
from mavwire.dialects._descriptions import Texts

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

FIXED = {
    "PROTOCOL_MARKER_V1": 0xFE,
    "PROTOCOL_MARKER_V2": 0xFD,
    "HEADER_LEN_V1": 6,
    "HEADER_LEN_V2": 10,
    "MAVLINK_SIGNATURE_BLOCK_LEN": 13,
    "MAVLINK_IFLAG_SIGNED": 1,
    **{f"MAVLINK_TYPE_{kind.upper()}": n for n, kind in enumerate(_native.FIELD_TYPES)},
    "MAVLINK_MSG_ID_BAD_DATA": -1,
    "MAVLINK_MSG_ID_UNKNOWN": -2,
    "_x25crc_fast": _x25._x25crc_fast,
    "_x25crc_slow": _x25._x25crc_slow,
    "x25crc": _x25.x25crc,
    "mcrf4xx": _x25.mcrf4xx,
}

LEAKED_MODULES = ("hashlib", "json", "logging", "os", "struct", "sys", "time")
LEAKED_TYPING = (
    "Any",
    "Callable",
    "Dict",
    "Iterable",
    "List",
    "Mapping",
    "Optional",
    "Sequence",
    "Tuple",
    "Type",
    "Union",
)
# A message class is called so before and behind the name of the message in lower case.
BEFORE, BEHIND = "MAVLink_", "_message"
ALIASES = ("BytesLike", "MAVLinkV1Header", "MAVLinkV2Header")


def fill(namespace: dict[str, Any], native: _native.Dialect, name: str) -> None:
    """Makes ``namespace`` (a module's globals) the dialect ``native``; ``name`` is its ``DIALECT``."""
    texts = Texts(native.name)
    namespace.update(FIXED)
    namespace["WIRE_PROTOCOL_VERSION"] = native.wire_protocol
    namespace["DIALECT"] = name
    namespace["MAVLINK_IGNORE_CRC"] = os.environ.get("MAV_IGNORE_CRC", 0)
    native.add_constants(namespace)
    classes = _classes.make_classes(namespace, native, texts)
    make_class = classes.pop("_make")
    namespace.update(classes)
    if os.environ.get("MAVWIRE_SHADOW"):
        from mavwire import shadow

        shadow.attach(namespace)
    native.bind(namespace, make_class)
    late = _late_attributes(namespace, native, texts)

    def __getattr__(attribute: str) -> Any:
        value: Any = _message_class(native, attribute)
        if value is None:
            if attribute not in late:
                module = namespace["__name__"]
                raise AttributeError(f"module {module!r} has no attribute {attribute!r}")
            value = late[attribute]()
        namespace[attribute] = value
        return value

    def __dir__() -> list[str]:
        messages = (f"{BEFORE}{message.lower()}{BEHIND}" for message, _ in native.messages())
        return sorted({*namespace, *messages, *late})

    module = sys.modules.get(namespace["__name__"])
    if module is not None and vars(module) is namespace:
        make_replaceable(module, _replaced.DialectModule)
    namespace["__getattr__"] = __getattr__
    namespace["__dir__"] = __dir__
    late["__all__"] = lambda: [n for n in __dir__() if not n.startswith("_")]


def _message_class(native: _native.Dialect, attribute: str) -> type | None:
    """The class that is called so, if it is one of a message."""
    message = attribute[len(BEFORE) : -len(BEHIND)]
    if attribute != f"{BEFORE}{message.lower()}{BEHIND}":
        return None
    try:
        return native.message_class(message.upper())
    except KeyError:
        return None


def _late_attributes(
    namespace: dict[str, Any], native: _native.Dialect, texts: Texts
) -> dict[str, Callable[[], Any]]:
    def module(name: str, member: str | None = None) -> Callable[[], Any]:
        def load() -> Any:
            import importlib

            loaded = importlib.import_module(name)
            return loaded if member is None else getattr(loaded, member)

        return load

    def enums() -> Any:
        from mavwire.dialects._enums import make_enums

        return make_enums(native.enums(), texts)

    def logger() -> Any:
        import logging

        return logging.getLogger(namespace["__name__"])

    late: dict[str, Callable[[], Any]] = {name: module(name) for name in LEAKED_MODULES}
    late |= {name: module("typing", name) for name in LEAKED_TYPING}
    late |= {name: module("mavwire.dialects._enums", name) for name in ("Enum", "EnumEntry")}
    late |= {"enums": enums, "logger": logger}
    late["mavlink_map"] = lambda: _replaced.MessageMap(namespace, native)
    late |= {alias: _type_alias(alias) for alias in ALIASES}
    return late


def _type_alias(name: str) -> Callable[[], Any]:
    def load() -> Any:
        from typing import Union

        if name == "BytesLike":
            return Union[list[int], tuple[int, ...], bytes, bytearray, str]  # noqa: UP007
        count = 6 if name == "MAVLinkV1Header" else 9
        return tuple[(bytes, *[int] * (count - 1))]  # type: ignore[misc]

    return load
