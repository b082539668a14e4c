"""Docstrings of message classes and methods, put together when they are first read."""

from __future__ import annotations

from mavwire._native import Dialect, MessageInfo
from mavwire.dialects import _descriptions

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

WIDTH = 70


def _wrapped(text: str, indent: str) -> str:
    text = text.strip()
    if len(indent) + len(text) <= WIDTH and text.isprintable():
        return indent + text
    import textwrap

    return "\n".join(textwrap.wrap(text, WIDTH, initial_indent=indent, subsequent_indent=indent))


def method_doc(dialect: Dialect, info: MessageInfo) -> str:
    """Docstring of ``x_encode`` and ``x_send``: the definition's own description and one line per field.

    A function has its docstring from the beginning, and sending must neither read files nor import
    modules for one. So there is no looking for descriptions elsewhere.
    """
    message, fields = dialect.descriptions(info.name)
    lines = [f"\n{_wrapped(message or info.name, ' ' * 8)}\n"]
    if not message:
        lines.append(f"        mavwire definitions show {info.name} tells what it is for.\n")
    units = info.fieldunits_by_name
    enums = info.fieldenums_by_name
    for name, field_type, *_ in info.parameters:
        notes = f"type:{field_type}" + (f", values:{enums[name]}" if name in enums else "")
        parts = [fields.get(name, ""), f"[{units[name]}]" if name in units else "", f"({notes})"]
        lines.append(f"        {name:<18}        : {' '.join(part for part in parts if part)}")
    return "\n".join(lines) + "\n\n        "


class ClassDoc:
    """``__doc__`` of a message class: the message's description."""

    def __init__(self, dialect: Dialect, info: MessageInfo, texts: _descriptions.Texts) -> None:
        self._parts = (dialect, info, texts)

    def __get__(self, obj: Any, cls: type) -> str:
        dialect, info, texts = self._parts
        message, _ = texts.of(dialect, info.name)
        return f"\n{_wrapped(message or info.name, '    ')}\n    "
