"""Messages, fields and enums as ``mavparse`` hands them out: objects with plain attributes."""

from __future__ import annotations

from dataclasses import InitVar, dataclass, field
from typing import Protocol

from mavwire._native import FIELD_TYPES, field_type
from mavwire.generator._errors import parse_errors

_INTEGER_TEST_VALUES = {1: (5, 67, 0xFF), 2: (17235, 52, None), 4: (963497464, 52, None)}
_INTEGER_TEST_VALUES[8] = (93372036854775807, 63, None)


class _HasVersion(Protocol):
    version: int


@dataclass(eq=False, repr=False)
class MAVDeprecated:
    """That a message, enum or entry should no longer be used: since when, and what replaces it."""

    since: str
    replaced_by: str
    explanation: str = ""


@dataclass(eq=False, repr=False)
class MAVField:
    """A field of a message. Lengths and offsets in bytes; ``array_length`` is 0 for a scalar."""

    name: str
    type: str
    print_format: str | None
    xml: InitVar[_HasVersion]
    description: str = ""
    enum: str = ""
    display: str = ""
    units: str = ""
    multiplier: str = ""
    instance: str | bool = False
    invalid: str = ""

    wire_offset: int = field(init=False)
    test_value: object = field(init=False)

    def __post_init__(self, xml: _HasVersion) -> None:
        self.name_upper = self.name.upper()
        self.omit_arg = self.type == "uint8_t_mavlink_version"
        self.const_value: int | None = xml.version if self.omit_arg else None
        with parse_errors():
            self.type, self.array_length, self.type_length, _ = field_type(self.type)
        self.type_upper = self.type.upper()
        self.wire_length = self.type_length * max(1, self.array_length)

    def gen_test_value(self, i: int) -> object:
        """A value that fits the type and differs between fields; ``i`` is an array's element."""
        if self.const_value is not None:
            return self.const_value
        if self.type == "char":
            return chr(ord("A") + (self.wire_offset + i) % 26)
        if FIELD_TYPES[self.type]:
            return (17.0 if self.type == "float" else 123.0) + self.wire_offset * 7 + i
        start, step, mask = _INTEGER_TEST_VALUES[self.type_length]
        value = start + self.wire_offset * step + i
        return value & mask if mask else value

    def set_test_value(self) -> None:
        """Fill ``test_value``: a scalar, a list, or text one shorter than a ``char`` array."""
        if self.array_length == 0:
            self.test_value = self.gen_test_value(0)
        elif self.type == "char":
            text = [str(self.gen_test_value(i)) for i in range(self.array_length - 1)]
            self.test_value = "".join(text)
        else:
            self.test_value = [self.gen_test_value(i) for i in range(self.array_length)]


@dataclass(eq=False, repr=False)
class MAVType:
    """A message. :class:`~mavwire.generator.mavparse.MAVXML` adds the wire layout's attributes."""

    name: str
    id: int
    linenumber: int
    description: str = ""
    wip: bool = False

    fieldlengths: list[int] = field(init=False)
    fieldtypes: list[str] = field(init=False)
    field_offsets: dict[str, int] = field(init=False)
    ordered_fields: list[MAVField] = field(init=False)
    ordered_fieldnames: list[str] = field(init=False)
    ordered_fieldtypes: list[str] = field(init=False)
    wire_length: int = field(init=False)
    wire_min_length: int = field(init=False)
    num_fields: int = field(init=False)
    crc_extra: int = field(init=False)
    message_flags: int = field(init=False)
    target_system_ofs: int = field(init=False)
    target_component_ofs: int = field(init=False)

    def __post_init__(self) -> None:
        self.name_lower = self.name.lower()
        self.id = int(self.id)
        self.deprecated: MAVDeprecated | None = None
        self.fields: list[MAVField] = []
        self.fieldnames: list[str] = []
        self.extensions_start: int | None = None
        self.needs_pack = False

    def base_fields(self) -> int:
        """Number of fields that are not extension fields."""
        return len(self.fields) if self.extensions_start is None else self.extensions_start


@dataclass(eq=False, repr=False)
class MAVEnumParam:
    """A parameter of a command; everything is text as written in the file."""

    index: int | str
    description: str = ""
    label: str = ""
    units: str = ""
    enum: str = ""
    increment: str = ""
    minValue: str = ""
    maxValue: str = ""
    reserved: str | bool = False
    default: str = ""
    multiplier: str = ""

    def __post_init__(self) -> None:
        self.default = self.default or ("0" if self.reserved else "")
        self.set_description(self.description)

    def set_description(self, description: str) -> None:
        """Set the text; an empty text of a reserved parameter says so and names its default."""
        if not description and self.reserved:
            description = f"Reserved (default:{self.default})"
        self.description = description


@dataclass(eq=False, repr=False)
class MAVEnumEntry:
    """A named value of an enum; commands have seven :class:`MAVEnumParam`."""

    name: str
    value: int
    description: str = ""
    wip: bool = False
    end_marker: bool = False
    autovalue: bool = False
    origin_file: str = ""
    origin_line: int = 0
    has_location: bool = False

    def __post_init__(self) -> None:
        self.deprecated: MAVDeprecated | None = None
        self.param: list[MAVEnumParam] = []


@dataclass(eq=False, repr=False)
class MAVEnum:
    """An enum of one file, or of all files after ``merge_enums``."""

    name: str
    linenumber: int
    description: str = ""
    bitmask: bool = False

    def __post_init__(self) -> None:
        self.deprecated: MAVDeprecated | None = None
        self.entry: list[MAVEnumEntry] = []
        self.start_value: int | None = None
        self.highest_value = 0
