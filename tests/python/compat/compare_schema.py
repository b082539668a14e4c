"""Compare the schema with pymavlink's generated modules, for every dialect and both wire versions.

Runs the `describe` example over message_definitions and compares what it prints with what
pymavlink's modules show: every message's id, name, order, crc_extra, field names, types, wire
order, offsets, lengths, struct format, instance field, units, enums, displays and version default,
and every enum's entries in order. Needs Cargo and an interpreter with pymavlink 2.4.50:

    python tests/python/compat/compare_schema.py [--definitions DIR] [dialect ...]
"""

from __future__ import annotations

import argparse
import importlib
import inspect
import json
import struct
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
DIALECTS = [
    *("ASLUAV", "AVSSUAS", "all", "ardupilotmega", "common", "csAirLink", "cubepilot"),
    *("development", "icarous", "loweheiser", "matrixpilot", "minimal", "paparazzi"),
    *("python_array_test", "standard", "storm32", "test", "uAvionix", "ualberta"),
]


def build() -> Path:
    """Build the example and return its path."""
    command = ["cargo", "build", "--quiet", "-p", "mavwire-schema", "--example", "describe"]
    output = subprocess.run(
        [*command, "--message-format=json"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    for line in output.splitlines():
        artifact = json.loads(line)
        if artifact.get("target", {}).get("name") == "describe" and artifact.get("executable"):
            return Path(artifact["executable"])
    raise RuntimeError("cargo did not report the example's path")


def described(program: Path, definitions: Path, dialect: str, version: str) -> list[dict[str, Any]]:
    """What our schema says, in its order."""
    result = subprocess.run(
        [program, definitions, dialect, version], check=True, capture_output=True, text=True
    )
    return [json.loads(line) for line in result.stdout.splitlines()]


def offsets(message: Any) -> list[int]:
    """Offsets in wire order, from the struct format of each field."""
    result, offset = [], 0
    for code, length in zip(message.native_format[1:].decode(), message.array_lengths, strict=True):
        result.append(offset)
        offset += struct.calcsize("<" + code) * max(1, length)
    return result


def version_defaults(module: ModuleType, message: Any) -> dict[str, int]:
    """Fields that have a default in *_encode and are no extension: the XML version."""
    encode = getattr(module.MAVLink, f"{message.msgname.lower()}_encode")
    create = inspect.signature(message.__init__).parameters
    return {
        name: parameter.default
        for name, parameter in inspect.signature(encode).parameters.items()
        if parameter.default is not parameter.empty and create[name].default is parameter.empty
    }


def message_facts(module: ModuleType, message: Any) -> dict[str, Any]:
    """What pymavlink's class shows, under the keys of our example."""
    create = inspect.signature(message.__init__).parameters
    positions = dict(zip(message.ordered_fieldnames, offsets(message), strict=True))
    return {
        "kind": "message",
        "id": message.id,
        "name": message.msgname,
        "crc_extra": message.crc_extra,
        "fieldnames": message.fieldnames,
        "fieldtypes": message.fieldtypes,
        "ordered_fieldnames": message.ordered_fieldnames,
        "orders": message.orders,
        "offsets": list(positions.values()),
        "lengths": message.lengths,
        "array_lengths": message.array_lengths,
        "format": message.unpacker.format,
        "max_len": message.unpacker.size,
        "instance_field": message.instance_field,
        "instance_offset": message.instance_offset,
        "target_system_offset": positions.get("target_system", positions.get("target")),
        "target_component_offset": positions.get("target_component"),
        "units": message.fieldunits_by_name,
        "enums": message.fieldenums_by_name,
        "displays": message.fielddisplays_by_name,
        "mavlink_version": version_defaults(module, message),
        "extensions": {
            name: True
            for name in message.fieldnames
            if create[name].default is not inspect.Parameter.empty
        },
    }


def enum_facts(name: str, definition: Any) -> dict[str, Any]:
    """What pymavlink's enum shows, without the synthetic end entry."""
    entries = [
        {
            "value": value,
            "name": entry.name,
            "has_location": entry.has_location,
            "label": {str(index): label for index, label in entry.label.items()},
        }
        for value, entry in definition.items()
    ]
    end = entries.pop()
    assert end["name"] == f"{name}_ENUM_END", end
    return {"kind": "enum", "name": name, "bitmask": definition.bitmask, "entries": entries}


def expected(dialect: str, version: str) -> list[dict[str, Any]]:
    """What pymavlink says, in its order."""
    package = "v10" if version == "1.0" else "v20"
    module = importlib.import_module(f"pymavlink.dialects.{package}.{dialect}")
    messages = [message_facts(module, message) for message in module.mavlink_map.values()]
    return messages + [enum_facts(name, value) for name, value in module.enums.items()]


def entries_match(mine: Any, theirs: Any) -> bool:
    """Whether lists of entries agree in what pymavlink shows, descriptions left out."""
    if not isinstance(mine, list) or len(mine) != len(theirs):
        return False
    return all(all(a.get(key) == b[key] for key in b) for a, b in zip(mine, theirs, strict=True))


def differences(ours: list[dict[str, Any]], theirs: list[dict[str, Any]]) -> list[str]:
    """One line per fact that differs."""
    found = []
    order = [[(item["kind"], item["name"]) for item in items] for items in (ours, theirs)]
    if order[0] != order[1]:
        only_one = sorted(set(order[0]) ^ set(order[1]))[:5]
        found.append(f"order: {only_one or 'same names, other order'}")
    known = {(item["kind"], item["name"]): item for item in ours}
    for item in theirs:
        mine = known.get((item["kind"], item["name"]), {})
        found += [
            f"{item['name']}.{key}: {mine.get(key)!r}, pymavlink {value!r}"
            for key, value in item.items()
            if mine.get(key) != value
            and not (key == "entries" and entries_match(mine.get(key), value))
        ]
    return found


def main() -> int:
    """Command line entry point; exit status 1 on a difference."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--definitions", type=Path, default=ROOT / "message_definitions" / "v1.0")
    parser.add_argument("dialects", nargs="*", default=DIALECTS)
    options = parser.parse_args()
    program = build()
    failures = messages = entries = 0
    for dialect in options.dialects:
        for version in ("1.0", "2.0"):
            ours = described(program, options.definitions, dialect, version)
            found = differences(ours, expected(dialect, version))
            failures += len(found)
            messages += sum(item["kind"] == "message" for item in ours)
            entries += sum(len(item["entries"]) for item in ours if item["kind"] == "enum")
            for line in found[:5]:
                print(f"{dialect} {version}: {line}")
    print(f"{messages} messages and {entries} enum entries compared, {failures} differences")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
