"""A message, an enum or an entry of one, as `mavwire definitions show` prints it."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import fill
from typing import Any

from mavwire._text import did_you_mean
from mavwire.cli._errors import CommandError
from mavwire.dialects import _summaries

WIDTH = 100


def describe(module: Any, name: str) -> str:
    """What the dialect module has under `name`, in any letter case, or under a message id. CommandError if there is
    nothing.
    """
    if name.isdecimal() and int(name) in module.mavlink_map:
        return _message(module.mavlink_map[int(name)])
    wanted = name.upper()
    messages = {cls.msgname: cls for cls in module.mavlink_map.values()}
    entries = {
        entry.name: (enum, value)
        for enum, values in module.enums.items()
        for value, entry in values.items()
        if not entry.name.endswith("_ENUM_END")
    }
    if wanted in messages:
        return _message(messages[wanted])
    if wanted in module.enums:
        return _enum(wanted, module.enums[wanted])
    for one in (wanted, f"MAV_CMD_{wanted}"):
        if one in entries:
            enum, value = entries[one]
            return _entry(enum, value, module.enums[enum][value])
    hint = did_you_mean(wanted, [*messages, *module.enums, *entries])
    raise CommandError(f"{module.DIALECT} has no message, enum or command {name!r}{hint}")


def _message(cls: Any) -> str:
    info = cls._info
    rows = []
    for name, base, length, extension, _ in info.parameters:
        notes = [
            info.fieldenums_by_name.get(name, ""),
            "tells instances apart" if name == info.instance[0] else "",
            "extension" if extension else "",
        ]
        rows.append(
            (
                name,
                f"{base}[{length}]" if length else base,
                info.fieldunits_by_name.get(name, ""),
                ", ".join(filter(None, notes)),
            )
        )
    text = " ".join(cls.__doc__.split())
    return _page(f"{info.name} ({info.id})", "" if text == info.name else text, rows)


def _enum(name: str, enum: Any) -> str:
    rows = [
        (str(value), entry.name)
        for value, entry in enum.items()
        if not entry.name.endswith("_ENUM_END")
    ]
    bits = "values are bits" if enum.bitmask else ""
    return _page(name, ": ".join(filter(None, [_summaries.summary("enums", name), bits])), rows)


def _entry(enum: str, value: int, entry: Any) -> str:
    rows = [(str(index), label) for index, label in entry.label.items()]
    return _page(f"{entry.name} ({value} of {enum})", entry.description, rows)


def _page(title: str, text: str, rows: Iterable[tuple[str, ...]]) -> str:
    """The title, what there is to say, and a table without a head."""
    rows = list(rows)
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [title, *([fill(text, WIDTH)] if text else []), *([""] if rows else [])]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        lines.append(f"  {'  '.join(cells)}".rstrip())
    return "\n".join(lines)
