"""The core as Python classes: what `rust/py` exports.

Users meet these through the dialect modules, whose classes derive from the ones here. Bytes are
given as any bytes-like object or iterable of integers where the type is `_BytesLike`, as `bytes`
alone where that is the type. Links and logs are described in `_stubs`, which is there for type checkers alone.
"""

from collections.abc import Callable, Iterable
from typing import Any, Final, Literal, Self, TypeAlias, final

from typing_extensions import Buffer, disjoint_base

from mavwire._stubs.bridge import BridgeCore, BridgeError, BridgeTap, FrameBatch
from mavwire._stubs.columns import (
    ColumnView,
    Converter,
    DataflashTables,
    LakeFile,
    LogColumns,
    LogKind,
    LogRewrite,
    RecordBatches,
    align_tables,
    csv_safe,
    date_text,
    decompress,
    draft_stem,
    empty_table,
    folder_of,
    identify,
    jump_text,
    log_summary,
    write_table,
)
from mavwire._stubs.dataflash import (
    DataflashReader,
    DataflashShape,
    DFMessage,
    MicrosClock,
    gps_time,
)
from mavwire._stubs.links import (
    Link,
    LiveLink,
    SystemState,
    forget_states,
    instance_dict,
    peer_to_replace,
    receive_batch,
    recordable,
    replace_function,
)
from mavwire._stubs.logs import LogLink, LogScan, dump_log
from mavwire._stubs.sending import (
    DescriptorPort,
    Exclusive,
    StreamWriter,
    TlsPort,
)

__all__ = [
    "FIELD_TYPES",
    "BridgeCore",
    "BridgeError",
    "BridgeTap",
    "ColumnView",
    "Converter",
    "DFMessage",
    "DataflashReader",
    "DataflashShape",
    "DataflashTables",
    "DefinitionError",
    "DefinitionFile",
    "DescriptorPort",
    "Dialect",
    "Exclusive",
    "FieldGetter",
    "FrameBatch",
    "LakeFile",
    "Link",
    "LiveLink",
    "LogColumns",
    "LogKind",
    "LogLink",
    "LogRewrite",
    "LogScan",
    "MAVLink",
    "Message",
    "MessageInfo",
    "MetaAttr",
    "MicrosClock",
    "RecordBatches",
    "SequenceGaps",
    "Signing",
    "StatusTexts",
    "StreamWriter",
    "SystemState",
    "TlsPort",
    "__version__",
    "add_message",
    "align_tables",
    "build",
    "builtin_definitions",
    "crc_extra",
    "csv_safe",
    "date_text",
    "decompress",
    "definition_sources",
    "definition_union",
    "describe",
    "draft_stem",
    "dump_log",
    "empty_table",
    "field_type",
    "folder_of",
    "forget_states",
    "gps_time",
    "identify",
    "instance_dict",
    "is_device",
    "jump_text",
    "log_summary",
    "message_class",
    "message_dict",
    "number_behind",
    "peer_to_replace",
    "receive_batch",
    "recordable",
    "replace_function",
    "restore",
    "send_values",
    "write_table",
    "x25_accumulate",
]

_BytesLike: TypeAlias = Buffer | Iterable[int]
# (index, label, description, reserved, default)
_ParamRow: TypeAlias = tuple[int, str, str, bool, str | None]
# (value, name, description, has_location, params)
_EntryRow: TypeAlias = tuple[int, str, str, bool, list[_ParamRow]]
# (enum name, bitmask, description, entries)
_EnumRow: TypeAlias = tuple[str, bool, str, list[_EntryRow]]

__version__: Final[str]

FIELD_TYPES: Final[dict[str, bool]]
"""Each type of field by name, in the order of the `MAVLINK_TYPE_*` numbers: whether its values are floats."""
"""The package's version, out of Cargo.toml."""

class DefinitionError(ValueError):
    """A definition that is wrong or hostile; the text names file, line and reason."""

@final
class DefinitionFile:
    """The text of a definition file, and the name for errors.

    Methods raise DefinitionError. Errors of syntax have the `lineno` and `offset` of an ExpatError.
    """

    def __new__(cls, name: str, text: str) -> DefinitionFile: ...
    def parse(self) -> str:
        """`Definitions` by the rules of `mavparse` and the `Layout` of each message, as JSON."""

    def schema_problems(self, strict_units: bool) -> list[str]:
        """The file's errors by the MAVLink XML schema."""

    def module_problem(self) -> str | None:
        """The first reason why no module can be made of the file."""

    def standalone(self, includes: list[str]) -> str:
        """The text for a generated module to carry, with its includes by these names."""

