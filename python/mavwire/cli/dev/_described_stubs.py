"""The type stubs of the dialects with descriptions, for editors, as a partial stub package (PEP 561)."""

from __future__ import annotations

import re
from pathlib import Path

from mavwire import dialects
from mavwire._atomic_file import replace_text
from mavwire.dialects._descriptions import Texts

PACKAGE = "mavwire-stubs"
MESSAGE = re.compile(r"class MAVLink_(\w+)_message\(")
FIELD = re.compile(r" {4}(\w+): ")


def write(folder: Path) -> int:
    """Write the stub package into `folder`; the number of messages that have a description. Raises OSError."""
    package, source = folder / PACKAGE, Path(dialects.__file__).parent
    described = 0
    for stub in source.rglob("v?0/**/*.pyi"):
        lines, count = _described(stub)
        target = package / "dialects" / stub.relative_to(source)
        target.parent.mkdir(parents=True, exist_ok=True)
        replace_text(target, "\n".join([*lines, ""]))
        described += count
    replace_text(package / "py.typed", "partial\n")
    return described


def _described(stub: Path) -> tuple[list[str], int]:
    """The lines of a stub with descriptions, and how many messages have one."""
    texts, fields, described = Texts(stub.stem.removesuffix("_replaced")), dict[str, str](), 0
    lines = []
    for line in stub.read_text(encoding="utf-8").splitlines():
        lines.append(line)
        text = ""
        if found := MESSAGE.match(line):
            text, fields = texts.message(found[1].upper())
            described += bool(text)
        elif found := FIELD.match(line):
            text = fields.get(found[1], "")
        if text:
            escaped = " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')
            lines.append(f'    """{escaped}"""')
    return lines, described
