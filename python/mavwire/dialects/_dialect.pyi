"""The common part of all dialect modules, for type checkers: there is no such module at run time.

The stubs that `tools/generate_stubs.py` writes import this and add messages and constants. Each
dialect module makes these classes anew; here they are written once, so that code that is typed for
one dialect takes the messages and links of another that includes it.
"""

import hashlib as hashlib
import json as json
import logging as logging
import os as os
import struct as struct
import sys as sys
import time as time
from collections.abc import Sequence as Sequence
from typing import Any as Any
from typing import Callable as Callable
from typing import ClassVar
from typing import Dict as Dict
from typing import Iterable as Iterable
from typing import List as List
from typing import Mapping as Mapping
from typing import Optional as Optional
from typing import Protocol, TypeAlias
from typing import Tuple as Tuple
from typing import Type as Type
from typing import Union as Union

from mavwire import _native
from mavwire.dialects._enums import Enum as Enum
from mavwire.dialects._enums import EnumEntry as EnumEntry
from mavwire.dialects._x25 import _x25crc_fast as _x25crc_fast
from mavwire.dialects._x25 import _x25crc_slow as _x25crc_slow
from mavwire.dialects._x25 import mcrf4xx as mcrf4xx
from mavwire.dialects._x25 import x25crc as x25crc

BytesLike: TypeAlias = list[int] | tuple[int, ...] | bytes | bytearray | str
MAVLinkV1Header: TypeAlias = tuple[bytes, int, int, int, int, int]
MAVLinkV2Header: TypeAlias = tuple[bytes, int, int, int, int, int, int, int, int]

WIRE_PROTOCOL_VERSION: str
DIALECT: str
PROTOCOL_MARKER_V1: int = 0xFE
PROTOCOL_MARKER_V2: int = 0xFD
HEADER_LEN_V1: int = 6
HEADER_LEN_V2: int = 10
MAVLINK_SIGNATURE_BLOCK_LEN: int = 13
MAVLINK_IFLAG_SIGNED: int = 1
MAVLINK_IGNORE_CRC: int | str
MAVLINK_TYPE_CHAR: int = 0
MAVLINK_TYPE_UINT8_T: int = 1
MAVLINK_TYPE_INT8_T: int = 2
MAVLINK_TYPE_UINT16_T: int = 3
MAVLINK_TYPE_INT16_T: int = 4
MAVLINK_TYPE_UINT32_T: int = 5
MAVLINK_TYPE_INT32_T: int = 6
MAVLINK_TYPE_UINT64_T: int = 7
MAVLINK_TYPE_INT64_T: int = 8
MAVLINK_TYPE_FLOAT: int = 9
MAVLINK_TYPE_DOUBLE: int = 10
MAVLINK_MSG_ID_BAD_DATA: int = -1
MAVLINK_MSG_ID_UNKNOWN: int = -2

enums: dict[str, Enum]
mavlink_map: dict[int, type[MAVLink_message]]
logger: logging.Logger

class MAVLink_header:
    """Header of a frame."""

    mlen: int
    seq: int
    srcSystem: int
    srcComponent: int
    msgId: int
    incompat_flags: int
    compat_flags: int

    def __init__(
        self,
        msgId: int,
        incompat_flags: int = 0,
        compat_flags: int = 0,
        mlen: int = 0,
        seq: int = 0,
        srcSystem: int = 0,
        srcComponent: int = 0,
    ) -> None: ...
    def pack(self, force_mavlink1: bool = False) -> bytes:
        """The header's bytes for the module's `WIRE_PROTOCOL_VERSION`, or version 1 if forced."""

class MAVLink_message(_native.Message):
    """Base class of all messages.

    Numbers read as `int` or `float`, arrays as lists, text fields as `str`; text is given as
    `bytes`. What is assigned to a field is kept as it is until the message is packed.
    """

    # The message's id on the class; some messages have a field of this name on their instances.
    id: int
    msgname: ClassVar[str]
    crc_extra: ClassVar[int]
    fieldnames: ClassVar[list[str]]
    ordered_fieldnames: ClassVar[list[str]]
    fieldtypes: ClassVar[list[str]]
    fielddisplays_by_name: ClassVar[dict[str, str]]
    fieldenums_by_name: ClassVar[dict[str, str]]
    fieldunits_by_name: ClassVar[dict[str, str]]
    native_format: ClassVar[bytearray]
    orders: ClassVar[list[int]]
    lengths: ClassVar[list[int]]
    array_lengths: ClassVar[list[int]]
    unpacker: ClassVar[struct.Struct]
    instance_field: ClassVar[str | None]
    instance_offset: ClassVar[int]

    _header: MAVLink_header
    _payload: bytes | bytearray | None
    _msgbuf: bytearray
    _crc: int | None
    _fieldnames: list[str]
    _type: str
    _signed: bool
    _link_id: int | None
    _instances: dict[Any, Any] | None
    _instance_field: str | None
    _instance_offset: int
    # Set by mavutil's links and logs.
    _posted: bool
    _link: int

    def __init__(self, msgId: int, name: str) -> None: ...
    def get_header(self) -> MAVLink_header: ...

class MAVLink_bad_data(MAVLink_message):
    """Bytes that are no valid frame, with the reason."""

    data: bytes | bytearray
    reason: str

    def __init__(self, data: bytes | bytearray, reason: str) -> None: ...

class MAVLink_unknown(MAVLink_message):
    """A frame whose message id the dialect does not define; `data` is the whole frame."""

    data: bytes | bytearray

    def __init__(self, msgid: int, data: bytes | bytearray) -> None: ...

class mavlink_msg_deprecated_name_property:
    """`name` of message classes that have no field of that name: use `msgname` or `get_type()`."""

    def __get__(self, instance: object, owner: type) -> str: ...

class MAVError(Exception):
    """Bytes that are no valid frame; `message` says why."""

    message: str

    def __init__(self, msg: str) -> None: ...

class MAVLinkSigning(_native.Signing):
    """Signing state of one link."""

class _Writer(Protocol):
    def write(self, buf: bytes, /) -> object: ...

class _Link(_native.MAVLink):
    """The part of `MAVLink` that all dialects share; each adds `<message>_encode` and `<message>_send`."""

    file: _Writer | None
    startup_time: float
    protocol_marker: int
    little_endian: bool
    crc_extra: bool
    sort_fields: bool
    mav20_unpacker: struct.Struct
    mav10_unpacker: struct.Struct
    mav20_h3_unpacker: struct.Struct
    mav_csum_unpacker: struct.Struct
    mav_sign_unpacker: struct.Struct

    def __init__(
        self,
        file: _Writer | None,
        srcSystem: int = 0,
        srcComponent: int = 0,
        use_native: bool = False,
    ) -> None: ...
    def send(self, mavmsg: MAVLink_message, force_mavlink1: bool = False) -> None: ...
    def parse_char(self, c: _native._BytesLike) -> MAVLink_message | None: ...
    def parse_buffer(self, s: _native._BytesLike) -> list[MAVLink_message] | None: ...
    def decode(self, msgbuf: bytearray) -> MAVLink_message: ...
