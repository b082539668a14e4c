"""When the bits of a field changed (mavbitmask_change.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from typing import Any

from mavwire.cli._errors import CommandError
from mavwire.cli._reading import definitions, reading
from mavwire.cli._telemetry import require_telemetry
from mavwire.links.inspect_message import local_stamp


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="telemetry log")
    parser.add_argument(
        "fields", metavar="MSG.FIELD", nargs="+", help="such as HEARTBEAT.base_mode"
    )


def main(args: Namespace) -> int:
    return show_changes("bitmask_change", args.log, args.fields)


def show_changes(command: str, path: str, specifiers: Iterable[str]) -> int:
    """Print the changes of fields, which are given as MSG.FIELD, in a log."""
    with definitions(), reading(command, path) as log:
        require_telemetry(log)
        fields = [Field(one) for one in specifiers]
        for msg in log.messages({one.message for one in fields}):
            for field in fields:
                if field.message == msg.get_type() and (changes := field.changes(msg)):
                    print(f"{local_stamp(msg._timestamp)}: {field} {' '.join(changes)}")
    return 0


class Field:
    """A field whose value is a set of bits, and the value it had last; 0 before the first."""

    def __init__(self, specifier: str) -> None:
        self.message, _, self.name = specifier.partition(".")
        if not self.name or "." in self.name:
            raise CommandError(
                f"invalid MSG.Field specifier '{specifier}' - expected format: MSG.Field"
            )
        self.message, self._names = _bit_names(self.message, self.name)
        self._last = 0

    def __str__(self) -> str:
        return f"{self.message}.{self.name}"

    def changes(self, msg: Any) -> list[str]:
        """The changes by a message: `+NAME` for each bit that is set now, `-NAME` for the others."""
        value = getattr(msg, self.name)
        changed, self._last = value ^ self._last, value
        bits = [1 << place for place in range(changed.bit_length()) if changed >> place & 1]
        bits.sort(key=lambda bit: bit not in self._names)
        return [f"{'+' if value & bit else '-'}{self._name(bit)}" for bit in bits]

    def _name(self, bit: int) -> str:
        return self._names.get(bit) or f"UNKNOWN_BIT{bit.bit_length() - 1}"


def _bit_names(message: str, field: str) -> tuple[str, dict[int, str]]:
    """The message's own name, which may be given in other letters, and bit -> name, without what the
    names of the enum have in common.
    """
    from mavwire import mavutil

    cls = getattr(mavutil.mavlink, f"MAVLink_{message.lower()}_message", None)
    if cls is None:
        raise CommandError(f"unknown MAVLink message type '{message}'")
    enum = cls.fieldenums_by_name.get(field)
    if enum is None:
        raise CommandError(f"field '{message}.{field}' has no bitmask enum in MAVLink dialect")
    names = {
        value: one.name.split("_")
        for value, one in mavutil.mavlink.enums[enum].items()
        if not one.name.endswith("_ENUM_END")
    }
    common = 0
    for words in zip(*(name[:-1] for name in names.values()), strict=False):
        if len(set(words)) > 1:
            break
        common += 1
    bits = {bit: "_".join(name[common:]) for bit, name in names.items() if bit & (bit - 1) == 0}
    return cls.msgname, bits
