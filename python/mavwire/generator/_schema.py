"""What a definition file may contain: elements, their order, their attributes.

mavgen checks this before it generates, because a misspelt attribute is otherwise silently without
effect. The rules are data, one table; the facts in it are those of the MAVLink XML schema.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TypeAlias

_MANY = 1 << 30


@dataclass(frozen=True, slots=True)
class Rule:
    """The text an attribute may have, and how to say it."""

    pattern: re.Pattern[str]
    wording: str


Attributes: TypeAlias = dict[str, Rule]


@dataclass(frozen=True, slots=True)
class Group:
    """A run of children at one place among the children of an element."""

    tags: tuple[str, ...]
    least: int = 0
    most: int = 1


@dataclass(frozen=True, slots=True)
class Shape:
    """Attributes and children of an element; children are checked in order."""

    required: Attributes = field(default_factory=dict)
    optional: Attributes = field(default_factory=dict)
    children: tuple[Group, ...] = ()
    content: Rule | None = None


def _rule(pattern: str, wording: str) -> Rule:
    return Rule(re.compile(pattern, re.ASCII | re.DOTALL), wording)


_NUMBER = r"[0-9]{1,20}|0[xX][0-9a-fA-F]{1,16}|0[bB][01]{1,64}|2\*\*[0-9]{1,2}"
_BYTE = r"0*(?:[0-9]{1,2}|1[0-9]{2}|2[0-4][0-9]|25[0-5])"

ANY = _rule(r".*", "any text")
NAME = Rule(re.compile(r"\w+"), "a name of letters, digits and underscores")
BOOLEAN = _rule(r"\s*(?:true|false|0|1)\s*", "true or false")
BYTE = _rule(rf"\s*{_BYTE}\s*", "a number from 0 to 255")
FLOAT = _rule(
    r"\s*(?:[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|NaN|-?INF)\s*", "a number"
)
VALUE = _rule(rf"(?:{_NUMBER})", "a number such as 10, 0x0A, 0b1010 or 2**3")
SIGNED_VALUE = _rule(rf"-?(?:{_NUMBER})|1<<[0-9]{{1,2}}", VALUE.wording)
DEFAULT = _rule(rf"-?(?:{_NUMBER}|[0-9]+\.[0-9]+|NaN)", "a number or NaN")
SINCE = _rule(r"20[0-9]{2}-(?:0[1-9]|1[012])", "a month such as 2024-01")
MESSAGE_ID = _rule(r"\s*0*[0-9]{1,8}\s*", "a number from 0 to 16777215")
FIELD_TYPE = _rule(
    r"uint8_t_mavlink_version|(?:float|double|char|u?int(?:8|16|32|64)_t)(?:\[[0-9]+\])?",
    "a type such as uint8_t or float[4]",
)
MULTIPLIER = _rule(r"1E-2|2E-3|360/255", "1E-2, 2E-3 or 360/255")

UNITS = frozenset(
    # time, frequency
    "s ds cs ms us ns Hz MHz "
    # distance, area, speed, acceleration
    "km dam m m^2 m/s m/s/s m/s*5 dm dm/s cm cm^2 cm/s mm mm/s mm/h "
    # temperature, angle, rotation
    "K degC cdegC rad rad/s mrad/s deg deg/2 ddeg/s deg/s cdeg cdeg/s degE5 degE7 rpm "
    # electricity, magnetism, energy, power, force, mass, pressure
    "V cV mV A cA mA mAh Ah mT gauss mgauss hJ W mG g kg Pa hPa kPa mbar "
    # ratio, data, flow, volume
    "% d% c% dB dBm KiB KiB/s MiB MiB/s bytes bytes/s bits/s pix dpix g/min cm^3/min L/h "
    "cm^3 l L".split()
)
STRICT_UNITS = Rule(
    re.compile("|".join(re.escape(unit) for unit in sorted(UNITS))), "a unit of the MAVLink schema"
)

_STATUS = Group(("wip", "superseded", "deprecated"))
_DESCRIPTION = Group(("description",))
_NUMERIC_HINTS = {"increment": FLOAT, "minValue": FLOAT, "maxValue": FLOAT, "default": DEFAULT}
_REPLACED = {"since": SINCE, "replaced_by": ANY}

SHAPES: dict[str, Shape] = {
    "mavlink": Shape(
        optional={"file": ANY},
        children=(
            Group(("include",), most=_MANY),
            Group(("version",)),
            Group(("dialect",)),
            Group(("enums",)),
            Group(("messages",)),
        ),
    ),
    "include": Shape(content=ANY),
    "version": Shape(content=BYTE),
    "dialect": Shape(content=BYTE),
    "description": Shape(content=ANY),
    "extensions": Shape(content=ANY),
    "enums": Shape(children=(Group(("enum",), most=_MANY),)),
    "messages": Shape(children=(Group(("message",), most=_MANY),)),
    "wip": Shape(optional={"since": SINCE}, children=(_DESCRIPTION,), content=ANY),
    "superseded": Shape(required=_REPLACED, children=(_DESCRIPTION,), content=ANY),
    "deprecated": Shape(
        required=_REPLACED,
        optional={"remove_on_date": ANY},
        children=(_DESCRIPTION,),
        content=ANY,
    ),
    "enum": Shape(
        required={"name": NAME},
        optional={"bitmask": BOOLEAN},
        children=(_STATUS, _DESCRIPTION, Group(("entry",), least=1, most=_MANY)),
    ),
    "entry": Shape(
        required={"name": NAME},
        optional={
            "value": SIGNED_VALUE,
            "hasLocation": BOOLEAN,
            "hasAltitudeOnly": BOOLEAN,
            "isDestination": BOOLEAN,
            "missionOnly": BOOLEAN,
            "mission": BOOLEAN,
            "fence": BOOLEAN,
            "rally": BOOLEAN,
            "command": BOOLEAN,
        },
        children=(_STATUS, _DESCRIPTION, Group(("param",), most=_MANY)),
    ),
    "param": Shape(
        required={"index": BYTE},
        optional={
            "label": ANY,
            "units": ANY,
            "multiplier": MULTIPLIER,
            "instance": BOOLEAN,
            "enum": ANY,
            "decimalPlaces": BYTE,
            "reserved": BOOLEAN,
            **_NUMERIC_HINTS,
        },
        content=ANY,
    ),
    "message": Shape(
        required={"id": MESSAGE_ID, "name": NAME},
        children=(
            _STATUS,
            _DESCRIPTION,
            Group(("field",), least=1, most=_MANY),
            Group(("extensions",)),
            Group(("field",), most=_MANY),
        ),
    ),
    "field": Shape(
        required={"type": FIELD_TYPE, "name": NAME},
        optional={
            "print_format": ANY,
            "enum": ANY,
            "display": ANY,
            "units": ANY,
            "multiplier": MULTIPLIER,
            "instance": BOOLEAN,
            "invalid": ANY,
            **_NUMERIC_HINTS,
        },
        children=(_DESCRIPTION,),
        content=ANY,
    ),
}

RESERVED_WORDS = frozenset(
    "await boolean break byte case catch char class const continue debugger default delete do "
    "double else extends final finally float for function goto if implements import in instanceof "
    "int interface let long native new package private protected public static super switch "
    "synchronized this throw transient try typeof var void volatile while with yield".split()
)
"""Names, in any case, that generators for other languages cannot use."""
