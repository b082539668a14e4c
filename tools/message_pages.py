"""Reference pages of messages and enums, as Markdown, out of the facts in message_definitions.

A dialect has a page of the messages that it defines itself and one of its enums; what it includes
has pages of its own. The page of `upstream` has the messages and enums that no other dialect has. Each message and enum
links to mavlink.io. Descriptions are there if `mavwire definitions sync` stored them.
"""

from __future__ import annotations

import re
import tomllib
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mavwire.dialects._descriptions import Texts, stored_folder

ROOT = Path(__file__).resolve().parent.parent
DEFINITIONS = ROOT / "message_definitions" / "v1.0"
UPSTREAM = ROOT / "message_definitions" / "upstream" / "upstream.xml"
MAVLINK_IO = "https://mavlink.io/en/messages"
SUMMARIES = ROOT / "python" / "mavwire" / "_data" / "summaries.toml"
MODULES = ROOT / "python" / "mavwire" / "dialects" / "v20"


@dataclass(frozen=True)
class Summaries:
    """mavwire's own lines, by name."""

    messages: dict[str, str]
    commands: dict[str, str]
    enums: dict[str, str]


class Definition:
    """One definition file."""

    def __init__(self, path: Path) -> None:
        self.name = path.stem
        root = ET.parse(path).getroot()
        self.includes = [Path(one.text or "").stem for one in root.iter("include")]
        self.messages = sorted(root.iter("message"), key=lambda one: int(one.get("id", "0")))
        self.enums = sorted(root.iter("enum"), key=lambda one: one.get("name", ""))
        self.texts: Any = Texts(self.name) if stored_folder().is_dir() else None

    def leave_out(self, others: Sequence[Definition]) -> None:
        """Keep the messages and enums that no other dialect has."""
        known = {one.get("name") for other in others for one in (*other.messages, *other.enums)}
        self.messages = [one for one in self.messages if one.get("name") not in known]
        self.enums = [one for one in self.enums if one.get("name") not in known]

    def link(self, name: str) -> str:
        """The message or enum in the reference of mavlink.io, which has the union under `all`."""
        page = "all" if self.name == UPSTREAM.stem else self.name
        return f"[mavlink.io]({MAVLINK_IO}/{page}.html#{name})"


def pages() -> dict[str, str]:
    """Page -> its Markdown: `index.md`, and for each dialect `<name>.md` and `<name>-enums.md`."""
    definitions = {path.stem: Definition(path) for path in sorted(DEFINITIONS.glob("*.xml"))}
    union = Definition(UPSTREAM)
    union.leave_out([*definitions.values()])
    union.includes = [*definitions]
    definitions[union.name] = union
    summaries = Summaries(**tomllib.loads(SUMMARIES.read_text()))
    found = {"index.md": index_page(definitions)}
    for one in definitions.values():
        if one.messages:
            found[f"{one.name}.md"] = message_page(one, definitions, summaries)
        if one.enums:
            found[f"{one.name}-enums.md"] = enum_page(one, summaries)
    return found


def index_page(definitions: dict[str, Definition]) -> str:
    """Which dialects there are and what they include."""
    rows = [
        (
            f"`{one.name}`",
            linked(len(one.messages), f"{one.name}.md"),
            linked(len(one.enums), f"{one.name}-enums.md"),
            ", ".join(f"`{name}`" for name in one.includes)
            if one.name != UPSTREAM.stem
            else "all of these",
            "yes" if (MODULES / f"{one.name}.py").is_file() else "no",
        )
        for one in definitions.values()
    ]
    return "\n".join([
        "# Messages and enums\n",
        "What each dialect defines itself; what it includes is counted there. `mavwire definitions show NAME` prints",
        "the same on a terminal. One line says what a message is for where it is common; the descriptions of the",
        "upstream definitions are not part of mavwire, and appear everywhere after `mavwire definitions sync`.\n",
        *table(("dialect", "messages", "enums", "includes", "module"), rows),
    ])  # fmt: skip


def linked(count: int, page: str) -> str:
    """A number that leads to its page, if there is anything to see."""
    return f"[{count}]({page})" if count else "0"


