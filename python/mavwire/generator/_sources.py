"""A complete set of definition files as XML text, for a generated module to carry.

The text has no comments and no elements that definitions do not know, and includes are by unique base
name. Everything else is as the user wrote it, descriptions included. The core reads this text
exactly as it reads a file, so a generated module and a file loaded at run time cannot differ.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection

from mavwire._native import DefinitionFile
from mavwire.generator._errors import parse_errors
from mavwire.generator.mavparse import MAVXML, base_name


def standalone_sources(xml: list[MAVXML]) -> tuple[dict[str, str], str]:
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
    return [os.path.abspath(os.path.join(folder, written)) for written in file.include]


def _unused(name: str, taken: Collection[str]) -> str:
    name = _word(name)
    candidate, number = name, 2
    while candidate in taken:
        candidate, number = f"{name}_{number}", number + 1
    return candidate


def _word(name: str) -> str:
    return re.sub(r"\W", "_", name, flags=re.ASCII)


def _file_text(file: MAVXML, names: dict[str, str]) -> str:
    includes = [names.get(path) or _word(base_name(path)) for path in included_paths(file)]
    with parse_errors():
        return DefinitionFile(file.filename, file.text).standalone(includes)


def module_problems(xml: list[MAVXML]) -> list[str]:
    """Why no Python module can be made of files: names that it needs for itself, payloads that fit no
    frame.
    """
    found = (DefinitionFile(file.filename, file.text).module_problem() for file in xml)
    return [problem for problem in found if problem]