def builtin_definitions(name: str) -> str:
    """A definition file that comes with mavwire, as `DefinitionFile.parse` gives it; DefinitionError if there is none."""

def definition_union(sets: list[dict[str, str]], with_upstream: bool) -> str:
    """The union of sets of files, for each the texts by file base names, as `DefinitionFile.parse` gives it.

    The first definition of an id, a name or an enum value counts. Behind the sets comes the dialect `upstream` if wanted.
    The `line` of an enum, an entry or a message is its number among all of them: sets in order, their files by name, and
    in a file enums, each with its entries, before messages. DefinitionError where a text is wrong.
    """

def definition_sources() -> str:
    """Where the definitions come from that come with mavwire, as TOML: revision, date and digests by source."""

@final
class Dialect:
    """A resolved dialect, bound to the namespace of its Python module."""

    @staticmethod
    def builtin(name: str, wire_protocol: str) -> Dialect:
        """A dialect that comes with mavwire, laid out for wire protocol "1.0" or "2.0".

        DefinitionError if there is none of that name, ValueError for another protocol.
        """

    @staticmethod
    def from_sources(main: str, sources: dict[str, str], wire_protocol: str) -> Dialect:
        """A dialect from XML texts by base name, starting from `sources[main]`.

        Includes are looked up in `sources` first and among the built-in dialects second.
        """

    @staticmethod
    def merged(first: Dialect, others: list[Dialect]) -> Dialect:
        """One dialect of several: the first that knows a message id names it.

        DefinitionError for too many messages.
        """

    @staticmethod
    def upstream_with(sets: list[dict[str, str]], wire_protocol: str) -> Dialect:
        """The dialect `upstream` with newer sets of definitions: for each set the texts by file base names.

        The first set counts. Layouts of `upstream` that a set replaces are still known. DefinitionError where they make
        no dialect.
        """

    @staticmethod
    def names() -> list[str]:
        """Names of the built-in dialects."""

    def bind(
        self, namespace: dict[str, Any], make_class: Callable[[MessageInfo], type[Message]]
    ) -> None:
        """Ties the dialect to its module: its globals, and the maker of its message classes.

        RuntimeError the second time.
        """

    @property
    def name(self) -> str:
        """Name of the main definition file."""

    @property
    def wire_protocol(self) -> Literal["1.0", "2.0"]:
        """Which protocol messages are laid out for."""

    def messages(self) -> list[tuple[str, int]]:
        """`[(name, id), ...]` in the dialect's order."""

    def defines(self, msgid: int, crc_extra: int) -> bool:
        """Whether frames of a message id with this `crc_extra` are messages, also of an earlier layout."""

    def other_layouts(self) -> list[str]:
        """Names of the layouts that message ids have in other definitions."""

    def message_class(self, name: str) -> type[Any]:
        """The message class of an upper-case name, made on first use; KeyError if there is none."""

    def add_constants(self, namespace: dict[str, Any]) -> None:
        """Adds message ids and enum entries, `<ENUM>_ENUM_END` included."""

    def enums(self) -> list[_EnumRow]:
        """All enums, each with its end marker as the last entry."""

    def layout_text(self, types: set[int] | None = None) -> str:
        """A text of the layouts that tables of some or all messages have. Equal texts mean equal layouts."""

    def invalid_fields(self, frame: bytes) -> dict[str, list[bool]]:
        """The fields of a frame that have invalid values: for each element, whether it is invalid."""

    def descriptions(self, name: str) -> tuple[str, dict[str, str]]:
        """Descriptions of a message and its fields in the definitions, empty for built-in ones.

        KeyError if there is no such message.
        """

@final
class MessageInfo:
    """The schema of one message: `cls._info`."""

    @property
    def name(self) -> str:
        """Upper-case message name."""

    @property
    def id(self) -> int:
        """Message id."""

    @property
    def crc_extra(self) -> int:
        """Checksum seed of the definition."""

    @property
    def min_len(self) -> int:
        """Payload bytes of the base fields."""

    @property
    def max_len(self) -> int:
        """Payload bytes with the extension fields."""

    @property
    def fieldnames(self) -> list[str]:
        """Field names in XML order."""

    @property
    def ordered_fieldnames(self) -> list[str]:
        """Field names in wire order."""

    @property
    def fielddisplays_by_name(self) -> dict[str, str]:
        """Field name to `display`."""

    @property
    def fieldenums_by_name(self) -> dict[str, str]:
        """Field name to enum name."""

    @property
    def fieldunits_by_name(self) -> dict[str, str]:
        """Field name to unit, without brackets."""

    @property
    def unpacker_format(self) -> str:
        """Format of Python's `struct` module, wire order."""

    @property
    def instance(self) -> tuple[str | None, int]:
        """Name of the field that tells instances apart and its payload offset, or (None, -1)."""

    @property
    def parameters(self) -> list[tuple[str, str, int, bool, int | None]]:
        """Constructor parameters, XML order.

        Each is `(name, type, array_length, is_extension, mavlink_version)`.
        """

