#!/usr/bin/env python3
"""Write message_definitions/upstream/upstream.xml: every message and enum entry of several sets of definitions.

    tools/union_definitions.py path/to/mavlink path/to/ardupilot
    tools/union_definitions.py --check DIR...   # exit 1 where the file differs

Behind the sets come the dialects of pymavlink and the union as it was: messages that upstream removes stay. Where several
sets have a message, the longest list of fields counts. Contradictions are held back and printed, but for the
changes under `[[accepted]]` in message_definitions/sources.toml. Layouts that leave the union go to history.xml.
A set may use an id twice in files that are not meant to be used together. Those of `all.xml` count then, and the tool
prints the messages that it leaves out. Git tells the origin of each set for sources.toml, or `--pin` does.
"""

from __future__ import annotations

import argparse
import copy
import json
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import definition_sources
from definition_sources import HISTORY, UNION, Accepted
from definitions_check import Judge, Verdict, report
from import_definitions import HEADER, OUTPUT, write_element
from mavwire._native import DefinitionFile, definition_union
from mavwire.cli.dev._definition_facts import Facts, messages_of, of_file, parsed
from mavwire.dialects import _sources


class Sets:
    """Sets of definition files without what is held back."""

    def __init__(self) -> None:
        self.texts: list[dict[str, str]] = []
        self.elements: list[ET.Element] = []
        """Enums, entries and messages in the order of `definition_union`."""
        self.messages: list[tuple[Path, int, str, int]] = []
        """File, id, name and CRC_EXTRA."""

    def add(self, verdicts: list[Verdict]) -> None:
        """Add the files of a set."""
        files: dict[str, str] = {}
        for verdict in sorted(verdicts, key=lambda one: one.file.stem):
            root = ET.fromstring(_sources.read_text(verdict.file))
            remove_held_back(root, verdict.facts)
            for enum in root.iterfind("enums/enum"):
                self.elements += [enum, *enum.iterfind("entry")]
            self.elements += root.iterfind("messages/message")
            files[verdict.file.stem] = ET.tostring(root, encoding="unicode")
            rows = verdict.facts.messages.items()
            self.messages += [(verdict.file, id_, *message.key) for id_, message in rows]
        self.texts.append(files)

    def union(self) -> tuple[str, list[str]]:
        """The union as one file, and the messages that it leaves out."""
        definitions, layouts = json.loads(definition_union(self.texts, False))
        root = ET.Element("mavlink")
        ET.SubElement(root, "version").text = "3"
        enums = ET.SubElement(root, "enums")
        for row in sorted(definitions["enums"], key=lambda one: one["name"]):
            enum = copy.copy(self.elements[row["line"]])
            enum[:] = [one for one in enum if one.tag != "entry"]
            for entry in row["entries"]:
                enum.append(self.elements[entry["line"]])
                enum[-1].set("value", enum[-1].get("value", str(entry["value"])))
            enums.append(enum)
        messages = ET.SubElement(root, "messages")
        kept = set()
        pairs = zip(definitions["messages"], layouts, strict=True)
        for row, layout in sorted(pairs, key=lambda one: one[0]["id"]):
            if row["crc_extra"] is None:  # the name is not taken
                messages.append(self.elements[row["line"]])
                kept.add((row["id"], layout["crc_extra"]))
        lines: list[str] = []
        write_element(root, 0, lines)
        left_out = [
            f"left out: {file}: {id_} {name}"
            for file, id_, name, crc_extra in self.messages
            if (id_, crc_extra) not in kept
        ]
        print(f"{len(messages)} messages, {len(enums)} enums")
        return HEADER.format("union_definitions.py") + "\n".join(lines) + "\n", left_out


def remove_held_back(root: ET.Element, facts: Facts) -> None:
    """Remove the messages and entries that are not in the facts."""
    for messages in root.iterfind("messages"):
        messages[:] = [one for one in messages if int(one.get("id", "")) in facts.messages]
    for enum in root.iterfind("enums/enum"):
        entries = facts.enums[enum.get("name", "")]
        enum[:] = [one for one in enum if one.tag != "entry" or one.get("name") in entries]


def keep(old: str, union: Facts, accepted: list[Accepted]) -> None:
    """Add the layouts to the history that the old text of the union has, and the union does not have any more."""
    text = HISTORY.read_text(encoding="utf-8")
    history = messages_of(*json.loads(DefinitionFile("history", text).parse()))
    known = {(id_, message.crc_extra) for id_, message in [*history, *union.messages.items()]}
    before = parsed(DefinitionFile("upstream", old).parse()).messages
    reasons = {(one.id, one.old): one.reason.replace("--", "-") for one in accepted}
    lines: list[str] = []
    for message in ET.fromstring(old).iter("message"):
        id_ = int(message.get("id", ""))
        key = id_, before[id_].crc_extra
        if key not in known:
            lines.append(f"    <!-- CRC_EXTRA {key[1]}, replaced: {reasons.get(key, '')} -->")
            write_element(message, 2, lines)
    head, end, tail = text.rpartition("  </messages>")
    added = "".join(f"{line}\n" for line in lines)
    HISTORY.write_text(head + added + end + tail, encoding="utf-8", newline="\n")


def main(argv: list[str] | None = None) -> int:
    """Command line entry point."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "sets", nargs="+", type=Path, metavar="DIR", help="checkout, or folder of XML"
    )
    parser.add_argument("--output", type=Path, default=UNION, help="default: %(default)s")
    parser.add_argument("--check", action="store_true", help="only compare; exit 1 on a difference")
    definition_sources.add_pin(parser)
    options = parser.parse_args(argv)
    is_imported = options.output == UNION and not options.check
    old = options.output.read_text(encoding="utf-8") if options.output.is_file() else None
    accepted = definition_sources.accepted()
    try:
        judge = Judge(options.output, accepted)
        known = [] if old is None else [options.output]
        sets = Sets()
        verdicts = []
        for place in [*options.sets, OUTPUT, *known]:
            found = judge.check(place)
            sets.add(found)
            verdicts += found
        new, left_out = sets.union()
        sources = pins(options.sets, options.pin or []) if is_imported else []
    except (ValueError, ET.ParseError, OSError) as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2
    held_back = [one for one in verdicts if one.is_breaking]
    for line in [*left_out, *([report(held_back)] if held_back else [])]:
        print(line)
    if options.check:
        return int(old != new)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text(new, encoding="utf-8", newline="\n")
    if is_imported:
        if old is not None:
            keep(old, of_file(UNION), accepted)
        definition_sources.save(*sources)
        definition_sources.save_written(UNION, HISTORY)
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
