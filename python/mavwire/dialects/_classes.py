"""The classes of a dialect module.

pymavlink's modules are self-contained: each has its own ``MAVLink_message``, ``MAVError``, ``MAVLink`` and so on, so that
messages of two modules never compare equal and catching one module's ``MAVError`` does not catch another's. So the
classes are made here once per module, around the native ones.

Annotations are evaluated in this file: ``inspect`` and ``typing.get_type_hints`` find types, as in pymavlink. Annotations
that only a type checker needs are quoted, since ``typing`` is not imported.
"""

import struct
import time
from _operator import attrgetter
from types import FunctionType

from mavwire import _native
from mavwire._hooks import warn_not_called
from mavwire.dialects import _docs, _methods
from mavwire.dialects._descriptions import Texts

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

# From a format of `struct` to one letter per field.
LETTERS = str.maketrans("s", "c", "0123456789")
HEX = [f"{byte:x}" for byte in range(256)]
# The type of a SETUP_SIGNING that the dialect lacks: its key is in no text either.
KEYED_UNKNOWN = "UNKNOWN_256"


def _header_class(namespace: "dict[str, Any]", marker: int) -> type:
    class MAVLink_header:
        """Header of a frame."""

        def __init__(
            self,
            msgId: int,
            incompat_flags: int = 0,
            compat_flags: int = 0,
            mlen: int = 0,
            seq: int = 0,
            srcSystem: int = 0,
            srcComponent: int = 0,
        ) -> None:
            self.mlen = mlen
            self.seq = seq
            self.srcSystem = srcSystem
            self.srcComponent = srcComponent
            self.msgId = msgId
            self.incompat_flags = incompat_flags
            self.compat_flags = compat_flags

        def pack(self, force_mavlink1: bool = False) -> bytes:
            """The header's bytes for the module's ``WIRE_PROTOCOL_VERSION``, or version 1 if forced."""
            if float(namespace["WIRE_PROTOCOL_VERSION"]) == 2.0 and not force_mavlink1:
                return struct.pack(
                    "<BBBBBBBHB",
                    marker,
                    self.mlen,
                    self.incompat_flags,
                    self.compat_flags,
                    self.seq,
                    self.srcSystem,
                    self.srcComponent,
                    self.msgId & 0xFFFF,
                    self.msgId >> 16,
                )
            return struct.pack(
                "<BBBBBB", 254, self.mlen, self.seq, self.srcSystem, self.srcComponent, self.msgId
            )

    return MAVLink_header


class SchemaAttr:
    """A class attribute of message classes that is worked out when first read, then kept on the class."""

    def __init__(
        self, name: str, default: "Any", read: "Callable[[_native.MessageInfo], Any]"
    ) -> None:
        self._name = name
        self._default = default
        self._read = read

    def __get__(self, obj: "Any", cls: type) -> "Any":
        owner = defining_class(cls)
        if owner is None:
            return self._default
        value = self._read(owner.__dict__["_info"])
        setattr(owner, self._name, value)
        return value


def defining_class(cls: type) -> type | None:
    """The message class that ``cls`` is or derives from."""
    for base in cls.__mro__:
        if base.__dict__.get("_info") is not None:
            return base
    return None


def _wire_rows(info: _native.MessageInfo) -> "list[tuple[Any, ...]]":
    """The rows that become constructor parameters, in wire order."""
    rows = {row[0]: row for row in info.parameters}
    return [rows[name] for name in info.ordered_fieldnames]


SCHEMA_ATTRS: "dict[str, tuple[Any, Callable[[_native.MessageInfo], Any]]]" = {
    "fieldnames": ([], attrgetter("fieldnames")),
    "ordered_fieldnames": ([], attrgetter("ordered_fieldnames")),
    "fieldtypes": ([], lambda info: [kind for _, kind, *_ in info.parameters]),
    "fielddisplays_by_name": ({}, attrgetter("fielddisplays_by_name")),
    "fieldenums_by_name": ({}, attrgetter("fieldenums_by_name")),
    "fieldunits_by_name": ({}, attrgetter("fieldunits_by_name")),
    "native_format": (
        bytearray(),
        lambda info: bytearray(info.unpacker_format.translate(LETTERS), "ascii"),
    ),
    "orders": ([], lambda info: [*map(info.ordered_fieldnames.index, info.fieldnames)]),
    "lengths": (
        [],
        lambda info: [1 if row[1] == "char" else row[2] or 1 for row in _wire_rows(info)],
    ),
    "array_lengths": ([], lambda info: [row[2] for row in _wire_rows(info)]),
    "unpacker": (struct.Struct(""), lambda info: struct.Struct(info.unpacker_format)),
    "instance_field": (None, lambda info: info.instance[0]),
    "instance_offset": (-1, lambda info: info.instance[1]),
}


