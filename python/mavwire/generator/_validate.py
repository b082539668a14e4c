"""Check a definition file against the schema's rules and say everything that is wrong with it at
once.
"""

from __future__ import annotations

import keyword

from mavwire._native import reserved_name
from mavwire.generator._schema import (
    RESERVED_WORDS,
    SHAPES,
    STRICT_UNITS,
    Group,
    Rule,
    Shape,
)
from mavwire.generator._xml_reader import Element
from mavwire.generator.mavparse import MAVXML

MAX_PROBLEMS = 20
MAX_PAYLOAD = 255

_NAMED = ("enum", "entry", "message", "field")


def schema_problems(root: Element, filename: str, *, strict_units: bool = False) -> list[str]:
    """``file:line:column: what is wrong`` for each problem, at most :data:`MAX_PROBLEMS`."""
    problems: list[str] = []
    pending = [root]
    if root.tag != "mavlink":
        return [f"{_at(filename, root)}: expected the root element <mavlink>, found <{root.tag}>"]
    while pending and len(problems) < MAX_PROBLEMS:
        element = pending.pop()
        shape = SHAPES[element.tag]
        found = [
            *_attribute_problems(element, shape, strict_units),
            *_child_problems(element, shape),
            *_text_problems(element, shape),
        ]
        problems += [f"{_at(filename, where)}: {reason}" for where, reason in found]
        pending += [child for child in reversed(element.children) if child.tag in SHAPES]
    return problems[:MAX_PROBLEMS]


def reserved_word_problems(root: Element, filename: str) -> list[str]:
    """Names that are reserved words of the languages MAVLink is generated for."""
    problems = []
    pending = [root]
    while pending:
        element = pending.pop()
        name = element.attributes.get("name", "")
        if element.tag in _NAMED and name.lower() in RESERVED_WORDS:
            problems.append(
                f"{_at(filename, element)}: {element.tag} name '{name}' is a reserved word of a "
                "target language; choose another name"
            )
        pending += reversed(element.children)
    return problems[:MAX_PROBLEMS]


def module_problems(xml: MAVXML) -> list[str]:
    """What would make a Python module impossible: names that are no identifiers or that it needs for
    itself, payloads that fit no frame.
    """
    problems = []
    for enum in xml.enum:
        where = f"{xml.filename}:{enum.linenumber}: enum {enum.name}"
        found = [_not_a_name(enum.name)]
        found += [_not_a_name(e.name) or reserved_name(e.name, is_field=False) for e in enum.entry]
        problems += [f"{where}: {problem}" for problem in found if problem]
    for message in xml.message:
        where = f"{xml.filename}:{message.linenumber}: message {message.name}"
        found = [_not_a_name(message.name)]
        found += [_not_a_name(f) or reserved_name(f, is_field=True) for f in message.fieldnames]
        problems += [f"{where}: {problem}" for problem in found if problem]
        if message.wire_length > MAX_PAYLOAD:
            problems.append(
                f"{where}: payload of {message.wire_length} bytes; a frame carries {MAX_PAYLOAD}"
            )
    return problems[:MAX_PROBLEMS]


def _not_a_name(name: str) -> str | None:
    if keyword.iskeyword(name):
        return f"name {name[:40]!r} is a Python keyword"
    return None if name.isidentifier() else f"name {name[:40]!r} is not a Python identifier"


def _attribute_problems(
    element: Element, shape: Shape, strict_units: bool
) -> list[tuple[Element, str]]:
    reasons = [
        f"<{element.tag}> needs the attribute '{name}'"
        for name in shape.required
        if name not in element.attributes
    ]
    for name, value in element.attributes.items():
        rule = shape.required.get(name) or shape.optional.get(name)
        if name == "units" and rule and strict_units:
            rule = STRICT_UNITS
        if rule is None:
            reasons.append(f"<{element.tag}> has no attribute '{name}'")
        elif not _fits(value, rule):
            reasons.append(
                f"<{element.tag}> attribute '{name}': '{value[:40]}' is not {rule.wording}"
            )
    return [(element, reason) for reason in reasons]


def _fits(text: str, rule: Rule) -> bool:
    return rule.pattern.fullmatch(text) is not None


def _child_problems(element: Element, shape: Shape) -> list[tuple[Element, str]]:
    position = 0
    children = element.children
    for group in shape.children:
        count = 0
        while position < len(children) and count < group.most:
            if children[position].tag not in group.tags:
                break
            position += 1
            count += 1
        if count < group.least and position == len(children):
            return [(element, f"<{element.tag}> needs {_names(group)}")]
        if count < group.least:
            break
    if position < len(children):
        child = children[position]
        return [(child, f"<{child.tag}> is not expected here: {_order(element.tag, shape)}")]
    if children and children[-1].tag == "extensions":
        return [(element, "<extensions/> needs at least one <field> after it")]
    return []


def _text_problems(element: Element, shape: Shape) -> list[tuple[Element, str]]:
    text = element.text.strip()
    if shape.content is None:
        return [(element, f"<{element.tag}> holds text: '{text[:40]}'")] if text else []
    if not _fits(element.text, shape.content):
        return [(element, f"<{element.tag}>: '{text[:40]}' is not {shape.content.wording}")]
    return []


def _order(tag: str, shape: Shape) -> str:
    order = ", ".join(_names(group) for group in shape.children)
    return f"<{tag}> holds, in this order, {order}" if order else f"<{tag}> holds no elements"


def _names(group: Group) -> str:
    return " or ".join(f"<{tag}>" for tag in group.tags)


def _at(filename: str, element: Element) -> str:
    return f"{filename}:{element.line}:{element.column}"
