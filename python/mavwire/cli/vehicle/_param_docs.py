"""Meanings of the values of ArduPilot's parameters, from its definitions (`apm.pdef.xml`). MAVProxy
keeps a copy of them for each vehicle.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element
from xml.parsers import expat

from mavwire._native import DefinitionError
from mavwire._text import printable
from mavwire.cli._errors import CommandError
from mavwire.dialects._sources import read_text

# Of 32, the highest is the sign.
BITS = 31
# Other names of vehicles, and those of the files.
_VEHICLES = {
    "ArduCopter": "Copter", "ArduPlane": "Plane", "ArduSub": "Sub", "APMrover2": "Rover",
}  # fmt: skip


class ParameterDocs:
    """Parameter name -> the names of its bits or of its values."""

    def __init__(self, path: str) -> None:
        try:
            root = _read(path)
        except DefinitionError as error:
            raise CommandError(f"--param-docs: {error}") from error
        self._bits: dict[str, dict[int, str]] = {}
        self._values: dict[str, dict[str, str]] = {}
        for part in ("vehicles", "libraries"):
            for parameter in root.iterfind(f"{part}/parameters/param"):
                self._take(parameter)

    def _take(self, parameter: Element) -> None:
        """Keep one definition; libraries come last, and theirs count."""
        name = parameter.get("name", "").rpartition(":")[2]
        self._bits.pop(name, None)
        self._values.pop(name, None)
        if bits := _bits(parameter):
            self._bits[name] = bits
        if (values := parameter.find("values")) is not None:
            codes = values.iterfind("value")
            self._values[name] = {one.get("code", ""): one.text or "" for one in codes}

    def meaning(self, name: str, value: float) -> str | None:
        """The meaning of a value; None without a definition."""
        if not math.isfinite(value):
            return None
        if name in self._bits:
            return printable(_set_bits(self._bits[name], int(value)))
        meaning = self._values.get(name, {}).get(str(int(value)))
        return None if meaning is None else printable(meaning)


def _read(path: str) -> Element:
    text = read_text(path)
    if "<!DOCTYPE" in text:  # entities, which it declares, grow without bound
        raise DefinitionError(f"{path}: a document type declaration (<!DOCTYPE>) has no place here")
    try:
        return ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        line, column = error.position
        reason = expat.ErrorString(error.code)
        raise DefinitionError(
            f"{path}:{line}:{column + 1}: not well-formed XML: {reason}"
        ) from None


def _bits(parameter: Element) -> dict[int, str]:
    """The names of the bits, `0:All,1:Barometer`; nothing where one of them has no number."""
    text = parameter.findtext("field[@name='Bitmask']", "")
    pairs = [one.split(":", 1) for one in text.split(",") if one.strip()]
    bitmask = parameter.find("bitmask")
    if not pairs and bitmask is not None:
        pairs = [[one.get("code", ""), one.text or ""] for one in bitmask.iterfind("bit")]
    if all(len(pair) == 2 and pair[0].strip().isdecimal() for pair in pairs):
        return {int(number): name for number, name in pairs}
    return {}


def _set_bits(names: dict[int, str], value: int) -> str:
    """The bits that are set: those with names, then the others, spelled as MAVProxy does."""
    known = [name for bit, name in names.items() if value >> bit & 1]
    others = (bit for bit in range(BITS) if bit not in names and value >> bit & 1)
    return "|".join(known + [f"Uknownbit{bit}" for bit in others])


def downloaded(vehicle: str) -> str:
    """The file that `param download` of MAVProxy wrote for a vehicle. CommandError without one."""
    name = _VEHICLES.get(vehicle, vehicle)
    folders = [Path.home(), *map(Path, filter(None, [os.environ.get("LOCALAPPDATA")]))]
    for folder in folders:
        path = folder / ".mavproxy" / f"{name}.xml"
        if path.is_file():
            return str(path)
    raise CommandError(
        f"--param-docs: {folders[0] / '.mavproxy' / name}.xml is not there; run 'param download' in"
        " MAVProxy, or name an apm.pdef.xml with --param-xml"
    )
