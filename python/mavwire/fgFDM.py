"""FlightGear's flight dynamics packet, version 24: pymavlink's `fgFDM`.

A packet is 408 bytes, big-endian: what a simulator tells FlightGear's network input, or the other
way round. Variables have names and units; some are arrays.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import Any

FG_NET_FDM_VERSION = 24
# The largest number that every field takes; what is not in its range is sent as 0.
_LARGEST = 3.4e38


class fgFDMError(Exception):
    """An unknown variable or unit, an index outside an array, or bytes that are no packet."""

    def __init__(self, msg: str) -> None:
        super().__init__(msg)
        self.message = "fgFDMError: " + msg


@dataclass(eq=False, repr=False)
class fgFDMVariable:
    """Where a variable is among the values of a packet, how many it has, and their unit."""

    index: int
    arraylength: int
    units: str | None


class fgFDMVariableList:
    """Variables by name, in the order of the packet."""

    def __init__(self) -> None:
        self.vars: dict[str, fgFDMVariable] = {}
        self._nextidx = 0

    def add(self, varname: str, arraylength: int = 1, units: str | None = None) -> None:
        """Append a variable."""
        self.vars[varname] = fgFDMVariable(self._nextidx, arraylength, units)
        self._nextidx += arraylength


# The variables in the order of the packet: names, how many values each has, unit.
_LAYOUT: tuple[tuple[str, int, str | None], ...] = (
    ("version", 1, None),
    ("longitude latitude", 1, "radians"),
    ("altitude agl", 1, "meters"),
    ("phi theta psi alpha beta", 1, "radians"),
    ("phidot thetadot psidot", 1, "rps"),
    ("vcas climb_rate v_north v_east v_down", 1, "fps"),
    ("v_wind_body_north v_wind_body_east v_wind_body_down", 1, "fps"),
    ("A_X_pilot A_Y_pilot A_Z_pilot", 1, "fpss"),
    ("stall_warning", 1, None),
    ("slip_deg", 1, "degrees"),
    ("num_engines", 1, None),
    ("eng_state rpm fuel_flow fuel_px egt cht mp_osi tit oil_temp oil_px", 4, None),
    ("num_tanks", 1, None),
    ("fuel_quantity", 4, None),
    ("num_wheels", 1, None),
    ("wow gear_pos gear_steer gear_compression", 3, None),
    ("cur_time warp", 1, "seconds"),
    ("visibility", 1, "meters"),
    ("elevator elevator_trim_tab left_flap right_flap left_aileron right_aileron", 1, None),
    ("rudder nose_wheel speedbrake spoilers", 1, None),
)
_PACK_STRING = ">I 4x 3d 6f 11f 3f 2f I 4I 4f 4f 4f 4f 4f 4f 4f 4f 4f I 4f I 3I 3f 3f 3f I i f 10f"


class fgFDM:
    """One packet: set and get variables, parse and pack. Empty but for the version at first."""

    def __init__(self) -> None:
        self.FG_NET_FDM_VERSION = FG_NET_FDM_VERSION
        self.pack_string = _PACK_STRING
        self.values: list[Any] = [0] * 98
        self.FG_MAX_ENGINES = 4
        self.FG_MAX_WHEELS = 3
        self.FG_MAX_TANKS = 4
        degrees = math.degrees(1)
        self.unitmap = {
            ("radians", "degrees"): degrees,
            ("rps", "dps"): degrees,
            ("feet", "meters"): 0.3048,
            ("fps", "mps"): 0.3048,
            ("knots", "mps"): 0.514444444,
            ("knots", "fps"): 0.514444444 / 0.3048,
            ("fpss", "mpss"): 0.3048,
            ("seconds", "minutes"): 60,
            ("seconds", "hours"): 3600,
        }
        self.mapping = fgFDMVariableList()
        for names, arraylength, units in _LAYOUT:
            for name in names.split():
                self.mapping.add(name, arraylength, units)
        self.set("version", self.FG_NET_FDM_VERSION)

    def packet_size(self) -> int:
        """How many bytes a packet has."""
        return struct.calcsize(self.pack_string)

    def convert(self, value: float, fromunits: str | None, tounits: str | None) -> float:
        """A value in another unit.

        Hours and minutes follow `unitmap`, which multiplies: pymavlink's figures.
        """
        if fromunits == tounits:
            return value
        if (fromunits, tounits) in self.unitmap:
            return value * self.unitmap[fromunits, tounits]  # type: ignore[index]
        if (tounits, fromunits) in self.unitmap:
            return value / self.unitmap[tounits, fromunits]  # type: ignore[index]
        raise fgFDMError(f"unknown unit mapping ({fromunits},{tounits})")

    def _variable(self, varname: str) -> fgFDMVariable:
        if varname not in self.mapping.vars:
            raise fgFDMError(f"Unknown variable {varname}")
        return self.mapping.vars[varname]

    def _place(self, varname: str, idx: int) -> tuple[fgFDMVariable, int]:
        """A variable, and where its value `idx` is."""
        variable = self._variable(varname)
        if not 0 <= idx < variable.arraylength:
            length = variable.arraylength
            raise fgFDMError(
                f"index of {varname} beyond end of array idx={idx} arraylength={length}"
            )
        return variable, variable.index + idx

    def units(self, varname: str) -> str | None:
        """The unit that a variable has in the packet."""
        return self._variable(varname).units

    def variables(self) -> list[str]:
        """The names of all variables, in the order of the packet."""
        return list(self.mapping.vars)

    def get(self, varname: str, idx: int = 0, units: str | None = None) -> Any:
        """A value, in the unit of the packet or in `units`."""
        variable, place = self._place(varname, idx)
        value = self.values[place]
        return value if units is None else self.convert(value, variable.units, units)

    def set(self, varname: str, value: float, idx: int = 0, units: str | None = None) -> None:
        """Set a value that is given in the unit of the packet or in `units`; no number gives 0."""
        variable, place = self._place(varname, idx)
        if units is not None:
            value = self.convert(value, units, variable.units)
        self.values[place] = value if abs(value) <= _LARGEST else 0  # NaN is not <= either

    def parse(self, buf: bytes) -> None:
        """Take the values out of a packet."""
        try:
            values = struct.unpack(self.pack_string, buf)
        except struct.error as error:
            raise fgFDMError(f"unable to parse - {error}") from error
        self.values = list(values)

    def pack(self) -> bytes:
        """The packet. Values that are no numbers become 0, in integer fields fractions are cut."""
        self.values = [value if math.isfinite(value) else 0 for value in self.values]
        wholes = _INTEGERS.intersection(range(len(self.values)))
        values = [int(v) if i in wholes else v for i, v in enumerate(self.values)]
        try:
            return struct.pack(self.pack_string, *values)
        except (struct.error, OverflowError) as error:
            raise fgFDMError(f"unable to pack - {error}") from error


_EMPTY = struct.unpack(_PACK_STRING, bytes(struct.calcsize(_PACK_STRING)))
# The places of integers in a packet.
_INTEGERS = frozenset(place for place, value in enumerate(_EMPTY) if isinstance(value, int))
