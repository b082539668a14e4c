"""A message, an enum or an entry of one, as `mavwire definitions show` prints it."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import fill
from typing import Any

from mavwire._text import did_you_mean
from mavwire.cli._errors import CommandError
from mavwire.dialects import _descriptions

WIDTH = 100


def describe(module: Any, name: str) -> str:
    """The definition called `name` in the dialect module, in any letter case, or with this message id.
    CommandError if it is not found.
    """
    wanted = name.upper()
    native = module.MAVLink(None)._dialect
    messages = {cls.msgname: cls for cls in module.mavlink_map.values()}
    messages |= {other: native.message_class(other) for other in native.other_layouts()}
    ids = {str(cls.id): cls for cls in reversed(messages.values())}
    entries = {
        entry.name: (enum, value)
        for enum, values in module.enums.items()
        for value, entry in values.items()
        if not entry.name.endswith("_ENUM_END")
    }
    if cls := messages.get(wanted) or ids.get(wanted):
        others = [one for one in messages.values() if one.id == cls.id and one is not cls]
        return _message(cls, others)
    if wanted in module.enums:
        return _enum(wanted, module.enums[wanted])
    for one in (wanted, f"MAV_CMD_{wanted}"):
        if one in entries:
            enum, value = entries[one]
            return _entry(enum, value, module.enums[enum][value])
    hint = did_you_mean(wanted, [*messages, *module.enums, *entries])
    raise CommandError(f"{module.DIALECT} has no message, enum or command {name!r}{hint}")


def _message(cls: Any, others: list[Any]) -> str:
    """A message, and the other layouts of its id."""
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
    page = _page(f"{info.name} ({info.id})", "" if text == info.name else text, rows)
    layouts = ", ".join(f"{one.msgname} (CRC_EXTRA {one.crc_extra})" for one in others)
    return (
        f"{page}\n\n{fill(f'Other layouts of id {info.id}: {layouts}', WIDTH)}" if others else page
    )


def _enum(name: str, enum: Any) -> str:
    rows = [
        (str(value), entry.name)
        for value, entry in enum.items()
        if not entry.name.endswith("_ENUM_END")
    ]
    bits = "values are bits" if enum.bitmask else ""
    return _page(name, ": ".join(filter(None, [_descriptions.summary("enums", name), bits])), rows)


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
