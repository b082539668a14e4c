"""From the elements of a definition file to messages and enums. Errors carry ``file:line`` of the
element.
"""

from __future__ import annotations

from typing import Protocol

from mavwire.generator._enum_value import enum_value
from mavwire.generator._errors import MAVParseError
from mavwire.generator._model import (
    MAVDeprecated,
    MAVEnum,
    MAVEnumEntry,
    MAVEnumParam,
    MAVField,
    MAVType,
)
from mavwire.generator._xml_reader import Element

COMMAND_ENUM = "MAV_CMD"
COMMAND_PARAMS = 7
MAX_FIELDS = 64
MAX_MESSAGE_ID = 0xFFFFFF
_MAX_V1_MESSAGE_ID = 0xFF
_RESERVED_PARAM = "True"


class _Target(Protocol):
    """The part of ``MAVXML`` needed here."""

    filename: str
    version: int
    command_24bit: bool
    allow_extensions: bool


def read_messages(root: Element, xml: _Target) -> list[MAVType]:
    """The messages of a file that exist in its wire protocol."""
    messages = []
    for group in root.all("messages"):
        for element in group.all("message"):
            message = _message(element, xml)
            if message.id <= _MAX_V1_MESSAGE_ID or xml.command_24bit:
                messages.append(message)
    return messages


def read_enums(root: Element, filename: str) -> list[MAVEnum]:
    """The enums of a file, as written and in order."""
    return [
        _enum(element, filename) for group in root.all("enums") for element in group.all("enum")
    ]


def _message(element: Element, xml: _Target) -> MAVType:
    identifier = _attribute(element, "id", xml.filename)
    name = _attribute(element, "name", xml.filename)
    if not (identifier.isascii() and identifier.strip().isdigit()):
        raise _error(element, xml.filename, f"message {name}: id '{identifier}' is not a number")
    if len(identifier) > 20 or int(identifier) > MAX_MESSAGE_ID:
        raise _error(
            element, xml.filename, f"message {name}: id {identifier} is above {MAX_MESSAGE_ID}"
        )
    message = MAVType(name, identifier, element.line, _description(element), _is_wip(element))
    message.deprecated = _deprecated(element, xml.filename)
    for child in element.children:
        if child.tag == "extensions":
            message.extensions_start = len(message.fields)
        elif child.tag == "field":
            field = _field(child, name, xml)
            if message.extensions_start is None or xml.allow_extensions:
                message.fields.append(field)
    if len(message.fields) > MAX_FIELDS:
        raise _error(
            element,
            xml.filename,
            f"num_fields={len(message.fields)} : "
            f"Maximum number of field names allowed is {MAX_FIELDS}",
        )
    return message


def _field(element: Element, message: str, xml: _Target) -> MAVField:
    field_type = _attribute(element, "type", xml.filename)
    name = _attribute(element, "name", xml.filename)
    attributes = element.attributes
    units = attributes.get("units", "")
    try:
        return MAVField(
            name,
            field_type,
            attributes.get("print_format"),
            xml,
            description=element.text,
            enum=attributes.get("enum", ""),
            display=attributes.get("display", ""),
            units=f"[{units}]" if units else "",
            multiplier=attributes.get("multiplier", ""),
            instance=attributes.get("instance", False),
            invalid=attributes.get("invalid", ""),
        )
    except MAVParseError as error:
        raise _error(element, xml.filename, f"{error}: message {message}, field {name}") from None


def _enum(element: Element, filename: str) -> MAVEnum:
    enum = MAVEnum(
        _attribute(element, "name", filename),
        element.line,
        _description(element),
        element.attributes.get("bitmask") == "true",
    )
    enum.deprecated = _deprecated(element, filename)
    for child in element.all("entry"):
        _add_entry(enum, child, filename)
    return enum


def _add_entry(enum: MAVEnum, element: Element, filename: str) -> None:
    name = _attribute(element, "name", filename)
    written = element.attributes.get("value")
    try:
        value = enum.highest_value + 1 if written is None else enum_value(written)
    except MAVParseError as error:
        raise _error(element, filename, f"enum {enum.name}, entry {name}: {error}") from None
    if enum.bitmask and abs(value).bit_count() != 1:
        print(f"{name} has invalid values (bitmask must have powers of 2)")
    entry = MAVEnumEntry(
        name,
        value,
        _description(element),
        _is_wip(element),
        autovalue=written is None,
        origin_file=filename,
        origin_line=element.line,
        has_location=_has_location(element, filename),
    )
    entry.deprecated = _deprecated(element, filename)
    entry.param = _params(element, filename, complete=COMMAND_ENUM in enum.name)
    enum.entry.append(entry)
    enum.start_value = value if enum.start_value is None else min(value, enum.start_value)
    enum.highest_value = max(value, enum.highest_value)


def _params(entry: Element, filename: str, *, complete: bool) -> list[MAVEnumParam]:
    """The parameters as written; a command's by index, with reserved ones in the gaps."""
    params = [_param(element, filename) for element in entry.all("param")]
    if not complete:
        return params
    by_index = {int(param.index): param for param in params}
    for index in range(1, COMMAND_PARAMS + 1):
        by_index.setdefault(index, MAVEnumParam(index, reserved=_RESERVED_PARAM))
    return [by_index[index] for index in sorted(by_index)]


def _param(element: Element, filename: str) -> MAVEnumParam:
    index = element.attributes.get("index")
    if index is None:
        raise _missing(element, filename, 'enum param "index"')
    if not (index.isascii() and index.isdigit() and len(index) <= 3):
        raise _error(element, filename, f"param index '{index[:40]}' is not a small number")
    get = element.attributes.get
    return MAVEnumParam(
        index,
        element.text,
        label=get("label", ""),
        units=get("units", ""),
        enum=get("enum", ""),
        increment=get("increment", ""),
        minValue=get("minValue", ""),
        maxValue=get("maxValue", ""),
        reserved=get("reserved", False),
        default=get("default", "0"),
        multiplier=get("multiplier", ""),
    )


def _has_location(element: Element, filename: str) -> bool:
    written = element.attributes.get("hasLocation", "false")
    if written not in ("true", "false"):
        raise _error(element, filename, f"invalid has_location value {written}")
    return written == "true"


def _description(element: Element) -> str:
    return "".join(child.text for child in element.all("description"))


def _is_wip(element: Element) -> bool:
    return element.first("wip") is not None


def _deprecated(element: Element, filename: str) -> MAVDeprecated | None:
    mark = element.first("deprecated")
    if mark is None:
        return None
    since = _attribute(mark, "since", filename)
    return MAVDeprecated(since, _attribute(mark, "replaced_by", filename), mark.text)


def _attribute(element: Element, name: str, filename: str) -> str:
    value = element.attributes.get(name)
    if value is None:
        what = "enum entry" if element.tag == "entry" else element.tag
        raise _missing(element, filename, f'{what} "{name}"')
    return value


def _missing(element: Element, filename: str, what: str) -> MAVParseError:
    return _error(element, filename, f"expected missing {what} attribute")


def _error(element: Element, filename: str, reason: str) -> MAVParseError:
    return MAVParseError(f"{reason} at {filename}:{element.line}")
