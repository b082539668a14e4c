"""What the values of ArduPilot's parameters mean, by the definitions that it publishes
(`apm.pdef.xml`) and that MAVProxy keeps a copy of for each vehicle.
"""

from __future__ import annotations

import math
import os
from pathlib import Path

from mavwire._text import printable
from mavwire.cli._errors import CommandError
from mavwire.generator._errors import MAVParseError
from mavwire.generator._xml_reader import Element, read_xml

# The largest published file has 120,000.
MAX_ELEMENTS = 1_000_000
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
            root = read_xml(path, max_elements=MAX_ELEMENTS)
        except MAVParseError as error:
            raise CommandError(f"--param-docs: {error}") from error
        self._bits: dict[str, dict[int, str]] = {}
        self._values: dict[str, dict[str, str]] = {}
        for part in ("vehicles", "libraries"):
            for group in root.all(part):
                for parameters in group.all("parameters"):
                    for parameter in parameters.all("param"):
                        self._take(parameter)

    def _take(self, parameter: Element) -> None:
        """Keep one definition; libraries come last, and theirs count."""
        name = parameter.attributes.get("name", "").rpartition(":")[2]
        self._bits.pop(name, None)
        self._values.pop(name, None)
        if bits := _bits(parameter):
            self._bits[name] = bits
        values = parameter.first("values")
        if values is not None:
            codes = values.all("value")
            self._values[name] = {one.attributes.get("code", ""): one.text for one in codes}

    def meaning(self, name: str, value: float) -> str | None:
        """What a value means; None where no definition says."""
        if not math.isfinite(value):
            return None
        if name in self._bits:
            return printable(_set_bits(self._bits[name], int(value)))
        meaning = self._values.get(name, {}).get(str(int(value)))
        return None if meaning is None else printable(meaning)


def _bits(parameter: Element) -> dict[int, str]:
    """The names of the bits, `0:All,1:Barometer`; nothing where one of them has no number."""
    text = next(
        (one.text for one in parameter.all("field") if one.attributes.get("name") == "Bitmask"), ""
    )
    pairs = [one.split(":", 1) for one in text.split(",") if one.strip()]
    bitmask = parameter.first("bitmask")
    if not pairs and bitmask is not None:
        pairs = [[one.attributes.get("code", ""), one.text] for one in bitmask.all("bit")]
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
