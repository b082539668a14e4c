"""Events of PX4 in words.

PX4 reports events as EVENT messages: a number and packed arguments. The texts are in the vehicle's
component metadata, a JSON file that may be compressed with xz. docs/events.md is the guide.
"""

from __future__ import annotations

import json
import os
import re
import struct
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from mavwire.component_metadata import MAX_BYTES, Kind, decompressed, fetch

__all__ = ["Event", "EventDefinitions"]

LEVELS = (
    "emergency", "alert", "critical", "error", "warning", "notice", "info", "debug", "protocol",
    "disabled",
)  # fmt: skip

_MAX_TEXT = 2048
_FORMATS = {
    kind: struct.Struct("<" + code)
    for kind, code in zip(
        ("uint8_t", "int8_t", "uint16_t", "int16_t", "uint32_t", "int32_t", "uint64_t", "int64_t", "float"),
        "BbHhIiQqf", strict=True,
    )
}  # fmt: skip
_TOKEN = re.compile(
    r"\\(?P<escaped>.)"
    r"|\{(?P<index>\d{1,2})(?::\.(?P<digits>\d))?(?P<unit>m_v|m\^2|m/s|m|C)?\}"
    r"|<(?P<tag>[a-z]+)(?: +\w+=\"(?P<value>[^\"<>]*)\")?>(?P<content>.*?)</(?P=tag)>",
    re.DOTALL,
)


class Event(NamedTuple):
    """An event. Without a definition it has no name, and its text is the number."""

    id: int
    name: str
    """With the namespace, such as `px4::arming_denied`."""
    group: str
    level: str
    """One of `LEVELS`, for the user."""
    text: str
    description: str
    arguments: dict[str, int | float | str]
    """By name. Enums are texts."""


_NO_DEFINITIONS = (
    json.JSONDecodeError, UnicodeDecodeError, RecursionError, LookupError, TypeError, AttributeError
)  # fmt: skip


class EventDefinitions:
    """The events that a component describes.

    `data` is the JSON, plain or compressed with xz. ValueError says what is wrong with it, and names `source`.
    """

    def __init__(self, data: bytes, source: str = "event definitions") -> None:
        try:
            components = json.loads(decompressed(data))["components"]
            enums = dict(_enums(components))
            self._definitions = dict(_definitions(components, enums))
        except _NO_DEFINITIONS as error:
            text = "not PX4 event definitions (JSON, plain or xz)"
            raise ValueError(f"{source}: {text}") from error
        except ValueError as error:
            raise ValueError(f"{source}: {error}") from None

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> EventDefinitions:
        """The definitions in a file. OSError; ValueError."""
        with open(path, "rb") as file:
            return cls(file.read(MAX_BYTES + 1), os.fspath(path))

    @classmethod
    def of_vehicle(cls, link: Any, timeout: float = 10.0) -> EventDefinitions:
        """The definitions that a vehicle offers over MAVFTP; `mavwire.component_metadata.fetch` explains."""
        return cls(fetch(link, Kind.EVENTS, timeout), "the vehicle's event definitions")

    def __len__(self) -> int:
        return len(self._definitions)

    def event(self, message: Any) -> Event:
        """The event of an EVENT message."""
        level = LEVELS[min(message.log_levels & 15, len(LEVELS) - 1)]
        definition = self._definitions.get(message.id)
        if definition is None:
            return Event(message.id, "", "", level, f"event {message.id}", "", {})
        arguments = dict(definition.decode(bytes(message.arguments)))
        values = list(arguments.values())
        text, description = (
            _filled(text, values) for text in (definition.message, definition.description)
        )
        return Event(
            message.id, definition.name, definition.group, level, text, description, arguments
        )


class _Enum(NamedTuple):
    type: str
    entries: dict[int, str]
    separator: str | None
    """Of the names of bits. None where values are no bit masks."""

    def text(self, value: int) -> str:
        if self.separator is None:
            return self.entries.get(value, f"unknown {value}")
        names, rest = [], value
        for bits, name in self.entries.items():
            if bits and value & bits == bits:
                names.append(name)
                rest &= ~bits
        return self.separator.join([*names, f"unknown {rest}"] if rest else names)


class _Definition(NamedTuple):
    name: str
    group: str
    message: str
    description: str
    arguments: list[tuple[str, str, _Enum | None]]

    def decode(self, packed: bytes) -> Iterator[tuple[str, int | float | str]]:
        """Name and value of each argument up to one of an unknown type."""
        at = 0
        for name, kind, enum in self.arguments:
            form = _FORMATS.get(kind)
            if form is None or at + form.size > len(packed):
                return
            (value,) = form.unpack_from(packed, at)
            at += form.size
            yield name, value if enum is None else enum.text(value)


def _enums(components: Mapping[str, Any]) -> Iterator[tuple[str, _Enum]]:
    for component in components.values():
        for name, enum in component.get("enums", {}).items():
            entries = {
                int(value): str(entry["description"])
                for value, entry in enum.get("entries", {}).items()
            }
            separator = str(enum.get("separator", "|")) if enum.get("is_bitfield") else None
            yield f"{component['namespace']}::{name}", _Enum(enum["type"], entries, separator)


def _definitions(
    components: Mapping[str, Any], enums: Mapping[str, _Enum]
) -> Iterator[tuple[int, _Definition]]:
    for number, component in components.items():
        namespace = component["namespace"]
        for group, content in component.get("event_groups", {}).items():
            for id, event in content.get("events", {}).items():
                yield (
                    int(number) << 24 | int(id),
                    _Definition(
                        f"{namespace}::{event['name']}",
                        group,
                        str(event["message"])[:_MAX_TEXT],
                        str(event.get("description", ""))[:_MAX_TEXT],
                        [_argument(one, namespace, enums) for one in event.get("arguments", [])],
                    ),
                )


def _argument(
    argument: Mapping[str, Any], namespace: str, enums: Mapping[str, _Enum]
) -> tuple[str, str, _Enum | None]:
    kind = argument["type"]
    enum = enums.get(kind if "::" in kind else f"{namespace}::{kind}")
    return str(argument["name"]), kind if enum is None else enum.type, enum


def _filled(text: str, arguments: list[int | float | str], depth: int = 0) -> str:
    """A text with its arguments, and without its marks."""

    def shown(token: re.Match[str]) -> str:
        if token["escaped"]:
            return token["escaped"]
        if token["index"]:
            place = int(token["index"]) - 1
            if not 0 <= place < len(arguments):
                return token[0]
            return _number(arguments[place], token["digits"]) + _unit(token["unit"])
        profile = token["value"] or ""
        for_users = profile == "normal" or (profile[:1] == "!" and profile != "!normal")
        if token["tag"] not in ("a", "param", "profile" if for_users else "a"):
            return ""
        return _filled(token["content"], arguments, depth + 1) if depth < 4 else token["content"]

    return _TOKEN.sub(shown, text).strip()


def _number(value: float | str, digits: str | None) -> str:
    if not isinstance(value, float):
        return str(value)
    return f"{value:.7g}" if digits is None else f"{value:.{digits}f}"


def _unit(unit: str | None) -> str:
    return f" {'m' if unit == 'm_v' else unit}" if unit else ""
