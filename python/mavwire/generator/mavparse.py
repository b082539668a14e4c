"""Definition files as Python objects: ``MAVXML`` reads one file, the functions below work on a list
of them.

This is the interface that generators and inspection tools use. It follows the published definitions
of the wire layout: base fields are sorted by element size, extension fields keep their order,
``crc_extra`` covers base fields.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator

from mavwire._native import DefinitionFile, crc_extra, number_behind
from mavwire.dialects._sources import read_text
from mavwire.generator import _build
from mavwire.generator._build import FLAG_HAVE_TARGET_COMPONENT, FLAG_HAVE_TARGET_SYSTEM
from mavwire.generator._errors import MAVParseError, MAVSyntaxError, parse_errors
from mavwire.generator._model import (
    MAVDeprecated,
    MAVEnum,
    MAVEnumEntry,
    MAVEnumParam,
    MAVField,
    MAVType,
)

__all__ = [
    "FLAG_HAVE_TARGET_COMPONENT",
    "FLAG_HAVE_TARGET_SYSTEM",
    "MAVXML",
    "PROTOCOL_1_0",
    "PROTOCOL_2_0",
    "MAVDeprecated",
    "MAVEnum",
    "MAVEnumEntry",
    "MAVEnumParam",
    "MAVField",
    "MAVParseError",
    "MAVSyntaxError",
    "MAVType",
    "check_duplicates",
    "check_missing_enum",
    "merge_enums",
    "message_checksum",
    "mkdir_p",
    "total_msgs",
]

PROTOCOL_1_0 = "1.0"
PROTOCOL_2_0 = "2.0"

_PROTOCOL_MARKERS = {PROTOCOL_1_0: 0xFE, PROTOCOL_2_0: 0xFD}
_DEFAULT_VERSION = 2
_MAX_V1_MESSAGE_ID = 0xFF


class MAVXML:
    """One definition file, includes unresolved, laid out for one wire protocol.

    Version 1.0 leaves out messages with an id above 255 and all extension fields. Dictionaries are
    keyed by message id; lengths and offsets are bytes of the payload. Raises OSError, or
    :class:`MAVParseError` with file and line.
    """

    def __init__(self, filename: str, wire_protocol_version: str = PROTOCOL_1_0) -> None:
        if wire_protocol_version not in _PROTOCOL_MARKERS:
            known = " ".join(_PROTOCOL_MARKERS)
            print(f"Unknown wire protocol version\nAvailable versions are: {known}")
            raise MAVParseError(f"Unknown MAVLink wire protocol version {wire_protocol_version}")
        self.filename = filename
        self.basename = base_name(filename)
        self.basename_upper = self.basename.upper()
        self.parse_time = time.strftime("%a %b %d %Y")
        self.wire_protocol_version = wire_protocol_version
        self.protocol_marker = _PROTOCOL_MARKERS[wire_protocol_version]
        self.little_endian = self.sort_fields = self.crc_extra = True
        self.crc_struct = self.command_24bit = self.allow_extensions = (
            wire_protocol_version == PROTOCOL_2_0
        )
        self._read()
        self._index_messages()

    def __str__(self) -> str:
        return (
            f"MAVXML for {self.basename} from {self.filename} "
            f"({len(self.message)} message, {len(self.enum)} enums)"
        )

    def _read(self) -> None:
        with parse_errors():
            self.text = read_text(self.filename)
            data, layouts = json.loads(DefinitionFile(self.filename, self.text).parse())
        self.version: int = _DEFAULT_VERSION if data["version"] is None else data["version"]
        self.include: list[str] = data["includes"]
        self.enum = [_build.enum(one, self.filename) for one in data["enums"]]
        self.message = [
            _build.message(one, layout, self)
            for one, layout in zip(data["messages"], layouts, strict=True)
            if one["id"] <= _MAX_V1_MESSAGE_ID or self.command_24bit
        ]

    def _index_messages(self) -> None:
        self.message_lengths = {m.id: m.wire_length for m in self.message}
        self.message_min_lengths = {m.id: m.wire_min_length for m in self.message}
        self.message_flags = {m.id: m.message_flags for m in self.message}
        self.message_target_system_ofs = {m.id: m.target_system_ofs for m in self.message}
        self.message_target_component_ofs = {m.id: m.target_component_ofs for m in self.message}
        self.message_crcs = {m.id: m.crc_extra for m in self.message}
        self.message_names = {m.id: m.name for m in self.message}
        self.largest_payload = max((m.wire_length for m in self.message), default=0)


def base_name(filename: str) -> str:
    """A definition file's name without folder and suffix: the name of its dialect."""
    return os.path.splitext(os.path.basename(filename))[0]