@final
class FieldGetter:
    """Non-data descriptor: a field of a decoded message, or the raw bytes behind a text field."""

    def __new__(
        cls, info: MessageInfo, field: str, raw: bool = False, class_value: object = None
    ) -> FieldGetter: ...
    def __get__(self, instance: object, owner: type | None = None, /) -> Any: ...

@final
class MetaAttr:
    """Non-data descriptor: an attribute that no definition describes (`_header`, `data`, ...)."""

    def __new__(cls, name: str) -> MetaAttr: ...
    def __get__(self, instance: object, owner: type | None = None, /) -> Any: ...

@disjoint_base
class Message:
    """One MAVLink message: a received frame whose fields are decoded when read, or built values."""

    # Built messages compare by value, so they have no hash.
    __hash__: None  # type: ignore[assignment]

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Self: ...
    @property
    def _timestamp(self) -> float:
        """Seconds since 1970 (or of the log's own clock), set by whoever received the message."""

    @_timestamp.setter
    def _timestamp(self, value: float) -> None: ...
    def get_msgbuf(self) -> bytearray:
        """The whole frame, signature included; empty before packing or decoding."""

    def get_header(self) -> Any:
        """The header object."""

    def get_payload(self) -> bytes | bytearray | None:
        """After packing the payload as sent; after decoding the frame from byte 6 to the checksum."""

    def get_crc(self) -> int | None:
        """Checksum of the frame, or None."""

    def get_fieldnames(self) -> list[str]:
        """Field names in XML order."""

    def get_type(self) -> str:
        """Message name, "BAD_DATA" or "UNKNOWN_<id>"."""

    def get_msgId(self) -> int:
        """Message id; -1 for BAD_DATA, -2 for UNKNOWN."""

    def get_srcSystem(self) -> int:
        """Id of the sending system."""

    def get_srcComponent(self) -> int:
        """Id of the sending component."""

    def get_seq(self) -> int:
        """Sequence number of the frame."""

    def get_signed(self) -> bool:
        """True only if a signature was checked with a key and was good."""

    def get_link_id(self) -> int | None:
        """Link id of a verified signature, else None."""

    def format_attr(self, field: str) -> Any:
        """A field as text and JSON show it: bytes become text, everything else stays."""

    def to_dict(self) -> dict[str, Any]:
        """`{"mavpackettype": type, field: value, ...}` in XML order."""

    def to_json(self) -> str:
        """`json.dumps(to_dict())`; TypeError for values that JSON does not have."""

    def pack(self, mav: MAVLink, force_mavlink1: bool = False) -> bytes:
        """The frame, with source and sequence number taken from `mav`, which is not advanced.

        `struct.error` names what is wrong with a value.
        """

    def _pack(
        self, mav: MAVLink, crc_extra: int, payload: bytes, force_mavlink1: bool = False
    ) -> bytes:
        """Frames a ready payload."""

    def sign_packet(self, mav: MAVLink) -> None:
        """Appends a signature to the packed frame and advances the signing timestamp."""

    def __getitem__(self, key: Any, /) -> Any:
        """The message of one instance (battery, named value, ...), where mavutil keeps several."""

    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __setattr__(self, name: str, value: Any, /) -> None: ...
    def __delattr__(self, name: str, /) -> None: ...
    def __copy__(self) -> Message: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class StatusTexts:
    """Joins the parts of long STATUSTEXT messages."""

    def __new__(cls) -> StatusTexts: ...
    def hear(self, message: Message) -> list[tuple[Message, bytes]]:
        """The texts that a received message completes: `(first message, text)`.

        Empty for a message that begins a longer text, and for a message of another type.
        """

    def finish(self) -> list[tuple[Message, bytes]]:
        """Ends the incomplete texts and returns them."""

@final
class SequenceGaps:
    """Counts messages and the gaps before them, of each component, or of its types apart."""

    def __new__(cls, by_type: bool) -> Self: ...
    def read(self, messages: Iterable[Any]) -> list[Any]:
        """Counts messages in the order in which they came. Gives those that it does not know: BAD_DATA
        and UNKNOWN.
        """

    def rows(self) -> list[tuple[int, int, str | None, int, int, int, int]]:
        """`(sysid, compid, type, seen, gaps, lost, first_gap)` for each component, type None, or its
        messages of a type, in the order in which they were first seen. `gaps` were noticed by such a message, `lost` are
        missing in them, `first_gap` grows with the place of the first one in the log and is 0 if there
        is none.
        """

