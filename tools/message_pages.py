"""Reference pages of messages and enums, as Markdown, out of the facts in message_definitions.

A dialect has a page of the messages that it defines itself and one of its enums; what it includes
has pages of its own. Nothing of mavwire is imported, so that no build is needed.
"""

from __future__ import annotations

import tomllib
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEFINITIONS = ROOT / "message_definitions" / "v1.0"
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


def pages() -> dict[str, str]:
    """Page -> its Markdown: `index.md`, and for each dialect `<name>.md` and `<name>-enums.md`."""
    definitions = {path.stem: Definition(path) for path in sorted(DEFINITIONS.glob("*.xml"))}
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
            ", ".join(f"`{name}`" for name in one.includes),
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
        lines += [f"## {name}\n", f"{summaries.messages.get(name, '')}\n", f"{number}\n"]
        rows = [field_row(field, extension, homes) for field, extension in fields(message)]
        lines += [*table(("field", "type", "unit", "values", ""), rows), ""]
    return "\n".join(lines)


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
        lines += [f"## {name}\n", f"{summaries.enums.get(name, '')}\n", f"{bits}{note(enum)}\n"]
        if name == "MAV_CMD":
            rows = [command_row(entry, summaries) for entry in enum.iter("entry")]
            lines += [*table(("value", "name", "what it does", "parameters"), rows), ""]
        else:
            plain = [
                (entry.get("value", ""), f"`{entry.get('name')}`") for entry in enum.iter("entry")
            ]
            lines += [*table(("value", "name"), plain), ""]
    return "\n".join(lines)


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
    """What the definitions say of its standing: old, or not settled yet."""
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