def message_checksum(msg: MAVType) -> int:
    """``crc_extra``: names and types of the base fields in wire order, folded to 8 bits."""
    base = msg.ordered_fields[: msg.base_fields()]
    return crc_extra(msg.name, [(field.type, field.name, field.array_length) for field in base])


def merge_enums(xml: list[MAVXML]) -> None:
    """Put the entries of equally named enums into the first one, sort by value and add
    ``<NAME>_ENUM_END``.
    """
    parts: dict[str, list[MAVEnum]] = {}
    for file in xml:
        for enum in file.enum:
            if enum.name in parts:
                print(f"Merged enum {enum.name}")
            parts.setdefault(enum.name, []).append(enum)
        file.enum = [enum for enum in file.enum if parts[enum.name][0] is enum]
    for enum, *others in parts.values():
        for other in others:
            _move_behind(enum, other)
            enum.entry.extend(other.entry)
            enum.description = enum.description or other.description
        enum.entry.sort(key=lambda entry: entry.value)
        end = enum.entry[-1].value + 1 if enum.entry else 0
        enum.entry.append(MAVEnumEntry(enum.name + "_ENUM_END", end, end_marker=True))


def _move_behind(enum: MAVEnum, included: MAVEnum) -> None:
    """Number entries without a value behind those of an included file."""
    if enum.start_value is None or included.start_value is None:
        return
    automatic = [entry for entry in enum.entry if entry.autovalue]
    own = (enum.start_value, enum.highest_value)
    other = (included.start_value, included.highest_value)
    values = number_behind([entry.value for entry in automatic], own, other)
    for entry, value in zip(automatic, values, strict=True):
        entry.value = value


def check_duplicates(xml: list[MAVXML]) -> bool:
    """Whether an id, a message name, a field name or an enum entry occurs twice; says so on stdout.

    Merges the enums first, because an entry may also be repeated in another file.
    """
    merge_enums(xml)
    problem = next(_duplicates(xml), None)
    if problem is not None:
        print(f"ERROR: Duplicate {problem}")
    return problem is not None


def _duplicates(xml: list[MAVXML]) -> Iterator[str]:
    ids: dict[int, tuple[str, str]] = {}
    names: dict[str, int] = {}
    for file in xml:
        for m in file.message:
            where = f"{file.filename}:{m.linenumber}"
            if m.id in ids:
                name, used = ids[m.id]
                yield f"message id {m.id} for {m.name} ({where}) also used by {name} ({used})"
            for i, field in enumerate(m.fieldnames):
                if field in m.fieldnames[:i]:
                    yield f"field {field} in message {m.name} ({where})"
            if m.name in names:
                other = names[m.name]
                used = f"also used by {other} ({ids[other][1]})"
                yield f"message name {m.name} for id:{m.id} ({where}) {used}"
            ids[m.id] = (m.name, where)
            names[m.name] = m.id
        for enum in file.enum:
            yield from _repeated_entries(enum)


def _repeated_entries(enum: MAVEnum) -> Iterator[str]:
    """Entries whose name or value occurred before; also notes each value the file does not give."""
    names: dict[str, MAVEnumEntry] = {}
    values: dict[int, MAVEnumEntry] = {}
    for entry in enum.entry:
        if entry.autovalue:
            print(f"Note: An enum value was auto-generated: {entry.name} = {entry.value}")
        same_name = names.setdefault(entry.name, entry)
        same_value = values.setdefault(entry.value, entry)
        for kind, same in (("names", same_name), ("values", same_value)):
            if same is not entry:
                lines = (
                    f"\n\t{enum.name}.{one.name} = {one.value} @ {one.origin_file}:{one.origin_line}"
                    for one in (entry, same)
                )
                yield f"enum {kind}:{''.join(lines)}"


def check_missing_enum(xml: list[MAVXML]) -> bool:
    """Whether a field names an enum that no file has; says so on stdout."""
    return missing_enum(xml, set())


def missing_enum(xml: list[MAVXML], known: set[str]) -> bool:
    """Whether a field names an enum that neither a file nor ``known`` has; says so on stdout."""
    known = known | {enum.name for file in xml for enum in file.enum}
    for file in xml:
        for message in file.message:
            for field in message.fields:
                if field.enum and field.enum not in known:
                    print(f"Enum {field.enum} in {message.name}.{field.name} does not exist")
                    return True
    return False


def total_msgs(xml: list[MAVXML]) -> int:
    """Number of messages in all files."""
    return sum(len(file.message) for file in xml)


def mkdir_p(dir: str) -> None:
    """Make a folder and those above it; one that exists is fine."""
    if dir:
        os.makedirs(dir, exist_ok=True)
