#!/usr/bin/env python3
"""Write the type stubs of the dialect modules, out of the dialects of the native core.

A dialect module has thousands of names and no source that a type checker could read. The dialect's own
definitions are written once, to `_own/<name>.pyi`; the stub of the module, `<name>.pyi`, gathers
that of the dialect and of all it includes, and its `MAVLink` derives from theirs. Both exist for
each wire protocol, because MAVLink 1 knows neither extension fields nor ids above 255.

The union `upstream` gathers the other dialects as if it included them. Definitions that it has in another form, or not
at all, are in `_own/<name>_replaced.pyi`, which it does not gather.

    tools/generate_stubs.py            # write python/mavwire/dialects/v{10,20}
    tools/generate_stubs.py --check    # exit 1 and name the files that are not up to date
"""

from __future__ import annotations

import argparse
import sys
import textwrap
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path

from mavwire._native import FIELD_TYPES, Dialect, Message, MessageInfo
from mavwire.dialects import UPSTREAM

ROOT = Path(__file__).resolve().parent.parent
DIALECTS = ROOT / "python" / "mavwire" / "dialects"
DEFINITIONS = ROOT / "message_definitions"
PROTOCOLS = {"v10": "1.0", "v20": "2.0"}
OWN = "_own"
REPLACED = "_replaced"
WIDTH = 110
NOTE = "Written by tools/generate_stubs.py."


@dataclass
class Content:
    """The content of one dialect with its includes: text by name, in the dialect's order."""

    name: str
    constants: dict[str, str] = field(default_factory=dict)
    messages: dict[str, str] = field(default_factory=dict)
    methods: dict[str, str] = field(default_factory=dict)


def module_names() -> list[str]:
    """The dialects that have a module."""
    return sorted(path.stem for path in (DIALECTS / "v20").glob("[!_]*.py"))


def includes(name: str) -> list[str]:
    """The dialects that this one names in its definition. The union extends all others."""
    if name == UPSTREAM:
        return [one for one in module_names() if one != UPSTREAM]
    (path,) = DEFINITIONS.glob(f"*/{name}.xml")
    root = ET.parse(path).getroot()
    return [Path(one.text or "").stem for one in root.iter("include")]


def ancestors(name: str) -> list[str]:
    """All that is included, nearest first, each once."""
    found: list[str] = []
    pending = includes(name)
    while pending:
        one = pending.pop(0)
        if one not in found:
            found.append(one)
            pending += includes(one)
    return found


