"""Tables of the web inspector's page, as JSON: systems, message types with their rates, new values."""

from __future__ import annotations

import json
import math
import time
from functools import cache

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .bridge import Bridge, Kind

# Kinds of messages, components and messages with values that one page is told of.
MAX_KINDS = 4000
MAX_COMPONENTS = 1000
MAX_OPEN = 64
# Shown instead of an invalid value, such as 65535 mV.
NO_VALUE = "no value"
# Numbers that JavaScript holds exactly.
MAX_SAFE = 2**53


@cache
def _descriptions(native: Any) -> dict[str, tuple[str, dict[str, str]]]:
    """The descriptions of a dialect, which take a while to read."""
    from mavwire.dialects._descriptions import of_messages

    return of_messages(native)


class View:
    """One page's view of a bridge. `tables` and `values` give texts to send to the page."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._open: list[tuple[int, int, int]] = []
        self._described: set[int] = set()

    def hear(self, text: str) -> int:
        """Take in a request of the page. `{"open": [[system, component, message id], ...]}` asks for values.
        `{"seen": number}` reports how many texts the page has shown. This number is returned. ValueError.
        """
        try:
            said = json.loads(text)
            if "seen" in said:
                return _number("seen", said["seen"])
            rows = [tuple(row) for row in said["open"]]
        except (KeyError, TypeError, RecursionError) as error:
            raise ValueError("not a request of the page") from error
        limits = (255, 255, 2**24 - 1)
        for row in rows:
            if len(row) != 3 or not all(
                type(number) is int and 0 <= number <= most
                for number, most in zip(row, limits, strict=True)
            ):
                raise ValueError(f"no kind of message: {row!r}")
        self._open = rows[:MAX_OPEN]
        return 0

    def tables(self) -> str:
        """Links, components and kinds of messages with their counts; BridgeError at the end."""
        kinds, hidden = self._bridge.newest_kinds(MAX_KINDS)
        stats = self._bridge.stats()
        stats["kinds"] = [
            [kind.system, kind.component, kind.id, kind.frames, kind.time, kind.link]
            for kind in kinds
        ]
        stats["time"] = time.time()
        stats["hidden"] = hidden
        stats["hidden_components"] += max(0, len(stats["components"]) - MAX_COMPONENTS)
        del stats["components"][MAX_COMPONENTS:]
        new = {kind.id: kind for kind in kinds if kind.id not in self._described}
        stats["types"] = {str(msgid): self._describe(kind) for msgid, kind in new.items()}
        self._described.update(new)
        if stats["recording"]:
            stats["recording"].pop("path")  # a place on this machine
        return json.dumps(stats)

    def values(self) -> str | None:
        """The newest values of the messages that are open; None if none is."""
        if not self._open:
            return None
        found: dict[str, Any] = {}
        for system, component, msgid in self._open:
            message = self._bridge.latest(msgid, system, component)
            if message is not None:
                fields = self._fields(message)
                found[f"{system}/{component}/{msgid}"] = [message._timestamp, fields]
        return json.dumps({"time": time.time(), "values": found})

    def _describe(self, kind: Kind) -> dict[str, Any]:
        """Name, description and fields of a message: name, type, unit and description of each."""
        text, texts = _descriptions(self._bridge._native_dialect()).get(kind.name, ("", {}))
        message = self._bridge.latest(kind.id, kind.system, kind.component)
        fields = []
        if message is not None:  # which is forgotten where there are very many kinds
            units = message.fieldunits_by_name
            fields = [
                [name, type_name, units.get(name, ""), texts.get(name, "")]
                for name, type_name in zip(message.fieldnames, message.fieldtypes, strict=True)
            ]
        return {"name": kind.name, "description": text, "fields": fields}

    def _fields(self, message: Any) -> list[list[Any]]:
        """Value and meaning of each field. A status text is whole, even if several messages carry it."""
        marks = self._bridge._native_dialect().invalid_fields(bytes(message.get_msgbuf()))
        values = {name: getattr(message, name) for name in message.fieldnames}
        if message.get_type() == "STATUSTEXT":
            sender = message.get_srcSystem(), message.get_srcComponent()
            values["text"] = self._bridge.latest_text(*sender) or values["text"]
        return [
            self._shown(message, name, value, marks.get(name)) for name, value in values.items()
        ]

    def _shown(self, message: Any, name: str, value: Any, marks: list[bool] | None) -> list[Any]:
        """Value and meaning of a field. `marks` says for each element whether it is invalid."""
        if marks is None:
            return [plain(value), self._meaning(message, name, value)]
        if isinstance(value, list | tuple):
            each = zip(value, marks, strict=True)
            return [[NO_VALUE if mark else plain(one) for one, mark in each], ""]
        return [NO_VALUE, ""]

    def _meaning(self, message: Any, field: str, value: object) -> str:
        """The name of an enum's value, the names of the bits of a bit mask, or the text of an event."""
        events = self._bridge.event_definitions
        if field == "id" and events is not None and message.get_type() == "EVENT":
            event = events.event(message)
            return f"{event.level}: {event.text}"
        entries = self._bridge.dialect.enums.get(message.fieldenums_by_name.get(field))
        if entries is None or not isinstance(value, int):
            return ""
        is_mask = message.fielddisplays_by_name.get(field) == "bitmask"
        return " | ".join(
            entry.name
            for number, entry in entries.items()
            if (number and value & number == number if is_mask else value == number)
            and not entry.name.endswith("_ENUM_END")  # which marks the end, and means nothing
        )


def _number(name: str, value: object) -> int:
    if type(value) is not int or value < 0:
        raise ValueError(f"{name} is no number: {value!r}")
    return value


def plain(value: object) -> object:
    """A field's value as JSON and JavaScript can hold it: what they cannot is a text."""
    if isinstance(value, list | tuple):
        return [plain(element) for element in value]
    if isinstance(value, bytes | bytearray):
        return value.decode("utf-8", "replace")
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, int) and abs(value) > MAX_SAFE:
        return str(value)
    return value
