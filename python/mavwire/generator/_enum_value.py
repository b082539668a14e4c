"""The number an enum entry's ``value`` stands for. Text from a file is matched, never evaluated."""

from __future__ import annotations

import re

from mavwire.generator._errors import MAVParseError

_NUMBER = r"(?:0[xX][0-9a-fA-F]{1,16}|0[bB][01]{1,64}|[0-9]{1,20})"
_VALUE = re.compile(rf"\s*(-?)\s*({_NUMBER})\s*(?:(\*\*|<<)\s*([0-9]{{1,2}})\s*)?", re.ASCII)
_LOWEST, _HIGHEST = -(1 << 63), (1 << 64) - 1


def enum_value(text: str) -> int:
    """``7``, ``0x1F``, ``0b101``, ``2**4`` or ``1<<4``, between -2^63 and 2^64 - 1."""
    match = _VALUE.fullmatch(text)
    if match is None:
        raise MAVParseError(
            f"value '{text[:40]}' is not a number: write it as 10, 0x0A, 0b1010, 2**3 or 1<<3"
        )
    sign, number, operator, exponent = match.groups()
    value = _number(number)
    if operator == "**":
        value **= int(exponent)
    elif operator == "<<":
        value <<= int(exponent)
    if sign:
        value = -value
    if not _LOWEST <= value <= _HIGHEST:
        raise MAVParseError(f"value '{text[:40]}' does not fit into 64 bits")
    return value


def _number(text: str) -> int:
    return int(text) if text.isdigit() else int(text, 0)
