"""Definition files as text: one file, or a dialect's file with the files it includes."""

from __future__ import annotations

import codecs
import errno
import os
import re

TYPE_CHECKING = False
if TYPE_CHECKING:
    from pathlib import Path

MAX_BYTES = 16 * 1024 * 1024
"""A definition file larger than this is refused."""

MAX_FILES = 64
"""A dialect that includes more files than this is refused."""

# White space is stripped afterwards: matched here, it would take quadratic time.
_INCLUDE = re.compile(r"<include\s*>([^<]*)</include\s*>")
_DECLARATION = re.compile(rb"""<\?xml[^>]{0,200}?encoding\s{0,9}=\s{0,9}["']([\w-]{1,40})""")
# Others take more than linear time, or are no encodings of text.
_ENCODING = re.compile(
    r"utf-?(8(-sig)?|16)|(us-)?ascii|(iso-?8859|latin|koi8|windows|cp)[\w-]*", re.I
)


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
    from pathlib import Path  # which takes longer to import than most files to read

    main = name or Path(text).stem
    sources = {main: read_text(text)}
    _add_includes(Path(text).parent, sources[main], sources)
    return main, sources


def told_of(error: Exception, path: str | os.PathLike[str], main: str) -> str:
    """The text of an error in a dialect. The native side calls each file by its base name with ``.xml``. The main file
    gets back the name that it was given by, which may end in something else.
    """
    said, text = str(error), os.fspath(path)
    file = f"{main}.xml:"
    if text.lstrip()[:1] == "<" or not said.startswith(file):
        return said
    return f"{text}:{said.removeprefix(file)}"


def _add_includes(folder: Path, text: str, sources: dict[str, str]) -> None:
    pending = [(folder, include) for include in includes(text)]
    while pending:
        base, include = pending.pop(0)
        file = base / include
        if file.stem in sources or not file.is_file():
            continue
        if len(sources) >= MAX_FILES:
            raise ValueError(f"{file}: more than {MAX_FILES} included files")
        sources[file.stem] = read_text(file)
        pending += [(file.parent, inner) for inner in includes(sources[file.stem])]


def includes(text: str) -> list[str]:
    """The paths that a definition file includes. A comment includes nothing."""
    first, *others = text.split("<!--")
    text = "".join([first, *(one.partition("-->")[2] for one in others)])
    found = (include.strip() for include in _INCLUDE.findall(text))
    return [include for include in found if include]


def read_text(file: str | os.PathLike[str]) -> str:
    """The text of a definition file in the encoding that it declares. Raises OSError or ``DefinitionError``."""
    from mavwire._native import DefinitionError

    if os.path.exists(file) and not (os.path.isfile(file) or os.path.isdir(file)):
        raise DefinitionError(
            f"{file}: not a regular file"
        )  # open() would wait for the writer of a pipe
    with open(file, "rb") as source:
        data = source.read(MAX_BYTES + 1)
    return decode(data, file)


def decode(data: bytes, file: str | os.PathLike[str]) -> str:
    """Text in the encoding that it declares. ``file`` is its name for the ``DefinitionError``."""
    from mavwire._native import DefinitionError

    if len(data) > MAX_BYTES:
        raise DefinitionError(f"{file}: definition file larger than {MAX_BYTES} bytes")
    encoding = _encoding(data)
    try:
        if not _ENCODING.fullmatch(encoding):
            raise LookupError(f"unknown encoding: {encoding}")
        return data.decode(encoding).removeprefix("\ufeff")
    except (LookupError, UnicodeError) as error:
        line = data.count(b"\n", 0, getattr(error, "start", 0)) + 1
        reason = f"text not in {encoding.upper()}" if isinstance(error, UnicodeError) else error
        failure = DefinitionError(f"{file}:{line}:1: not well-formed XML: {reason}")
        failure.lineno, failure.offset = line, 0  # type: ignore[attr-defined]
        raise failure from None


def _encoding(data: bytes) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    declared = _DECLARATION.match(data)
    return declared[1].decode() if declared else "utf-8"
