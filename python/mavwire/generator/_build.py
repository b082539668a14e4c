"""From what the native reader gives of a file to the objects of ``mavparse``."""

from __future__ import annotations

from typing import Any, Protocol

from mavwire.generator._model import (
    MAVDeprecated,
    MAVEnum,
    MAVEnumEntry,
    MAVEnumParam,
    MAVField,
    MAVType,
)

COMMAND_ENUM = "MAV_CMD"
COMMAND_PARAMS = 7
FLAG_HAVE_TARGET_SYSTEM = 1
FLAG_HAVE_TARGET_COMPONENT = 2
_TARGET_EXCEPTION = ("MANUAL_CONTROL", "target")
"""The one message whose target system goes by another name."""

_Data = dict[str, Any]


class _Target(Protocol):
    """The part of ``MAVXML`` needed here."""

    filename: str
    version: int
    allow_extensions: bool


def message(data: _Data, layout: _Data, xml: _Target) -> MAVType:
    """A message with its wire attributes."""
    result = MAVType(
        data["name"], data["id"], data["line"], data["description"], data["status"]["wip"]
    )
    result.deprecated = _deprecated(data)
    fields = data["fields"]
    result.extensions_start = next((i for i, f in enumerate(fields) if f["is_extension"]), None)
    if not xml.allow_extensions:
        fields = fields[: result.extensions_start]
    result.fields = [_field(field, xml) for field in fields]
    for field, offset in zip(result.fields, layout["offsets"], strict=False):
        field.wire_offset = offset
        field.set_test_value()
    # Extension fields are the last ones in wire order too.
    _lay_out(result, [result.fields[i] for i in layout["order"][: len(fields)]])
    result.crc_extra = layout["crc_extra"]
    return result


def _lay_out(message: MAVType, ordered: list[MAVField]) -> None:
    message.ordered_fields = ordered
    message.num_fields = len(ordered)
    message.fieldnames = [field.name for field in message.fields]
    message.fieldtypes = [field.type for field in message.fields]
    # Text counts as one value.
    message.fieldlengths = [
        1 if field.type == "char" else max(1, field.array_length) for field in message.fields
    ]
    message.ordered_fieldnames = [field.name for field in ordered]
    message.ordered_fieldtypes = [field.type for field in ordered]
    message.field_offsets = {field.name: field.wire_offset for field in ordered}
    message.needs_pack = any(field.wire_offset % field.type_length for field in ordered)
    message.wire_length = sum(field.wire_length for field in ordered)
    message.wire_min_length = sum(
        field.wire_length for field in message.fields[: message.base_fields()]
    )
    message.message_flags = message.target_system_ofs = message.target_component_ofs = 0
    for field in ordered:
        if field.name == "target_system" or (message.name, field.name) == _TARGET_EXCEPTION:
            message.message_flags |= FLAG_HAVE_TARGET_SYSTEM
            message.target_system_ofs = field.wire_offset
        elif field.name == "target_component":
            message.message_flags |= FLAG_HAVE_TARGET_COMPONENT
            message.target_component_ofs = field.wire_offset


def _field(data: _Data, xml: _Target) -> MAVField:
    written = data["field_type"]
    if data["is_mavlink_version"]:
        written = "uint8_t_mavlink_version"
    elif data["array_length"]:
        written += f"[{data['array_length']}]"
    return MAVField(
        data["name"],
        written,
        data["print_format"],
        xml,
        description=data["description"],
        enum=data["enum_name"] or "",
        display=data["display"] or "",
        units=f"[{data['units']}]" if data["units"] else "",
        multiplier=data["multiplier"] or "",
        instance="true" if data["is_instance"] else False,
        invalid=data["invalid"] or "",
    )


def enum(data: _Data, filename: str) -> MAVEnum:
    """An enum of one file."""
    result = MAVEnum(data["name"], data["line"], data["description"], data["bitmask"])
    result.deprecated = _deprecated(data)
    for entry in data["entries"]:
        _add_entry(result, entry, filename)
    return result


def _add_entry(enum: MAVEnum, data: _Data, filename: str) -> None:
    value = data["value"]
    if enum.bitmask and abs(value).bit_count() != 1:
        print(f"{data['name']} has invalid values (bitmask must have powers of 2)")
    entry = MAVEnumEntry(
        data["name"],
        value,
        data["description"],
        data["status"]["wip"],
        autovalue=data["is_automatic"],
        origin_file=filename,
        origin_line=data["line"],
        has_location=data["has_location"],
    )
    entry.deprecated = _deprecated(data)
    entry.param = [_param(param) for param in data["params"]]
    if COMMAND_ENUM in enum.name:
        by_index = {int(param.index): param for param in entry.param}
        for index in range(1, COMMAND_PARAMS + 1):
            by_index.setdefault(index, MAVEnumParam(index, reserved="True"))
        entry.param = [by_index[index] for index in sorted(by_index)]
    enum.entry.append(entry)
    enum.start_value = value if enum.start_value is None else min(value, enum.start_value)
    enum.highest_value = max(value, enum.highest_value)


def _param(data: _Data) -> MAVEnumParam:
    return MAVEnumParam(
        str(data["index"]),
        data["description"],
        label=data["label"] or "",
        units=data["units"] or "",
        enum=data["enum_name"] or "",
        increment=data["increment"] or "",
        minValue=data["min_value"] or "",
        maxValue=data["max_value"] or "",
        reserved="true" if data["reserved"] else False,
        default=data["default"] or "0",
        multiplier=data["multiplier"] or "",
    )


def _deprecated(data: _Data) -> MAVDeprecated | None:
    mark = data["status"]["deprecated"]
    return mark and MAVDeprecated(mark["since"], mark["replaced_by"], mark["explanation"])