@disjoint_base
class Signing:
    """Signing state of one link."""

    def __new__(cls) -> Self: ...
    @property
    def secret_key(self) -> bytes | None:
        """The secret key: 32 bytes, or None. ValueError for any other length."""

    @secret_key.setter
    def secret_key(self, value: _BytesLike | None) -> None: ...
    @property
    def timestamp(self) -> int:
        """Timestamp of the next signed frame, in 10 us since 2015-01-01."""

    @timestamp.setter
    def timestamp(self, value: int) -> None: ...
    def _set_up(
        self,
        key: _BytesLike | None,
        sign_outgoing: object,
        allow_unsigned_callback: Callable[[Any, int], object] | None,
        link_id: int,
        timestamp: int,
        follows_clock: bool,
        keep: Callable[[int], int] | None,
        max_ahead: int | None,
    ) -> None:
        """Key, policy and timestamps at once, so that no other thread sees some of them without the
        rest. Timestamps follow the clock or count up, and `keep(timestamp) -> mark` is called before
        those from the mark on are used. Received timestamps may be `max_ahead` units ahead of the
        clock, or any number where it is None."""

    def _share(self, other: Signing) -> bool:
        """Shares the stream table of `other` if that has the same key; whether it has."""

    @property
    def link_id(self) -> int:
        """Link id that outgoing signatures carry, 0 to 255."""

    @link_id.setter
    def link_id(self, value: int) -> None: ...
    @property
    def sign_outgoing(self) -> bool:
        """Sign what is sent."""

    @sign_outgoing.setter
    def sign_outgoing(self, value: object) -> None: ...
    @property
    def allow_unsigned_callback(self) -> Callable[[Any, int], object] | None:
        """`callback(mav, msgId)` decides about frames that are not signed, or not well."""

    @allow_unsigned_callback.setter
    def allow_unsigned_callback(self, value: Callable[[Any, int], object] | None) -> None: ...
    @property
    def stream_timestamps(self) -> dict[tuple[int, int, int], int]:
        """Last timestamp of each verified stream by (link_id, sysid, compid); a copy."""

    @stream_timestamps.setter
    def stream_timestamps(self, value: dict[tuple[int, int, int], int]) -> None: ...
    sig_count: int
    """Signed frames received."""
    goodsig_count: int
    """Good signatures."""
    badsig_count: int
    """Bad signatures."""
    unsigned_count: int
    """Frames that the callback let pass."""
    reject_count: int
    """Frames that the callback rejected."""

