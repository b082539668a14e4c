#!/usr/bin/env python3
"""Write message_definitions/upstream/history.xml: layouts that message ids had before, told apart by CRC_EXTRA.

    tools/import_history.py path/to/history.json path/to/mavlink path/to/ardupilot

The input lists every definition in the history of both upstreams: id, name, crc_extra, first_commit, last_commit, files
and fields as [name, type, array length or null, "ext" for an extension]. Where two layouts have one id and CRC_EXTRA,
that of the checkouts counts. The output leaves out the layouts that
upstream.xml has, those of MAVLink 0.9, those of test dialects, mistakes that were mended within two weeks, and a
message that is too long for a frame.
"""

from __future__ import annotations

import argparse
import json
import sys
import xml.etree.ElementTree as ET
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import definition_sources
from definition_sources import HISTORY, UNION, Accepted
from import_definitions import HEADER, write_element
from mavwire import _native
from mavwire.cli.dev._definition_facts import Facts, definition_files, parsed

SHORTEST_LIFE = timedelta(days=14)
# MAVLink 1.0 came in September 2011. The files of 0.9 were deleted much later.
FIRST_OF_MAVLINK_1 = "2011-09-01"
END_OF_MAVLINK_0_9 = "2017-06-21"
MAX_PAYLOAD = 255
TESTS = {"test.xml", "python_array_test.xml"}


def is_kept(row: dict[str, Any], current: dict[int, int]) -> bool:
    """Whether frames of this layout are likely to be found in logs."""
    first, last = row["first_commit"], row["last_commit"]
    is_old = last < FIRST_OF_MAVLINK_1 or (
        last == END_OF_MAVLINK_0_9 and first < FIRST_OF_MAVLINK_1
    )
    lived = date.fromisoformat(last) - date.fromisoformat(first)
    is_test = set(row["files"]) <= TESTS
    is_current = current.get(row["id"]) == row["crc_extra"]
    is_too_long = payload_len(row) > MAX_PAYLOAD
    return not (is_old or is_test or is_current or is_too_long) and lived >= SHORTEST_LIFE


def layouts_of_today(folders: list[Path]) -> dict[tuple[int, int], dict[str, Any]]:
    """Name and fields of each layout in the files of some checkouts, by id and CRC_EXTRA."""
    found = {}
    for path in (path for one in folders for path in definition_files(one)):
        text = path.read_text(encoding="utf-8-sig")
        definitions, layouts = json.loads(_native.DefinitionFile(str(path), text).parse())
        for message, layout in zip(definitions["messages"], layouts, strict=True):
            fields = [
                [one["name"], one["field_type"], one["array_length"] or None]
                + ["ext"] * one["is_extension"]
                for one in message["fields"]
            ]
            found[message["id"], layout["crc_extra"]] = {"name": message["name"], "fields": fields}
    return found


def payload_len(row: dict[str, Any]) -> int:
    """Bytes of all fields."""
    sizes = [
        _native.field_type(kind)[2] * next((one for one in rest if isinstance(one, int)), 1)
        for _, kind, *rest in row["fields"]
    ]
    return sum(sizes)


def element(row: dict[str, Any]) -> ET.Element:
    """The message as XML."""
    message = ET.Element("message", id=str(row["id"]), name=row["name"])
    ET.SubElement(message, "description")
    for field, base, *rest in row["fields"]:
        if "ext" in rest and message.find("extensions") is None:
            ET.SubElement(message, "extensions")
        lengths = [one for one in rest if isinstance(one, int)]
        kind = f"{base}[{lengths[0]}]" if lengths else base
        ET.SubElement(message, "field", type=kind, name=field)
    return message


def text(rows: list[dict[str, Any]]) -> str:
    """All of them as one file, with the time and the files of each as a comment."""
    lines = ["<mavlink>", "  <messages>"]
    for row in rows:
        files = ", ".join(row["files"])
        use = f"{row['first_commit']} to {row['last_commit']}, {files}"
        lines.append(f"    <!-- CRC_EXTRA {row['crc_extra']}, {use} -->")
        write_element(element(row), 2, lines)
    return (
        HEADER.format("import_history.py")
        + "\n".join([*lines, "  </messages>", "</mavlink>"])
        + "\n"
    )


def keep(old: str, union: Facts, accepted: list[Accepted]) -> None:
    """Add the layouts to the history that the old text of the union has, and the union does not have any more."""
    text = HISTORY.read_text(encoding="utf-8")
    definitions, layouts = json.loads(_native.DefinitionFile("history", text).parse())
    rows = zip(definitions["messages"], layouts, strict=True)
    known = {(row["id"], layout["crc_extra"]) for row, layout in rows}
    known |= {(id_, message.crc_extra) for id_, message in union.messages.items()}
    before = parsed(_native.DefinitionFile("upstream", old).parse()).messages
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
    parser.add_argument("history", type=Path, metavar="history.json")
    parser.add_argument("folders", type=Path, nargs="*", metavar="DIR", help="checkouts")
    parser.add_argument("--output", type=Path, default=HISTORY, help="default: %(default)s")
    options = parser.parse_args(argv)
    union, layouts = json.loads(
        _native.DefinitionFile("upstream", UNION.read_text(encoding="utf-8")).parse()
    )
    current = {
        message["id"]: layout["crc_extra"]
        for message, layout in zip(union["messages"], layouts, strict=True)
    }
    today = layouts_of_today(options.folders)
    rows = [
        row | today.get((row["id"], row["crc_extra"]), {})
        for row in json.loads(options.history.read_bytes())
        if is_kept(row, current)
    ]
    rows.sort(key=lambda row: (row["id"], row["first_commit"], row["crc_extra"]))
    written = text(rows)
    _, layouts = json.loads(_native.DefinitionFile("history", written).parse())
    for row, layout in zip(rows, layouts, strict=True):
        if layout["crc_extra"] != row["crc_extra"]:
            print(
                f"error: {row['id']} {row['name']}: CRC_EXTRA of the fields is {layout['crc_extra']}, "
                f"not {row['crc_extra']}",
                file=sys.stderr,
            )
            return 1
    options.output.write_text(written, encoding="utf-8", newline="\n")
    if options.output == HISTORY:
        definition_sources.save_written(HISTORY)
    print(f"{len(rows)} layouts of {len({row['id'] for row in rows})} ids")
    return 0


if __name__ == "__main__":
    sys.exit(main())
