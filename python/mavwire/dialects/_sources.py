"""Reading a dialect's XML and the files it includes, for dialects loaded at run time."""

from __future__ import annotations

import errno
import os
import re
from pathlib import Path

MAX_BYTES = 16 * 1024 * 1024
"""A definition file larger than this is refused."""

MAX_FILES = 64
"""A dialect that includes more files than this is refused."""

# White space is stripped afterwards: matched here, it would take quadratic time.
_INCLUDE = re.compile(r"<include\s*>([^<]*)</include\s*>")


def collect(path: str | os.PathLike[str], name: str | None) -> tuple[str, dict[str, str]]:
    """Main dialect name and the texts of it and its includes, by base name.

    Raises ``FileNotFoundError`` for the main file; an include that is not beside the file including it is left to be
    found among the built-in dialects.
    """
    text = os.fspath(path)
    if text.lstrip()[:1] == "<":
        main = name or "custom"
        return main, {main: text}
    if not text:
        raise FileNotFoundError(errno.ENOENT, "no definition file: the name is empty")
    main = name or Path(text).stem
    sources = {main: _read(Path(text))}
    _add_includes(Path(text).parent, sources[main], sources)
    return main, sources


def told_of(error: Exception, path: str | os.PathLike[str], main: str) -> str:
    """What is wrong with a dialect. The native side knows its texts by base names and calls each a ``.xml``: the main
    one gets the name that it was given by, which may end in something else.
    """
    said, text = str(error), os.fspath(path)
    file = f"{main}.xml:"
    if text.lstrip()[:1] == "<" or not said.startswith(file):
        return said
    return f"{text}:{said.removeprefix(file)}"


def _add_includes(folder: Path, text: str, sources: dict[str, str]) -> None:
    pending = [(folder, include) for include in _includes(text)]
    while pending:
        base, include = pending.pop(0)
        file = base / include
        if file.stem in sources or not file.is_file():
            continue
        if len(sources) >= MAX_FILES:
            raise ValueError(f"{file}: more than {MAX_FILES} included files")
        sources[file.stem] = _read(file)
        pending += [(file.parent, inner) for inner in _includes(sources[file.stem])]


def _includes(text: str) -> list[str]:
    found = (include.strip() for include in _INCLUDE.findall(text))
    return [include for include in found if include]


def _read(file: Path) -> str:
    from mavwire._native import DefinitionError

    if file.exists() and not (file.is_file() or file.is_dir()):
        raise DefinitionError(f"{file}: not a regular file")  # a pipe would be waited on for ever
    with file.open("rb") as source:
        data = source.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise DefinitionError(f"{file}: definition file larger than {MAX_BYTES} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise DefinitionError(f"{file}:{line}: the text is not in UTF-8") from error