def message_page(
    definition: Definition, definitions: dict[str, Definition], summaries: Summaries
) -> str:
    """All messages of a dialect with their fields."""
    homes = enum_homes(definition, definitions)
    lines = [f"# Messages of {definition.name}\n"]
    for message in definition.messages:
        name = message.get("name", "")
        number = f"Id {message.get('id')}. {note(message)}".rstrip()
        text, texts = summaries.messages.get(name, ""), dict[str, str]()
        if definition.texts is not None:
            text, texts = definition.texts.message(name)
        number += f" {definition.link(name)}"
        lines += [f"## {name}\n", f"{flat(text)}\n", f"{number}\n"]
        rows = [
            (
                *field_row(field, extension, homes),
                *described(definition, texts.get(field.get("name", ""))),
            )
            for field, extension in fields(message)
        ]
        head = ("field", "type", "unit", "values", "", *described(definition, "description"))
        lines += [*table(head, rows), ""]
    return "\n".join(lines)


def described(definition: Definition, text: str | None) -> tuple[str, ...]:
    """The cell of a description, where the dialect has descriptions."""
    return () if definition.texts is None else (flat(text or ""),)


def flat(text: str) -> str:
    """A text in one line of Markdown, without markup of its own."""
    return re.sub(r"([\\`*_\[\]<>])", r"\\\1", " ".join(text.split()))


def fields(message: ET.Element) -> Iterator[tuple[ET.Element, bool]]:
    """The fields, and whether each is an extension."""
    extension = False
    for child in message:
        if child.tag == "extensions":
            extension = True
        elif child.tag == "field":
            yield child, extension


def field_row(field: ET.Element, extension: bool, homes: dict[str, str]) -> tuple[str, ...]:
    """The cells of a field."""
    enum = field.get("enum", "")
    values = f"[{enum}]({homes[enum]}-enums.md#{enum.lower()})" if enum in homes else enum
    notes = ["extension"] if extension else []
    notes += ["tells instances apart"] if field.get("instance") == "true" else []
    notes += [f"times {field.get('multiplier')}"] if field.get("multiplier") else []
    notes += [f"unknown: `{field.get('invalid')}`"] if field.get("invalid") else []
    return (
        f"`{field.get('name')}`",
        f"`{field.get('type', '').removesuffix('_mavlink_version')}`",
        field.get("units", ""),
        values,
        ", ".join(notes),
    )


def enum_homes(definition: Definition, definitions: dict[str, Definition]) -> dict[str, str]:
    """Enum -> the dialect whose page has it: the nearest one."""
    homes: dict[str, str] = {}
    pending, seen = [definition.name], set()
    while pending:
        name = pending.pop(0)
        if name in seen or name not in definitions:
            continue
        seen.add(name)
        for enum in definitions[name].enums:
            homes.setdefault(enum.get("name", ""), name)
        pending += definitions[name].includes
    return homes


def enum_page(definition: Definition, summaries: Summaries) -> str:
    """All enums of a dialect; commands with their parameters."""
    lines = [f"# Enums of {definition.name}\n"]
    for enum in definition.enums:
        name = enum.get("name", "")
        bits = "Values are bits. " if enum.get("bitmask") == "true" else ""
        lines += [f"## {name}\n", f"{summaries.enums.get(name, '')}\n"]
        lines += [f"{bits}{note(enum)}{definition.link(name)}\n"]
        rows = []
        for entry in enum.iter("entry"):
            text = definition.texts and definition.texts.entry(name, entry.get("name"))
            row = command_row(entry, summaries) if name == "MAV_CMD" else plain_row(entry)
            rows.append((*row, *described(definition, text)))
        head: tuple[str, ...] = ("value", "name")
        if name == "MAV_CMD":
            head = ("value", "name", "what it does", "parameters")
        lines += [*table((*head, *described(definition, "description")), rows), ""]
    return "\n".join(lines)


def plain_row(entry: ET.Element) -> tuple[str, ...]:
    """An entry: value and name."""
    return entry.get("value", ""), f"`{entry.get('name')}`"


def command_row(entry: ET.Element, summaries: Summaries) -> tuple[str, ...]:
    """A command: value, name, summary, and its parameters that have a label."""
    labels = []
    for param in entry.iter("param"):
        if label := param.get("label"):
            unit = f" ({param.get('units')})" if param.get("units") else ""
            labels.append(f"{param.get('index')}&nbsp;{label}{unit}")
    name = entry.get("name", "")
    return (
        entry.get("value", ""),
        f"`{name}`",
        summaries.commands.get(name, ""),
        ", ".join(labels),
    )


def note(element: ET.Element) -> str:
    """The status of a definition: old, or still subject to change."""
    for tag, word in (("deprecated", "Old"), ("superseded", "Old")):
        found = element.find(tag)
        if found is not None:
            better = found.get("replaced_by")
            return f"{word}; in its place: {better}. " if better else f"{word}. "
    return "Not settled yet. " if element.find("wip") is not None else ""


def table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    """The lines of a Markdown table."""
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    return lines + [
        "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows
    ]