def signature(name: str, parts: list[str], result: str) -> str:
    """A method of a class, over as many lines as it needs."""
    parts = ["self", *parts]
    parts = [f"{part}," for part in parts[:-1]] + [f"{parts[-1]}) -> {result}: ..."]
    parts[0] = f"def {name}({parts[0]}"
    # A line may break behind a comma only.
    text = " ".join(part.replace(" ", "\0") for part in parts)
    wrapper = textwrap.TextWrapper(
        WIDTH,
        initial_indent=" " * 4,
        subsequent_indent=" " * 8,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return wrapper.fill(text).replace("\0", " ")


def base_type(field_type: str) -> str:
    """Type of one value of a field."""
    return "float" if FIELD_TYPES[field_type] else "int"


def parameters(info: MessageInfo, with_version: bool) -> list[str]:
    """Parameters of a constructor, or (`with_version`) of the methods of `MAVLink`."""
    parts = []
    for name, field_type, array_length, is_extension, version in info.parameters:
        kind = base_type(field_type)
        if field_type == "char":
            kind, default = "bytes", 'b""'
        elif array_length:
            kind, default = f"_Sequence[{kind}]", "..."
        else:
            default = "0"
        text = f"{name}: {kind}"
        if is_extension:
            text += f" = {default}"
        elif version is not None and with_version:
            text += f" = {version}"
        parts.append(text)
    return parts


def attributes(info: MessageInfo) -> list[str]:
    """One line per field as it reads on a message, with its unit or enum."""
    lines = []
    for name, field_type, array_length, *_ in info.parameters:
        kind = base_type(field_type)
        if field_type == "char":
            kind = "str"
        elif array_length:
            kind = f"list[{kind}]"
        notes = [info.fieldunits_by_name.get(name), info.fieldenums_by_name.get(name)]
        note = ", ".join(one for one in notes if one)
        lines.append(f"    {name}: {kind}" + (f"  # {note}" if note else ""))
        if field_type == "char":
            lines.append(f"    _{name}_raw: bytes")
    return lines


def message_class(info: MessageInfo) -> str:
    """The class of a message."""
    head = f"class MAVLink_{info.name.lower()}_message(_dialect.MAVLink_message):  # {info.id}"
    return "\n".join(
        [head, *attributes(info), signature("__init__", parameters(info, False), "None")]
    )


def link_methods(info: MessageInfo) -> str:
    """Methods of `MAVLink` for a message."""
    lower = info.name.lower()
    parts = parameters(info, True)
    encode = signature(f"{lower}_encode", parts, f"MAVLink_{lower}_message")
    send = signature(f"{lower}_send", [*parts, "force_mavlink1: bool = False"], "None")
    return f"{encode}\n{send}"


def content(name: str, protocol: str) -> Content:
    """Everything the dialect's module has."""
    dialect = Dialect.builtin(name, protocol)
    made = Content(name)
    dialect.bind({}, lambda info: type(info.name, (Message,), {"_info": info}))
    for message, msgid in dialect.messages():
        info: MessageInfo = dialect.message_class(message)._info
        made.constants[f"MAVLINK_MSG_ID_{message}"] = f": int = {msgid}"
        made.messages[message] = message_class(info)
        made.methods[message] = link_methods(info)
    for enum, _bitmask, _description, entries in dialect.enums():
        for value, entry, *_ in entries:
            # Dialects add entries to an enum, which moves its end.
            end = entry == f"{enum}_ENUM_END"
            made.constants[entry] = ": int" if end else f": int = {value}"
    return made


def own(whole: Content, parts: list[Content]) -> Content:
    """The content of `whole` beyond its includes. ValueError if it has a name with another text."""
    rest = Content(whole.name)
    for kind in ("constants", "messages", "methods"):
        known: dict[str, str] = {}
        for part in parts:
            known |= getattr(part, kind)
        for name, text in getattr(whole, kind).items():
            if name not in known:
                getattr(rest, kind)[name] = text
            elif known[name] != text:
                raise ValueError(f"{whole.name} redefines {name} of a dialect that it includes")
    return rest


def split(part: Content, union: Content) -> tuple[Content, Content]:
    """The part that the union has too, and the rest. A message and its methods stay together."""
    same, replaced = Content(part.name), Content(part.name + REPLACED)
    for name, text in part.constants.items():
        target = same if union.constants.get(name) == text else replaced
        target.constants[name] = text
    for name, text in part.messages.items():
        method = part.methods[name]
        kept = (union.messages.get(name), union.methods.get(name)) == (text, method)
        target = same if kept else replaced
        target.messages[name], target.methods[name] = text, method
    return same, replaced


def own_stub(part: Content) -> str:
    """Text of `_own/<name>.pyi`."""
    lines = [f'"""What dialect {part.name} itself defines. {NOTE}"""', ""]
    if part.messages:
        lines += ["from collections.abc import Sequence as _Sequence", ""]
        lines += ["from mavwire.dialects import _dialect", ""]
    lines += [f"{name}{text}" for name, text in part.constants.items()]
    for text in part.messages.values():
        lines += ["", text]
    lines += ["", "class _Methods:"]
    lines += list(part.methods.values()) or ["    pass"]
    return "\n".join(lines) + "\n"


def link_bases(name: str) -> list[str]:
    """The included dialects whose `MAVLink` is a base: those that no other include brings along."""
    direct = list(dict.fromkeys(includes(name)))
    inherited = {one for other in direct for one in ancestors(other)}
    return [one for one in direct if one not in inherited]


def module_stub(name: str, version: str, parts: list[str]) -> str:
    """Text of `<name>.pyi`, which gathers the stubs `parts`."""
    package = f"mavwire.dialects.{version}"
    lines = [f'"""Dialect {name} for wire protocol {PROTOCOLS[version]}. {NOTE}"""', ""]
    lines += ["from mavwire.dialects import _dialect", "from mavwire.dialects._dialect import *"]
    own = [one for one in parts if one.removesuffix(REPLACED) == name]
    bases = [] if name == UPSTREAM else link_bases(name)
    if name == UPSTREAM:  # each `MAVLink` has methods that it replaces
        own = parts
    lines += [f"from {package} import {one} as _{one}" for one in sorted(bases)]
    lines += [f"from {package}.{OWN} import {one} as _own_{one}" for one in own]
    lines += [f"from {package}.{OWN}.{one} import *" for one in sorted(parts)]
    links = [f"_{one}.MAVLink" for one in bases] or ["_dialect._Link"]
    lines += ["", "class MAVLink("]
    lines += [f"    {one}," for one in (*(f"_own_{one}._Methods" for one in own), *links)]
    lines += ["): ..."]
    return "\n".join(lines) + "\n"


def render() -> dict[Path, str]:
    """All stubs, by path."""
    files: dict[Path, str] = {}
    names = module_names()
    for version, protocol in PROTOCOLS.items():
        folder = DIALECTS / version
        whole = {name: content(name, protocol) for name in names}
        files[folder / OWN / "__init__.pyi"] = f'"""What each dialect itself defines. {NOTE}"""\n'
        parts: dict[str, Content] = {}
        for name in includes(UPSTREAM):
            part = own(whole[name], [whole[one] for one in ancestors(name)])
            parts[name], replaced = split(part, whole[UPSTREAM])
            if replaced.constants or replaced.messages:
                parts[replaced.name] = replaced
        parts[UPSTREAM] = own(whole[UPSTREAM], [parts[one] for one in includes(UPSTREAM)])
        files |= {folder / OWN / f"{part.name}.pyi": own_stub(part) for part in parts.values()}
        for name in names:
            gathered = [name, *ancestors(name)]
            if name != UPSTREAM:
                gathered += [one + REPLACED for one in gathered if one + REPLACED in parts]
            files[folder / f"{name}.pyi"] = module_stub(name, version, gathered)
    return files


def stale(files: dict[Path, str]) -> list[Path]:
    """Files that are missing, different, or there without reason."""
    there = {path for version in PROTOCOLS for path in (DIALECTS / version).rglob("*.pyi")}
    wrong = [
        path
        for path, text in files.items()
        if not path.is_file() or path.read_text(encoding="utf-8") != text
    ]
    return sorted([*wrong, *(there - files.keys())])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing, report differences")
    check = parser.parse_args().check
    files = render()
    wrong = stale(files)
    for path in wrong:
        print(path.relative_to(ROOT))
        if not check and path in files:
            path.parent.mkdir(exist_ok=True)
            path.write_text(files[path], encoding="utf-8")
        elif not check:
            path.unlink()
    size = sum(map(len, files.values()))
    print(f"{len(files)} stubs, {size / 1e6:.2f} MB, {len(wrong)} not up to date")
    return int(check and bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
