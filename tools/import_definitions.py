#!/usr/bin/env python3
"""Write message_definitions/v1.0 from a directory of upstream XML: facts, no prose.

The project ships what a definition states: names, ids, entries and values, types, order, units and
the other attributes, includes, version and dialect numbers, work-in-progress and deprecation marks.
Descriptions are the upstream authors' text and stay upstream, so every text node outside include,
version and dialect is dropped, and comments with them. Messages keep an empty description, which
the schema of mavgen requires. The output is canonical (fixed attribute
order and indentation), which makes an update one readable diff:

    tools/import_definitions.py path/to/mavlink/message_definitions/v1.0
    tools/import_definitions.py --check DIR     # exit 1 and a summary where the tree differs

Files of the tree that DIR does not have are left alone: dialects may come from several sources.
`--pin NAME REVISION DATE` names the origin of DIR in message_definitions/sources.toml.
"""

from __future__ import annotations

import argparse
import difflib
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import definition_sources
from mavwire._native import DefinitionFile

OUTPUT = Path(__file__).resolve().parent.parent / "message_definitions" / "v1.0"

HEADER = """<?xml version="1.0"?>
<!-- Facts of a MAVLink dialect, without descriptions. Written by tools/{}. -->
"""

# Elements whose text is a fact.
TEXT_ELEMENTS = frozenset({"include", "version", "dialect"})

# Elements and attributes that are prose.
PROSE = frozenset({"description"})

# Children of a message that stand in front of its description.
MARKS = frozenset({"wip", "superseded", "deprecated"})

# Attributes in the order they are written; others follow in alphabetical order.
ATTRIBUTE_ORDER = (
    "id",
    "value",
    "index",
    "type",
    "name",
    "label",
    "bitmask",
    "enum",
    "display",
    "units",
    "multiplier",
    "instance",
    "invalid",
    "minValue",
    "maxValue",
    "increment",
    "default",
    "reserved",
    "print_format",
    "hasLocation",
    "isDestination",
    "since",
    "replaced_by",
)
RANK = {name: rank for rank, name in enumerate(ATTRIBUTE_ORDER)}


class DefinitionError(Exception):
    """An upstream file that is not a MAVLink definition, with the reason."""


def attributes(element: ET.Element) -> str:
    """The attributes as XML text with a leading space each, in canonical order."""
    kept = {
        name: value
        for name, value in element.attrib.items()
        if name not in PROSE and not name.startswith("{")
    }
    names = sorted(kept, key=lambda name: (RANK.get(name, len(RANK)), name))
    return "".join(f" {name}={quoteattr(kept[name])}" for name in names)


def write_element(element: ET.Element, depth: int, lines: list[str]) -> None:
    """Append the facts of `element` and what it contains, two spaces per level."""
    indent = "  " * depth
    start = f"{indent}<{element.tag}{attributes(element)}"
    if element.tag in TEXT_ELEMENTS:
        lines.append(f"{start}>{escape((element.text or '').strip())}</{element.tag}>")
        return
    inner: list[str] = []
    described = element.tag != "message"
    for child in element:
        if not described and child.tag not in MARKS:
            inner.append(f"{indent}  <description/>")
            described = True
        if child.tag not in PROSE:
            write_element(child, depth + 1, inner)
    if inner:
        lines += [f"{start}>", *inner, f"{indent}</{element.tag}>"]
    else:
        lines.append(f"{start}/>")


def facts(source: Path) -> str:
    """The canonical facts-only text of one upstream file."""
    try:
        text = source.read_text(encoding="utf-8-sig")
        root = ET.fromstring(text)
        problems = DefinitionFile(str(source), text).schema_problems(False)
    except (ET.ParseError, OSError, ValueError) as reason:
        raise DefinitionError(f"{source}: {reason}") from reason
    # The text of an unknown element would be lost. An unknown attribute is kept.
    for problem in problems:
        if " has no attribute " not in problem:
            raise DefinitionError(problem)
    lines: list[str] = []
    write_element(root, 0, lines)
    return HEADER.format("import_definitions.py") + "\n".join(lines) + "\n"


def summary(name: str, old: str | None, new: str) -> str:
    """One line that says how the tree's file differs from what the import would write."""
    if old is None:
        return f"{name}: missing"
    difference = list(difflib.unified_diff(old.splitlines(), new.splitlines(), n=0, lineterm=""))
    body = [line for line in difference if not line.startswith(("---", "+++", "@@"))]
    added = sum(line.startswith("+") for line in body)
    first = body[0].strip() if body else "line endings"
    return f"{name}: {added} lines to add, {len(body) - added} to remove, first: {first}"


def run(source: Path, output: Path, check: bool, pin: definition_sources.Source | None) -> int:
    """Import every *.xml of `source`; returns the exit status."""
    files = sorted(source.glob("*.xml"))
    if not files:
        raise DefinitionError(f"{source}: no *.xml files")
    results = {path.name: facts(path) for path in files}
    stale = []
    for name, text in results.items():
        target = output / name
        old = target.read_text(encoding="utf-8") if target.is_file() else None
        if old != text:
            stale.append(summary(name, old, text))
            if not check:
                output.mkdir(parents=True, exist_ok=True)
                target.write_text(text, encoding="utf-8", newline="\n")
    if pin is not None and not check:
        pin.sha256 = definition_sources.digests(source)
        definition_sources.save(pin)
        definition_sources.save_written(*output.glob("*.xml"))
    stale.append(f"{len(results)} files, {len(stale)} {'differ' if check else 'written'}")
    print("\n".join(stale))
    return 1 if check and len(stale) > 1 else 0


def main(argv: list[str] | None = None) -> int:
    """Command line entry point."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path, help="directory of upstream XML")
    parser.add_argument("--output", type=Path, default=OUTPUT, help="default: %(default)s")
    parser.add_argument("--check", action="store_true", help="only compare; exit 1 on a difference")
    definition_sources.add_pin(parser)
    options = parser.parse_args(argv)
    try:
        return run(options.source, options.output, options.check, *(options.pin or [None])[:1])
    except DefinitionError as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