def _message_base(native: _native.Dialect, header: type) -> type:
    class MAVLink_message(_native.Message):
        """Base class of all messages of this dialect."""

        fieldnames: list[str]
        ordered_fieldnames: list[str]
        fieldtypes: list[str]
        fielddisplays_by_name: dict[str, str]
        fieldenums_by_name: dict[str, str]
        fieldunits_by_name: dict[str, str]
        orders: list[int]
        lengths: list[int]
        array_lengths: list[int]
        instance_field: str | None
        id = 0
        msgname = ""
        crc_extra = 0
        _info = None
        _dialect = native
        _header_class = header
        __dict__ = property(_native.message_dict)

        def __init__(self, msgId: int, name: str) -> None:
            self._header = header(msgId)
            self._type = name

        def __init_subclass__(cls, **kwargs: object) -> None:
            super().__init_subclass__(**kwargs)
            for name in ("_pack", "sign_packet"):
                if name in vars(cls):
                    warn_not_called(f"{cls.__name__}.{name}", "replace pack, or MAVLink.send")

    MAVLink_message._message_base = MAVLink_message  # type: ignore[attr-defined]
    for name, (default, read) in SCHEMA_ATTRS.items():
        setattr(MAVLink_message, name, SchemaAttr(name, default, read))
    return MAVLink_message


def _odd_message_classes(base: "Any") -> tuple[type, type]:
    class MAVLink_bad_data(base):
        """Bytes that are no valid frame, with the reason."""

        fieldnames = ["data", "reason"]  # noqa: RUF012
        data = _native.MetaAttr("data")
        reason = _native.MetaAttr("reason")

        def __init__(self, data: bytes | bytearray, reason: str) -> None:
            base.__init__(self, -1, "BAD_DATA")
            self.data = data
            self.reason = reason
            self._msgbuf = bytearray(data)

        def __str__(self) -> str:
            return f"{self._type} {{{self.reason}, data:{[HEX[byte] for byte in self.data]}}}"

    class MAVLink_unknown(base):
        """A frame whose message id the dialect does not define; ``data`` is the whole frame."""

        fieldnames = ["data"]  # noqa: RUF012
        data = _native.MetaAttr("data")

        def __init__(self, msgid: int, data: bytes | bytearray) -> None:
            base.__init__(self, -2, f"UNKNOWN_{msgid}")
            self.data = data
            self._msgbuf = bytearray(data)

        def __str__(self) -> str:
            data = self.data
            if self._type == KEYED_UNKNOWN:
                data = _native.recordable(bytes(data))
            return f"{self._type} {{data:{[HEX[byte] for byte in data]}}}"

    return MAVLink_bad_data, MAVLink_unknown


def _deprecated_name_property(namespace: "dict[str, Any]") -> type:
    class mavlink_msg_deprecated_name_property:
        """``name`` of message classes that have no field of that name: use ``msgname`` or ``get_type()``."""

        def __get__(self, instance: "Any", owner: "Any") -> "Any":
            import logging

            logger = logging.getLogger(namespace["__name__"])
            if instance is not None:
                logger.error(
                    "Using .name on a MAVLink_message is not supported, use .get_type() instead."
                )
                raise AttributeError(f"Class {type(instance).__name__} has no attribute 'name'")
            logger.warning(
                "Using .name on a MAVLink_message class is deprecated, consider using .msgname instead.\n"
                "Note that if compatibility with pymavlink 2.4.30 and earlier is desired, use something like this:\n"
                "\n"
                'msg_name =  msg.msgname if hasattr(msg, "msgname") else msg.name'
            )
            return owner.msgname

    return mavlink_msg_deprecated_name_property


