#!/usr/bin/env python3
"""Write message_definitions/upstream/upstream.xml: every message and enum entry of several sets of definitions.

    tools/union_definitions.py path/to/mavlink/message_definitions/v1.0 path/to/ardupilot/...
    tools/union_definitions.py --check DIR...   # exit 1 where the file differs

The set that the project ships is the last one. Where several sets have a message, the longest list of fields counts.
Sets must not contradict each other: a message id with two names, a changed field or a changed enum value is an error.
A set may use an id or an enum twice in files that are not meant to be used together. Those of `all.xml` count then, and
the tool prints the messages that it leaves out.
"""

from __future__ import annotations

import argparse
import copy
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

from import_definitions import HEADER, OUTPUT, DefinitionError, write_element

UNION = OUTPUT.parent / "upstream" / "upstream.xml"


def roots(folder: Path) -> tuple[list[ET.Element], list[ET.Element]]:
    """The definitions of a folder: `all.xml` with its includes, and the other files by name."""
    files = {path.name: ET.parse(path).getroot() for path in sorted(folder.glob("*.xml"))}
    order = ["all.xml"]
    for name in order:  # which grows meanwhile
        included = [(element.text or "").strip() for element in files[name].iter("include")]
        order += [one for one in included if one not in order]
    together = [files.pop(name) for name in order]
    return together, list(files.values())


def number(value: str) -> int:
    """The value of an enum entry: decimal, hexadecimal or `2**n`."""
    base, _, power = value.partition("**")
    return int(base, 0) ** int(power) if power else int(base, 0)


def base_fields(message: ET.Element) -> int:
    """How many fields stand before `<extensions/>`."""
    tags = [one.tag for one in message if one.tag in ("field", "extensions")]
    return tags.index("extensions") if "extensions" in tags else len(tags)


class Union:
    """The messages and enums so far."""

    def __init__(self) -> None:
        self.messages: dict[int, ET.Element] = {}
        self.enums: dict[str, ET.Element] = {}
        self.left_out: list[str] = []

    def add(self, folder: Path) -> None:
        """Add a set of definitions."""
        together, others = roots(folder)
        own: set[int] = set()
        for root in together:
            for enum in root.iter("enum"):
                self._add_enum(enum)
        for root in others:
            for enum in root.iter("enum"):
                self.enums.setdefault(enum.get("name", ""), enum)
        for root in [*together, *others]:
            for message in root.iter("message"):
                id_ = int(message.get("id", ""))
                if id_ in own:
                    self.left_out.append(f"{folder}: {id_} {message.get('name')}")
                    continue
                own.add(id_)
                self._add_message(id_, message)

    def _add_message(self, id_: int, message: ET.Element) -> None:
        known = self.messages.setdefault(id_, message)
        if known is message:
            return
        old, new = list(known.iter("field")), list(message.iter("field"))
        if known.get("name") != message.get("name"):
            raise DefinitionError(f"id {id_} is {known.get('name')} and {message.get('name')}")
        for a, b in zip(old, new, strict=False):
            if (a.get("type"), a.get("name")) != (b.get("type"), b.get("name")):
                raise DefinitionError(f"{known.get('name')}: {a.attrib} and {b.attrib}")
        if base_fields(known) != base_fields(message):
            raise DefinitionError(f"{known.get('name')} has other base fields")
        if len(new) > len(old):
            self.messages[id_] = message

    def _add_enum(self, enum: ET.Element) -> None:
        name = enum.get("name", "")
        known = self.enums.get(name)
        if known is None:
            known = self.enums[name] = copy.copy(enum)
        by_name = {one.get("name"): one for one in known.iter("entry")}
        by_value = {number(one.get("value", "")): one for one in known.iter("entry")}
        for entry in enum.iter("entry"):
            value = number(entry.get("value", ""))
            same = by_name.get(entry.get("name"))
            if same is not None and number(same.get("value", "")) != value:
                raise DefinitionError(
                    f"{name}: {entry.get('name')} is {same.get('value')} and {value}"
                )
            if same is None and value not in by_value:
                known.append(entry)


def text(union: Union) -> str:
    """The definitions as one file."""
    root = ET.Element("mavlink")
    ET.SubElement(root, "version").text = "3"
    for tag, elements in (
        ("enums", [union.enums[name] for name in sorted(union.enums)]),
        ("messages", [union.messages[id_] for id_ in sorted(union.messages)]),
    ):
        ET.SubElement(root, tag).extend(elements)
    lines: list[str] = []
    write_element(root, 0, lines)
    return HEADER + "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Command line entry point."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sets", nargs="+", type=Path, metavar="DIR", help="folder of upstream XML")
    parser.add_argument("--output", type=Path, default=UNION, help="default: %(default)s")
    parser.add_argument("--check", action="store_true", help="only compare; exit 1 on a difference")
    options = parser.parse_args(argv)
    union = Union()
    try:
        for folder in [*options.sets, OUTPUT]:
            union.add(folder)
        new = text(union)
    except (DefinitionError, ET.ParseError, OSError) as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2
    print("\n".join(f"left out: {one}" for one in union.left_out))
    print(f"{len(union.messages)} messages, {len(union.enums)} enums")
    old = options.output.read_text(encoding="utf-8") if options.output.is_file() else None
    if options.check:
        return int(old != new)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text(new, encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
