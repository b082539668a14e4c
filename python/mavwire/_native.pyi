"""The core as Python classes: what `rust/py` exports.

Users meet these through the dialect modules, whose classes derive from the ones here. Bytes are
given as any bytes-like object or iterable of integers where `_BytesLike` stands, as `bytes` alone
where that stands.
"""

from collections.abc import Callable, Iterable
from os import PathLike
from typing import Any, Final, Literal, Protocol, TypeAlias, final

from typing_extensions import Buffer, disjoint_base

from mavwire._native_bridge import BridgeCore as BridgeCore
from mavwire._native_bridge import BridgeError as BridgeError
from mavwire._native_bridge import BridgeTap as BridgeTap
from mavwire._native_bridge import FrameBatch as FrameBatch

__all__ = [
    "BridgeCore",
    "BridgeError",
    "BridgeTap",
    "DefinitionError",
    "Dialect",
    "FieldGetter",
    "FrameBatch",
    "Link",
    "LiveLink",
    "LogLink",
    "LogScan",
    "MAVLink",
    "Message",
    "MessageInfo",
    "MetaAttr",
    "OddField",
    "Signing",
    "SystemState",
    "__version__",
    "add_message",
    "build",
    "describe",
    "dump_log",
    "forget_states",
    "instance_dict",
    "message_class",
    "message_dict",
    "receive_batch",
    "restore",
    "send_values",
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
"""The package's version, out of Cargo.toml."""

class DefinitionError(ValueError):
    """A definition that is wrong or hostile; the text names file, line and reason."""

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

    def message_class(self, name: str) -> type[Any]:
        """The message class of an upper-case name, made on first use; KeyError if there is none."""

    def add_constants(self, namespace: dict[str, Any]) -> None:
        """Adds message ids and enum entries, `<ENUM>_ENUM_END` included."""

    def enums(self) -> list[_EnumRow]:
        """All enums, each with its end marker as the last entry."""

    def descriptions(self, name: str) -> tuple[str, dict[str, str]]:
        """What the definitions themselves say of a message and its fields, empty for built-in ones.

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
    def fieldtypes(self) -> list[str]:
        """Base type of each field, XML order."""

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
    def native_format(self) -> str:
        """One `struct` letter per field in wire order, after `<`."""

    @property
    def orders(self) -> list[int]:
        """`orders[i]` is the wire position of the i-th field in XML order."""

    @property
    def lengths(self) -> list[int]:
        """Elements per field in wire order: 1 for scalars and text."""

    @property
    def array_lengths(self) -> list[int]:
        """Array lengths in wire order: 0 for scalars."""

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

    @property
    def char_fields(self) -> list[str]:
        """Names of the fields that hold text."""

@final
class FieldGetter:
    """Non-data descriptor: a field of a decoded message, or the raw bytes behind a text field."""

    def __new__(
        cls, info: MessageInfo, field: str, raw: bool = False, class_value: object = None
    ) -> FieldGetter: ...
    def __get__(self, instance: object, owner: type | None = None, /) -> Any: ...

@final
class MetaAttr:
    """Non-data descriptor: an underscore attribute of a message (`_header`, `_msgbuf`, ...)."""

    def __new__(cls, name: str) -> MetaAttr: ...
    def __get__(self, instance: object, owner: type | None = None, /) -> Any: ...

@final
class OddField:
    """Non-data descriptor: "data" or "reason" of BAD_DATA and UNKNOWN messages."""

    def __new__(cls, name: str) -> OddField: ...
    def __get__(self, instance: object, owner: type | None = None, /) -> Any: ...

@disjoint_base
class Message:
    """One MAVLink message: a received frame whose fields are decoded when read, or built values."""

    # Built messages compare by value, so they have no hash.
    __hash__: None  # type: ignore[assignment]

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Message: ...
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
    def __deepcopy__(self, memo: dict[int, Any]) -> Message: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@disjoint_base
class Signing:
    """Signing state of one link."""

    def __new__(cls) -> Signing: ...
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
    _follows_clock: bool
    """Outgoing timestamps follow the clock instead of counting up."""

    def _share(self, other: Signing) -> bool:
        """Shares the stream table of `other` if that has the same key; whether it has."""

    def _keep_timestamps(self, keep: Callable[[int], int] | None) -> None:
        """From now on `keep(timestamp) -> mark` is called before timestamps from the mark on are
        used; None ends that."""

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
    """What frames are written to: any object with `write(bytes)`."""
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

    def __new__(cls, *_args: Any, **_kwargs: Any) -> MAVLink: ...
    @property
    def robust_parsing(self) -> bool:
        """Bad input gives BAD_DATA messages instead of exceptions."""

    @robust_parsing.setter
    def robust_parsing(self, value: object) -> None: ...
    @property
    def resync(self) -> Literal["skip", "rescan"]:
        """What to do after a damaged frame.

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
        """Takes bytes and returns all messages in them as a list, or None if there are none."""

    def decode(self, msgbuf: bytearray) -> Message:
        """Decodes one complete frame; the dialect's `MAVError` says what is wrong with it."""

    def check_signature(self, msgbuf: _BytesLike, srcSystem: int, srcComponent: int) -> bool:
        """True if the frame's signature is good and fresh; only then the stream's state moves."""

    def __setattr__(self, name: str, value: Any, /) -> None: ...
    def __delattr__(self, name: str, /) -> None: ...

@disjoint_base
class SystemState:
    """Base of `mavutil.mavfile_state`: holds the table of newest messages."""

    def __new__(cls, *_args: Any, **_kwargs: Any) -> SystemState: ...
    messages: dict[str, Any]
    """Message type -> newest message."""

    @property
    def components(self) -> dict[int, dict[str, Any]]:
        """Component id -> message type -> newest message of that component alone."""

    def __setattr__(self, name: str, value: Any, /) -> None: ...
    def __delattr__(self, name: str, /) -> None: ...

@disjoint_base
class Link:
    """The part of `mavutil.mavfile`'s state that every message changes."""

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Link: ...
    mav: Any
    """The `MAVLink` object of the current dialect."""
    message_hooks: Any
    """Functions called as `hook(link, message)` for every message."""
    mav_count: int
    """Messages received, radio status, BAD_DATA and UNKNOWN not counted."""
    mav_loss: int
    """Messages lost, by the gaps in sequence numbers."""
    uptime: float
    """Seconds since the vehicle booted, as its messages say."""
    first_byte: bool
    """The protocol version of the link is still to be found out from its first byte."""
    logfile: Any
    """File that received messages are recorded to, or None."""
    logfile_raw: Any
    """File that received bytes are recorded to, or None."""

    @property
    def sysid_state(self) -> dict[int, Any]:
        """System id -> mavfile_state."""

    @sysid_state.setter
    def sysid_state(self, value: dict[int, Any]) -> None: ...
    @property
    def last_seq(self) -> dict[tuple[int, int], int]:
        """`{(sysid, compid): last sequence number}`, a copy."""

    @last_seq.setter
    def last_seq(self, value: dict[tuple[int, int], int]) -> None: ...
    @property
    def timestamp(self) -> float:
        """Time of the last message in seconds since 1970; 0 before the first."""

    @timestamp.setter
    def timestamp(self, value: float) -> None: ...
    @property
    def _timestamp(self) -> float | None:
        """Time of the record being read from a log; None on live links."""

    @_timestamp.setter
    def _timestamp(self, value: float | None) -> None: ...
    @property
    def notimestamps(self) -> bool:
        """Messages are stamped with `uptime` instead of the time of their record."""

    @notimestamps.setter
    def notimestamps(self, value: object) -> None: ...
    def post_message(self, msg: Message) -> None:
        """Takes a received message into the link's state, once, then calls the message hooks."""

    def _fix_home(self, sysid: int) -> None:
        """The home position of a system is known for good."""

def receive_batch(link: LiveLink, messages: list[Any], limit: int) -> bool:
    """Append to `messages` what `link` has received, `limit` at most; whether there may be more.

    An error is raised with the messages before it in the list. Where a read took everything the
    socket held, no other read is tried: whoever watches the descriptor is told what comes next.
    """

@disjoint_base
class LiveLink(Link):
    """A link over a socket, a serial port or a pipe: the live links of `mavutil` derive from it.

    A class derived from it has `_quick_class`, the class whose methods the native ones stand for.
    """

    def __new__(cls, *_args: Any, **_kwargs: Any) -> LiveLink: ...
    def __setattr__(self, name: str, value: Any, /) -> None: ...
    def __delattr__(self, name: str, /) -> None: ...
    def recv_msg(self) -> Any:
        """The next message, BAD_DATA and UNKNOWN included; None when nothing has arrived."""

    def recv_match(
        self,
        condition: str | None = None,
        type: str | Iterable[str] | None = None,
        blocking: bool = False,
        timeout: float | None = None,
    ) -> Any:
        """The next message of a `type` (name, list or set) for which `condition` holds.

        Messages that do not match are consumed, but have updated the state. Returns None when
        nothing is there, or when blocking, after `timeout` seconds.
        """

    @property
    def peers_forgotten(self) -> int:
        """Peers that had to make room for others."""
    _has_unsent: bool
    """Bytes wait to be sent, so that receiving has to go through Python, which sends them."""

    def _read_stream(self) -> None:
        """From now on `port` may be read natively, as a stream."""

    def _read_datagrams(self, own: tuple[Any, ...] | None = None) -> None:
        """From now on `port` may be read natively, as datagrams; those from `own` are left out."""

    def _take_datagram(self) -> tuple[bytes, tuple[Any, ...]] | None:
        """A datagram that was read ahead, or the rest of one, with its sender."""

    def _switch_peer(self, address: Any) -> None:
        """What is parsed next comes from `address`: bytes of another peer's frame are put aside."""

@disjoint_base
class LogLink(Link):
    """A telemetry log as a link: `mavutil.mavlogfile` derives from it.

    A class derived from it has `_quick_class`, the class whose methods the native ones stand for.
    """

    def __new__(cls, *_args: Any, **_kwargs: Any) -> LogLink: ...
    percent: float
    """How much of the log is read, 0 to 100."""

    def recv(self, n: int | None = None) -> bytes:
        """Up to `n` bytes of the log; empty at its end."""

    def recv_msg(self) -> Any:
        """The next message, BAD_DATA and UNKNOWN included; None at the end of the log."""

    def recv_match(
        self,
        condition: str | None = None,
        type: str | Iterable[str] | None = None,
        blocking: bool = False,
        timeout: float | None = None,
    ) -> Any:
        """The next message of a `type` (name, list or set) for which `condition` holds.

        None at the end of the log. An indexed log is read only where messages of the wanted types,
        heartbeats and parameters stand.
        """

    def pre_message(self) -> None:
        """Reads the time stamp of the next record."""

    def scan_timestamp(self, tbuf: bytes) -> float:
        """The time stamp `tbuf`, or the first believable one behind it, to which the log moves.

        Believable is what is within three days of the last good message. ValueError unless `tbuf`
        has 8 bytes.
        """

    def skip_to_type(self, type: str | Iterable[str]) -> None:
        """Seeks to the next record of the types in `type`, heartbeats or parameters.

        The types of the first call stay in force until the log is rewound. Behind the last such
        record reading goes on record by record.
        """

    def _open_reader(self, path: str | PathLike[str], stamped: bool, now: float) -> None:
        """Opens the file for reading; `stamped` says that its records have time stamps. OSError."""

    def _close_reader(self) -> None:
        """Closes the file; from then on the log is at its end."""

    def _tell(self) -> int:
        """Position in the file."""

    def _seek(self, offset: int) -> None:
        """Continues at the record that begins at `offset`, whatever was read before."""

    def _restart(self) -> None:
        """Reads from the start again, of any types."""

    def _build_index(self, progress_callback: Callable[[int], object] | None = None) -> None:
        """Indexes the log; `progress_callback` gets each new whole percent."""

    def _index_counts(self) -> list[tuple[int, str, int]]:
        """`[(message id, name, count), ...]` in the order in which the types first appear."""

    def _index_total(self) -> int:
        """Records in the index."""

    def _index_offsets(self, msgid: int) -> list[int]:
        """Offsets of the records of one message id."""

    def _wanted_ids(self) -> list[int] | None:
        """Message ids that a filtered read visits; None before the first one."""

    def _visited_offset(self) -> int:
        """Where the record begins that a filtered read visited last, 0 before the first one."""

class _Selection(Protocol):
    """Which messages a `LogScan` gives; None stands for all."""

    types: list[int] | None
    unknown: list[int] | None
    systems: list[int] | None
    start: float | None
    end: float | None

@final
class LogScan:
    """One pass over a telemetry log, an iterator of messages."""

    def __new__(
        cls, path: str | PathLike[str], dialect: Dialect, rescan: bool, wanted: _Selection
    ) -> LogScan: ...
    def __iter__(self) -> LogScan: ...
    def __next__(self) -> Message:
        """The next message; OSError where reading fails, after what was read before."""

    def count(self) -> int:
        """Runs to the end and counts the messages instead of making them."""

    def close(self) -> None:
        """Closes the file; the pass is at its end."""

def add_message(messages: dict[str, Any], kind: str, message: Message) -> None:
    """Makes `message` the newest of its type, and of its instance where the type has instances."""

def forget_states() -> None:
    """Makes every link look its systems' states up again: somebody replaced one."""

def instance_dict(object: Any) -> dict[str, Any]:
    """The instance's own dictionary, for classes that show a `__dict__` of their own making."""

def build(message: Message, /, *values: Any) -> None:
    """Sets the fields of a built message, in XML order."""

def send_values(mav: Any, info: MessageInfo, force_mavlink1: object, /, *values: Any) -> None:
    """Sends a message without making an object of it, unless somebody is there to see one."""

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

def describe(main: str, sources: dict[str, str]) -> dict[str, Any]:
    """All descriptions of a dialect, out of XML texts by base name. Raises DefinitionError.

    `{"messages": {name: (text, {field: text})}, "enums": {enum: {entry: (text, {index: text})}}}`
    """

def dump_log(log: LogLink, options: Any) -> None:
    """Dumps a log from where it stands to its end, as `options` (of `mavwire dump`) say.

    RuntimeError if the log is not open or cannot be read natively. Where reading or a callback
    fails, what was read before is written first.
    """

def x25_accumulate(crc: int, data: bytes) -> int:
    """Continues a CRC-16/MCRF4XX from `crc` over `data`."""
