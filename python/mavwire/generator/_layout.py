"""Where a message's fields stand on the wire, and the checksum seed that proves both ends agree on
it.
"""

from __future__ import annotations

from mavwire.generator._model import MAVField, MAVType
from mavwire.generator.mavcrc import x25crc

FLAG_HAVE_TARGET_SYSTEM = 1
FLAG_HAVE_TARGET_COMPONENT = 2
_TARGET_EXCEPTION = ("MANUAL_CONTROL", "target")
"""The one message whose target system goes by another name."""


def lay_out(message: MAVType) -> None:
    """Fill the wire attributes of a message from its fields."""
    base = message.fields[: message.base_fields()]
    extensions = message.fields[message.base_fields() :]
    ordered = sorted(base, key=lambda field: -field.type_length) + extensions
    message.ordered_fields = ordered
    message.num_fields = len(ordered)
    message.fieldnames = [field.name for field in message.fields]
    message.fieldtypes = [field.type for field in message.fields]
    message.fieldlengths = [_elements(field) for field in message.fields]
    message.ordered_fieldnames = [field.name for field in ordered]
    message.ordered_fieldtypes = [field.type for field in ordered]
    _place(message, ordered)
    message.wire_min_length = sum(field.wire_length for field in base)
    message.crc_extra = message_checksum(message)


def _elements(field: MAVField) -> int:
    """Values of a field; text counts as one."""
    return 1 if field.type == "char" else max(1, field.array_length)


def _place(message: MAVType, ordered: list[MAVField]) -> None:
    offset = 0
    message.field_offsets = {}
    message.message_flags = message.target_system_ofs = message.target_component_ofs = 0
    for field in ordered:
        field.wire_offset = offset
        field.set_test_value()
        message.field_offsets[field.name] = offset
        if field.name == "target_system" or (message.name, field.name) == _TARGET_EXCEPTION:
            message.message_flags |= FLAG_HAVE_TARGET_SYSTEM
            message.target_system_ofs = offset
        elif field.name == "target_component":
            message.message_flags |= FLAG_HAVE_TARGET_COMPONENT
            message.target_component_ofs = offset
        if offset % field.type_length:
            message.needs_pack = True
        offset += field.wire_length
    message.wire_length = offset


def message_checksum(msg: MAVType) -> int:
    """``crc_extra``: names and types of the base fields in wire order, folded to 8 bits."""
    crc = x25crc()
    crc.accumulate(msg.name + " ")
    for field in msg.ordered_fields[: msg.base_fields()]:
        crc.accumulate(f"{field.type} {field.name} ")
        if field.array_length:
            crc.accumulate(bytes([field.array_length]))
    return (crc.crc & 0xFF) ^ (crc.crc >> 8)