def _message_class_maker(
    native: _native.Dialect, base: type, module: str, name_property: "Any", texts: Texts
) -> "Callable[[_native.MessageInfo], type]":
    def make(info: _native.MessageInfo) -> type:
        name = f"MAVLink_{info.name.lower()}_message"
        init = _methods.LazyFunction(info.name, _methods.make_init)
        body: dict[str, Any] = {
            "__doc__": _docs.ClassDoc(native, info, texts),
            "__init__": init,
            "_info": info,
            "id": info.id,
            "msgname": info.name,
            "crc_extra": info.crc_extra,
            "name": name_property,
        }
        for field in info.fieldnames:
            # A field may have the name of an attribute of the class, which then still has its own.
            own = SCHEMA_ATTRS[field][1](info) if field in SCHEMA_ATTRS else body.get(field)
            body[field] = _native.FieldGetter(info, field, class_value=own)
        for field, kind, *_ in info.parameters:
            if kind == "char":
                body[f"_{field}_raw"] = _native.FieldGetter(info, field, raw=True)
        made = _native.message_class(module, name, base, body)
        init.__set_name__(made, "__init__")
        return made

    return make


def _lazy_methods(native: _native.Dialect) -> dict[str, _methods.LazyFunction]:
    """All of them by name."""
    methods = {}
    for message, _ in native.messages():
        lower = message.lower()
        methods[f"{lower}_encode"] = _methods.LazyFunction(message, _methods.make_encode)
        methods[f"{lower}_send"] = _methods.LazyFunction(message, _methods.make_send)
    return methods


def _mavlink_class(native: _native.Dialect, marker: int, namespace: "dict[str, Any]") -> type:
    class MAVLink(_native.MAVLink):
        """One link: encodes and sends messages to ``file``, decodes received bytes."""

        # Set one after the other on a class that is there already they would take ten times as long.
        locals().update(_lazy_methods(native))
        _dialect = native
        protocol_marker = marker
        little_endian = True
        crc_extra = True
        sort_fields = True
        mav20_unpacker = struct.Struct("<cBBBBBBHB")
        mav10_unpacker = struct.Struct("<cBBBBB")
        mav20_h3_unpacker = struct.Struct("BBB")
        mav_csum_unpacker = struct.Struct("<H")
        mav_sign_unpacker = struct.Struct("<IH")

        def __init__(
            self, file: object, srcSystem: int = 0, srcComponent: int = 0, use_native: bool = False
        ) -> None:
            self.file = file
            self.srcSystem = srcSystem
            self.srcComponent = srcComponent
            self.startup_time = time.time()
            self.signing = namespace["MAVLinkSigning"]()

    MAVLink._mavlink_base = MAVLink  # type: ignore[attr-defined]
    return MAVLink


def _error_class() -> type:
    class MAVError(Exception):
        """Bytes that are no valid frame; ``message`` says why."""

        def __init__(self, msg: str) -> None:
            Exception.__init__(self, msg)
            self.message = msg

    return MAVError


def _signing_class() -> type:
    class MAVLinkSigning(_native.Signing):
        """Signing state of one link."""

        @property
        def __dict__(self) -> "dict[str, Any]":  # type: ignore[override]
            return {name: getattr(self, name) for name in SIGNING_ATTRS}

    return MAVLinkSigning


SIGNING_ATTRS = (
    "secret_key timestamp link_id sign_outgoing allow_unsigned_callback stream_timestamps "
    "sig_count badsig_count goodsig_count unsigned_count reject_count"
).split()


def make_classes(
    namespace: "dict[str, Any]", native: _native.Dialect, texts: Texts
) -> "dict[str, Any]":
    """All classes of the module ``namespace`` by name, and the maker of message classes under ``"_make"``."""
    module = namespace["__name__"]
    marker = 254 if native.wire_protocol == "1.0" else 253
    header = _header_class(namespace, marker)
    base = _message_base(native, header)
    bad_data, unknown = _odd_message_classes(base)
    signing = _signing_class()
    mavlink = _mavlink_class(native, marker, namespace)
    name_property = _deprecated_name_property(namespace)
    classes: dict[str, Any] = {
        "MAVLink_header": header,
        "MAVLink_message": base,
        "MAVLink_bad_data": bad_data,
        "MAVLink_unknown": unknown,
        "MAVLinkSigning": signing,
        "MAVLink": mavlink,
        "MAVError": _error_class(),
        "mavlink_msg_deprecated_name_property": name_property,
    }
    for name, cls in classes.items():
        cls.__module__ = module
        cls.__qualname__ = name
        for function in vars(cls).values():
            if type(function) is FunctionType:
                function.__module__ = module
                function.__qualname__ = f"{name}.{function.__name__}"
    classes["_make"] = _message_class_maker(native, base, module, name_property(), texts)
    return classes
