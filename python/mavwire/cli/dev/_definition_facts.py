"""Facts of sets of definitions, and the differences of two sets."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mavwire._native import DefinitionFile, builtin_definitions, definition_union
from mavwire.dialects import _sources, names

Pairs = dict[Any, Any]


@dataclass
class Message:
    """A message: its fields by name, each as a text with type, unit and enum."""

    name: str
    crc_extra: int
    fields: dict[str, str]
    wire: list[tuple[str, str, bool]]
    """Name, type, and whether it is an extension, of each field."""

    @property
    def key(self) -> tuple[str, int]:
        """The part of the definition that its frames prove."""
        return self.name, self.crc_extra


@dataclass
class Facts:
    """Messages by id, and the values of enum entries by enum and name."""

    messages: dict[int, Message] = field(default_factory=dict)
    enums: dict[str, dict[str, int]] = field(default_factory=dict)
    includes: list[str] = field(default_factory=list)

    def add(self, other: Facts) -> None:
        """Add what is not there yet."""
        self.messages = other.messages | self.messages
        for name, entries in other.enums.items():
            self.enums[name] = entries | self.enums.get(name, {})


def parsed(text: str) -> Facts:
    """The facts of what `DefinitionFile.parse` gives."""
    definitions, layouts = json.loads(text)
    facts = Facts(includes=[Path(name).stem for name in definitions["includes"]])
    facts.messages.update(messages_of(definitions, layouts))
    for enum in definitions["enums"]:
        entries = facts.enums.setdefault(enum["name"], {})
        for entry in enum["entries"]:
            entries[entry["name"]] = entry["value"]
    return facts


def messages_of(
    definitions: dict[str, Any], layouts: list[dict[str, Any]]
) -> Iterator[tuple[int, Message]]:
    """The messages of decoded facts with their ids, which a history has several times."""
    for message, layout in zip(definitions["messages"], layouts, strict=True):
        wire = [(row["name"], _type(row), row["is_extension"]) for row in message["fields"]]
        fields = {row["name"]: _described(row) for row in message["fields"]}
        name = message["name"].upper()
        yield message["id"], Message(name, layout["crc_extra"], fields, wire)


def of_file(path: Path) -> Facts:
    """The facts of one file, without those that it includes. Raises OSError or `DefinitionError`."""
    return parsed(DefinitionFile(str(path), _sources.read_text(path)).parse())


def of_set(place: str) -> Facts:
    """The facts of a built-in dialect, of an XML file with its includes, or of all files of a folder. Raises OSError
    or `DefinitionError`.
    """
    if place in names():
        return _gathered(place, {})
    if not os.path.isdir(place):
        main, sources = _sources.collect(place, None)
        return _gathered(main, sources)
    return of_sets([texts_of(Path(place))])


def of_sets(sets: list[dict[str, str]], with_upstream: bool = False) -> Facts:
    """The facts of the union of sets of files, and of the dialect `upstream` behind them. Raises `DefinitionError`."""
    return parsed(definition_union(sets, with_upstream))


def texts_of(folder: Path) -> dict[str, str]:
    """The texts of a folder or checkout by base name. Raises OSError or `DefinitionError`."""
    return {path.stem: _sources.read_text(path) for path in definition_files(folder)}


def definition_files(folder: Path) -> list[Path]:
    """The definition files of a folder, or of a checkout. FileNotFoundError for a folder without any."""
    for below in ("message_definitions/v1.0", "v1.0", "."):
        if files := sorted((folder / below).glob("*.xml")):
            return files
    raise FileNotFoundError(errno.ENOENT, "no definition files (*.xml)", str(folder))


def _gathered(main: str, sources: dict[str, str]) -> Facts:
    """The facts of a file and of all that it includes, the first ones first."""
    facts, seen, pending = Facts(), set(), [main]
    while pending:
        name = pending.pop(0)
        if name not in seen:
            seen.add(name)
            text = sources.get(name)
            one = parsed(
                builtin_definitions(name)
                if text is None
                else DefinitionFile(f"{name}.xml", text).parse()
            )
            facts.add(one)
            pending = one.includes + pending
    return facts


def _type(row: dict[str, Any]) -> str:
    length = row["array_length"]
    return f"{row['field_type']}[{length}]" if length else str(row["field_type"])


def _described(row: dict[str, Any]) -> str:
    extension = "extension" if row["is_extension"] else None
    return " ".join(filter(None, (_type(row), row["units"], row["enum_name"], extension)))


def changes(old: Facts, new: Facts) -> dict[str, Any]:
    """Additions, removals and changes, messages by id and enums by name."""
    messages = _changes(old.messages, new.messages, _message_changes)
    for kind in ("added", "removed"):
        messages[kind] = {id_: message.name for id_, message in messages[kind].items()}
    enums = _changes(old.enums, new.enums, _changes)
    return {"messages": messages, "enums": enums}


def _message_changes(old: Message, new: Message) -> dict[str, Any]:
    change: dict[str, Any] = {}
    if old.name != new.name:
        change["old_name"] = old.name
    if old.crc_extra != new.crc_extra:
        change["crc_extra"] = [old.crc_extra, new.crc_extra]
    fields = _changes(old.fields, new.fields)
    if any(fields.values()):
        change["fields"] = fields
    elif [*old.fields] != [*new.fields]:
        change["order"] = [*new.fields]
    return {"name": new.name} | change if change else {}


def _changes(old: Pairs, new: Pairs, compare: Callable[..., Any] | None = None) -> dict[str, Pairs]:
    """Added and removed values, and of each changed one the pair, or what `compare` gives."""
    changed = {}
    for key in [key for key in old if key in new and old[key] != new[key]]:
        changed[key] = [old[key], new[key]] if compare is None else compare(old[key], new[key])
    return {
        "added": {key: value for key, value in new.items() if key not in old},
        "removed": {key: value for key, value in old.items() if key not in new},
        "changed": {key: change for key, change in changed.items() if change},
    }


def as_text(difference: dict[str, Any]) -> str:
    """A line for each message, enum, field and entry: + added, - removed, ~ changed."""
    messages, enums = difference["messages"], difference["enums"]
    lines = _lines("message", messages, lambda id_, name: f"{name} ({id_})")
    for id_, change in messages["changed"].items():
        was = f", before {change['old_name']}" if "old_name" in change else ""
        seeds = "CRC_EXTRA {} -> {}".format(*change["crc_extra"]) if "crc_extra" in change else ""
        lines.append(f"~ message {change['name']} ({id_}{was}) {seeds}".rstrip())
        if "order" in change:
            lines.append(f"  ~ order of fields: {', '.join(change['order'])}")
        lines += _lines("field", change.get("fields", {}), lambda name, text: f"{name}: {text}", 2)
    lines += _lines("enum", enums, lambda name, _: name)
    for name, change in enums["changed"].items():
        lines.append(f"~ enum {name}")
        lines += _lines("entry", change, lambda name, value: f"{name} = {value}", 2)
    return "\n".join(lines)


def _lines(
    what: str, rows: dict[str, Pairs], text: Callable[[Any, Any], str], indent: int = 0
) -> list[str]:
    """The lines of one kind. Messages and enums that changed have lines of their own."""
    start = " " * indent
    lines = [
        f"{start}{sign} {what} {text(key, value)}"
        for sign, kind in (("+", "added"), ("-", "removed"))
        for key, value in rows.get(kind, {}).items()
    ]
    if indent:
        lines += [
            f"{start}~ {what} {text(key, old)} -> {new}"
            for key, (old, new) in rows.get("changed", {}).items()
        ]
    return lines