@disjoint_base
class MAVLink:
    """Protocol state of one link. The class of each dialect derives from it."""

    seq: int
    """Sequence number of the next frame, 0 to 255."""
    srcSystem: int
    """System id that frames are sent with."""
    srcComponent: int
    """Component id that frames are sent with."""
    file: Any
    """The receiver of frames: any object with `write(bytes)`."""
    total_packets_sent: int
    """Frames sent."""
    total_bytes_sent: int
    """Bytes sent."""
    total_packets_received: int
    """Messages received, BAD_DATA and UNKNOWN included."""
    total_bytes_received: int
    """Bytes given to `parse_char` and `parse_buffer`."""
    total_receive_errors: int
    """Runs of junk and rejected frames."""
    expected_length: int
    """Bytes of the frame being received, as far as known."""
    have_prefix_error: bool
    """The last byte read started no frame (only without `robust_parsing`)."""
    buf_index: int
    """Always 0: `buf` starts with the first unread byte. Assigning drops that many bytes."""

    # The callbacks and their arguments may be replaced one by one.
    callback: Callable[..., object] | None
    callback_args: Any
    callback_kwargs: Any
    send_callback: Callable[..., object] | None
    send_callback_args: Any
    send_callback_kwargs: Any

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Self: ...
    @property
    def robust_parsing(self) -> bool:
        """Bad input gives BAD_DATA messages instead of exceptions."""

    @robust_parsing.setter
    def robust_parsing(self, value: object) -> None: ...
    @property
    def resync(self) -> Literal["skip", "rescan"]:
        """The way to go on after a damaged frame.

        "skip" drops its whole claimed length, "rescan" looks for frames inside it.
        """

    @resync.setter
    def resync(self, value: Literal["skip", "rescan"]) -> None: ...
    @property
    def signing(self) -> Signing:
        """Signing state."""

    @signing.setter
    def signing(self, value: Signing) -> None: ...
    @property
    def buf(self) -> bytearray:
        """Bytes received and not parsed yet (a copy)."""

    @buf.setter
    def buf(self, value: bytes | bytearray | list[int]) -> None: ...
    def set_callback(
        self, callback: Callable[..., object] | None, *args: Any, **kwargs: Any
    ) -> None:
        """`callback(message, *args, **kwargs)` is called for every message received."""

    def set_send_callback(
        self, callback: Callable[..., object] | None, *args: Any, **kwargs: Any
    ) -> None:
        """`callback(message, *args, **kwargs)` is called for every message sent."""

    def send(self, mavmsg: Any, force_mavlink1: bool = False) -> None:
        """Packs the message and writes it to `file`.

        Nothing advances if packing or writing fails.
        """

    def send_many(self, messages: Iterable[Any], force_mavlink1: bool = False) -> None:
        """Sends messages in order. As many frames as fit into the `batch_bytes` of `file` leave in one call of its
        `write`.

        A message that cannot be packed is an error after those before it were sent.
        """

    def _share_sending(self, other: MAVLink) -> None:
        """From now on the sequence numbers and counters of what is sent are those of `other`, whose place this one
        takes: threads may be sending with it."""

    def _holds_trusted(self, data: bytes) -> bool:
        """Whether bytes that are not received here hold a message that may say who sent them: a good one, or with a
        key a genuine one that is newer than all that was received or looked at. Receiving them finds all as it was."""

    def buf_len(self) -> int:
        """Bytes received and not parsed yet."""

    def bytes_needed(self) -> int:
        """Bytes still missing of the frame being received; at least 1."""

    def parse_char(self, c: _BytesLike) -> Message | None:
        """Takes bytes and returns one message, or None.

        What is left over waits for the next call. Without `robust_parsing` the dialect's
        `MAVError` says what is wrong with the input.
        """

    def parse_buffer(self, s: _BytesLike) -> list[Any] | None:
        """Parses bytes. Returns all messages that end in them as a list, None without a message."""

    def decode(self, msgbuf: bytearray) -> Message:
        """Decodes one complete frame; the dialect's `MAVError` says what is wrong with it."""

    def check_signature(self, msgbuf: _BytesLike, srcSystem: int, srcComponent: int) -> bool:
        """True if the frame's signature is good and fresh; only then the stream's state moves."""

    def __setattr__(self, name: str, value: Any, /) -> None: ...
    def __delattr__(self, name: str, /) -> None: ...

def add_message(messages: dict[str, Any], kind: str, message: Message) -> None:
    """Makes `message` the newest of its type, and of its instance where the type has instances."""

def build(message: Message, /, *values: Any) -> None:
    """Sets the fields of a built message, in XML order."""

def send_values(mav: Any, info: MessageInfo, force_mavlink1: object, /, *values: Any) -> None:
    """Sends a message without making an object of it, unless somebody is there to see one."""

def is_device(name: str) -> bool:
    """Whether Windows treats the name of a file or folder as a device, such as `nul` or `COM1.txt`."""

def message_class(module: str, name: str, base: type, body: dict[str, Any]) -> type[Any]:
    """A class of messages with the attributes in `body`, like `type(name, (base,), body)`.

    `base` is the dialect's base class of messages. Its instances are kept for reuse once free.
    """

def message_dict(message: Message) -> dict[str, Any]:
    """`vars(message)`: the instance dictionary with every attribute in it."""

def restore(
    cls: type[Message], frame: bytes | None, flags: int, timestamp: float | None, link: int
) -> Message:
    """Rebuilds a pickled message. ValueError if `frame` is no frame of the class."""

def field_type(text: str) -> tuple[str, int, int, str]:
    """`(type, elements, bytes of one, struct code)` of a field's type; 0 elements for a scalar.

    Raises DefinitionError.
    """

def crc_extra(name: str, fields: list[tuple[str, str, int]]) -> int:
    """The checksum seed of a message with these base fields in wire order: type, name and length."""

def number_behind(
    automatic: list[int], own: tuple[int, int], included: tuple[int, int]
) -> list[int]:
    """The values of entries that have none in the definitions, after an included file adds to their
    enum. Ranges are the lowest and the highest value of each file.
    """

def describe(main: str, sources: dict[str, str]) -> dict[str, Any]:
    """All descriptions of a dialect, out of XML texts by base name. Raises DefinitionError.

    `{"messages": {name: (text, {field: text})}, "enums": {enum: {entry: (text, {index: text})}}}`
    """

def x25_accumulate(crc: int, data: bytes) -> int:
    """Continues a CRC-16/MCRF4XX from `crc` over `data`."""
