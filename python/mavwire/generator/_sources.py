"""A set of definition files as canonical XML text that stands alone, for a generated module to
carry.

Canonical: no comments, two spaces of indentation, values of enum entries as decimal numbers,
includes by unique base name. Everything else is as the user wrote it, descriptions included. The
core reads this text exactly as it reads a file, so a generated module and a file loaded at run time
cannot differ.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection

from mavwire.generator._enum_value import enum_value
from mavwire.generator._schema import SHAPES
from mavwire.generator._xml_reader import Element, base_name
from mavwire.generator.mavparse import MAVXML

# Not of `xml.sax.saxutils`, which loads the whole of `urllib`.
_TEXT_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", "\r": "&#13;"})
_ATTRIBUTE_ESCAPES = _TEXT_ESCAPES | str.maketrans({'"': "&quot;", "\n": "&#10;", "\t": "&#9;"})


def canonical_sources(xml: list[MAVXML]) -> tuple[dict[str, str], str]:
    """``(sources, main)``: base name to text for each file, and the name to start from.

    Files that no other file includes are starting points; where there are several, a file that
    includes them all is put in front. An include that is not in the list is left for the built-in
    dialects to answer.
    """
    names: dict[str, str] = {}
    for file in xml:
        names[os.path.abspath(file.filename)] = _unused(file.basename, names.values())
    sources = {names[os.path.abspath(file.filename)]: _file_text(file, names) for file in xml}
    mains = [names[path] for path in _starting_points(xml)]
    if len(mains) == 1:
        return sources, mains[0]
    main = _unused("_".join(mains), sources)
    includes = "".join(f"  <include>{name}</include>\n" for name in mains)
    return {main: f"<mavlink>\n{includes}</mavlink>\n", **sources}, main


def _starting_points(xml: list[MAVXML]) -> list[str]:
    """Paths of the first file and of all files that no other one includes."""
    included = {path for file in xml for path in included_paths(file)}
    paths = [os.path.abspath(file.filename) for file in xml]
    return [path for i, path in enumerate(paths) if i == 0 or path not in included]


def included_paths(file: MAVXML) -> list[str]:
    """Absolute paths of a file's includes, which are relative to the file's folder."""
    folder = os.path.dirname(os.path.abspath(file.filename))
    return [os.path.abspath(os.path.join(folder, written.strip())) for written in file.include]


def _unused(name: str, taken: Collection[str]) -> str:
    name = re.sub(r"\W", "_", name, flags=re.ASCII)
    candidate, number = name, 2
    while candidate in taken:
        candidate, number = f"{name}_{number}", number + 1
    return candidate


def _file_text(file: MAVXML, names: dict[str, str]) -> str:
    lines = ["<mavlink>"]
    for path in included_paths(file):
        name = names.get(path) or base_name(path)
        lines.append(f"  <include>{_escaped(name)}</include>")
    for child in file.root.children:
        if child.tag in SHAPES and child.tag != "include":
            _write(child, lines, depth=1)
    return "\n".join([*lines, "</mavlink>", ""])


def _write(element: Element, lines: list[str], depth: int) -> None:
    indent = "  " * depth
    attributes = "".join(f" {n}={_quoted(element, n, v)}" for n, v in element.attributes.items())
    known = [child for child in element.children if child.tag in SHAPES]
    start = f"{indent}<{element.tag}{attributes}"
    text = element.text if SHAPES[element.tag].content else ""
    if not known:
        end = f">{_escaped(text)}</{element.tag}>" if text else "/>"
        lines.append(start + end)
        return
    lines.append(f"{start}>{_escaped(text.strip())}")
    for child in known:
        _write(child, lines, depth + 1)
    lines.append(f"{indent}</{element.tag}>")


def _quoted(element: Element, name: str, value: str) -> str:
    if element.tag == "entry" and name == "value":
        value = str(enum_value(value))
    return f'"{_escaped(value, _ATTRIBUTE_ESCAPES)}"'


def _escaped(text: str, escapes: dict[int, str] = _TEXT_ESCAPES) -> str:
    return text.translate(escapes)
