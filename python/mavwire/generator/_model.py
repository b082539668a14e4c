"""Messages, fields and enums as ``mavparse`` hands them out: objects with plain attributes."""

from __future__ import annotations

from typing import Protocol

from mavwire._native import field_type
from mavwire.generator._errors import parse_errors

_INTEGER_TEST_VALUES = {1: (5, 67, 0xFF), 2: (17235, 52, None), 4: (963497464, 52, None)}
_INTEGER_TEST_VALUES[8] = (93372036854775807, 63, None)


class _HasVersion(Protocol):
    version: int


class MAVDeprecated:
    """That a message, enum or entry should no longer be used: since when, and what replaces it."""

    def __init__(self, since: str, replaced_by: str, explanation: str = "") -> None:
        self.since = since
        self.replaced_by = replaced_by
        self.explanation = explanation


class MAVField:
    """A field of a message. Lengths and offsets in bytes; ``array_length`` is 0 for a scalar."""

    wire_offset: int
    test_value: object

    def __init__(
        self,
        name: str,
        type: str,
        print_format: str | None,
        xml: _HasVersion,
        description: str = "",
        enum: str = "",
        display: str = "",
        units: str = "",
        multiplier: str = "",
        instance: str | bool = False,
        invalid: str = "",
    ) -> None:
        self.name = name
        self.name_upper = name.upper()
        self.description = description
        self.enum = enum
        self.display = display
        self.units = units
        self.multiplier = multiplier
        self.print_format = print_format
        self.instance = instance
        self.invalid = invalid
        self.omit_arg = type == "uint8_t_mavlink_version"
        self.const_value: int | None = xml.version if self.omit_arg else None
        with parse_errors():
            self.type, self.array_length, self.type_length, _ = field_type(type)
        self.type_upper = self.type.upper()
        self.wire_length = self.type_length * max(1, self.array_length)

    def gen_test_value(self, i: int) -> object:
        """A value that fits the type and differs between fields; ``i`` is an array's element."""
        if self.const_value is not None:
            return self.const_value
        if self.type == "char":
            return chr(ord("A") + (self.wire_offset + i) % 26)
        if self.type in ("float", "double"):
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


class MAVType:
    """A message. :class:`~mavwire.generator.mavparse.MAVXML` adds the wire layout's attributes."""

    fieldlengths: list[int]
    fieldtypes: list[str]
    field_offsets: dict[str, int]
    ordered_fields: list[MAVField]
    ordered_fieldnames: list[str]
    ordered_fieldtypes: list[str]
    wire_length: int
    wire_min_length: int
    num_fields: int
    crc_extra: int
    message_flags: int
    target_system_ofs: int
    target_component_ofs: int

    def __init__(
        self,
        name: str,
        id: int | str,
        linenumber: int,
        description: str = "",
        wip: bool = False,
    ) -> None:
        self.name = name
        self.name_lower = name.lower()
        self.linenumber = linenumber
        self.id = int(id)
        self.description = description
        self.wip = wip
        self.deprecated: MAVDeprecated | None = None
        self.fields: list[MAVField] = []
        self.fieldnames: list[str] = []
        self.extensions_start: int | None = None
        self.needs_pack = False

    def base_fields(self) -> int:
        """Number of fields that are not extension fields."""
        return len(self.fields) if self.extensions_start is None else self.extensions_start


class MAVEnumParam:
    """A parameter of a command; everything is text as written in the file."""

    def __init__(
        self,
        index: int | str,
        description: str = "",
        label: str = "",
        units: str = "",
        enum: str = "",
        increment: str = "",
        minValue: str = "",
        maxValue: str = "",
        reserved: str | bool = False,
        default: str = "",
        multiplier: str = "",
    ) -> None:
        self.index = index
        self.label = label
        self.units = units
        self.enum = enum
        self.increment = increment
        self.minValue = minValue
        self.maxValue = maxValue
        self.reserved = reserved
        self.default = default or ("0" if reserved else "")
        self.multiplier = multiplier
        self.description = ""
        self.set_description(description)

    def set_description(self, description: str) -> None:
        """Set the text; an empty text of a reserved parameter says so and names its default."""
        if not description and self.reserved:
            description = f"Reserved (default:{self.default})"
        self.description = description


class MAVEnumEntry:
    """A named value of an enum; commands have seven :class:`MAVEnumParam`."""

    def __init__(
        self,
        name: str,
        value: int,
        description: str = "",
        wip: bool = False,
        end_marker: bool = False,
        autovalue: bool = False,
        origin_file: str = "",
        origin_line: int = 0,
        has_location: bool = False,
    ) -> None:
        self.name = name
        self.value = value
        self.deprecated: MAVDeprecated | None = None
        self.description = description
        self.wip = wip
        self.param: list[MAVEnumParam] = []
        self.end_marker = end_marker
        self.autovalue = autovalue
        self.origin_file = origin_file
        self.origin_line = origin_line
        self.has_location = has_location


class MAVEnum:
    """An enum of one file, or of all files after ``merge_enums``."""

    def __init__(
        self, name: str, linenumber: int, description: str = "", bitmask: bool = False
    ) -> None:
        self.name = name
        self.deprecated: MAVDeprecated | None = None
        self.description = description
        self.entry: list[MAVEnumEntry] = []
        self.start_value: int | None = None
        self.highest_value = 0
        self.linenumber = linenumber
        self.bitmask = bitmask
