#!/usr/bin/env python3
"""Write message_definitions/upstream/upstream.xml: every message and enum entry of several sets of definitions.

    tools/union_definitions.py path/to/mavlink path/to/ardupilot
    tools/union_definitions.py --check DIR...   # exit 1 where the file differs

Behind the sets come the dialects of pymavlink and the union as it was: messages that upstream removes stay, but for
`--fresh`. Where several sets have a message, the longest list of fields counts.
Sets must not contradict each other: a message id with two names, a changed field or a changed enum value is an error.
A set may use an id or an enum twice in files that are not meant to be used together. Those of `all.xml` count then, and
the tool prints the messages that it leaves out. Git tells the origin of each set for sources.toml, or `--pin` does.
"""

from __future__ import annotations

import argparse
import copy
import json
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import definition_sources
from import_definitions import HEADER, OUTPUT, DefinitionError, write_element
from mavwire._native import DefinitionFile
from mavwire.cli.dev._definition_facts import definition_files

UNION = OUTPUT.parent / "upstream" / "upstream.xml"


Values = dict[ET.Element, int]


def roots(folder: Path) -> tuple[list[ET.Element], list[ET.Element], Values]:
    """The definitions of a folder or file: `all.xml` with its includes, and the others by name. The values are those of
    enum entries.
    """
    files: dict[str, ET.Element] = {}
    values: Values = {}
    for path in definition_files(folder) if folder.is_dir() else [folder]:
        text = path.read_text(encoding="utf-8-sig")
        files[path.name] = ET.fromstring(text)
        definitions, _ = json.loads(DefinitionFile(str(path), text).parse())
        entries = [one["value"] for enum in definitions["enums"] for one in enum["entries"]]
        values |= dict(zip(files[path.name].iterfind("enums/enum/entry"), entries, strict=True))
    order = ["all.xml"] if "all.xml" in files else []
    for name in order:  # which grows meanwhile
        included = [(element.text or "").strip() for element in files[name].iter("include")]
        order += [one for one in included if one not in order]
    together = [files.pop(name) for name in order]
    return together, list(files.values()), values


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
        self._values: Values = {}

    def add(self, folder: Path) -> None:
        """Add a set of definitions."""
        together, others, values = roots(folder)
        self._values |= values
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
        entries = list(known.iter("entry"))
        by_name = {one.get("name"): self._values[one] for one in entries}
        taken = set(by_name.values())
        for entry in enum.iter("entry"):
            value, entry_name = self._values[entry], entry.get("name")
            if by_name.get(entry_name, value) != value:
                raise DefinitionError(f"{name}: {entry_name} is {by_name[entry_name]} and {value}")
            if entry_name not in by_name and value not in taken:
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
    return HEADER.format("union_definitions.py") + "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Command line entry point."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "sets", nargs="+", type=Path, metavar="DIR", help="checkout, or folder of XML"
    )
    parser.add_argument("--output", type=Path, default=UNION, help="default: %(default)s")
    parser.add_argument("--check", action="store_true", help="only compare; exit 1 on a difference")
    parser.add_argument("--fresh", action="store_true", help="drop what upstream removed")
    definition_sources.add_pin(parser)
    options = parser.parse_args(argv)
    union = Union()
    old = options.output.read_text(encoding="utf-8") if options.output.is_file() else None
    known = [] if options.fresh or old is None else [options.output]
    try:
        for folder in [*options.sets, OUTPUT, *known]:
            union.add(folder)
        new = text(union)
        is_imported = options.output == UNION and not options.check
        sources = pins(options.sets, options.pin or []) if is_imported else []
    except (ValueError, DefinitionError, ET.ParseError, OSError) as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2
    print("\n".join(f"left out: {one}" for one in union.left_out))
    print(f"{len(union.messages)} messages, {len(union.enums)} enums")
    if options.check:
        return int(old != new)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text(new, encoding="utf-8", newline="\n")
    if is_imported:
        definition_sources.save(*sources)
        definition_sources.save_written(UNION)
    return 0


def pins(
    folders: list[Path], given: list[definition_sources.Source]
) -> list[definition_sources.Source]:
    """The origin of each folder."""
    for source, folder in zip(given, folders, strict=False):
        source.sha256 = definition_sources.digests(folder)
    return [*given, *map(definition_sources.checkout, folders[len(given) :])]


if __name__ == "__main__":
    sys.exit(main())
