"""Generate a Python module from definition files: what ``mavwire gen`` and ``mavgen.mavgen(opts,
args)`` do.

Files are checked, read, joined with the files they include and handed to the Python generator.
Other languages are the business of the upstream generator; asking for one says so.
"""

from __future__ import annotations

import errno
import importlib.util
import keyword
import os
import stat
import sys
from collections.abc import Sequence
from typing import Protocol, TypeAlias

from mavwire._wording import guarded_output
from mavwire.generator import mavparse
from mavwire.generator._errors import MAVParseError
from mavwire.generator._sources import included_paths
from mavwire.generator._validate import (
    module_problems,
    reserved_word_problems,
    schema_problems,
)
from mavwire.generator._xml_reader import base_name, read_xml

DEFAULT_WIRE_PROTOCOL = mavparse.PROTOCOL_1_0
DEFAULT_LANGUAGE = "Python"
DEFAULT_VALIDATE = True
DEFAULT_STRICT_UNITS = False
MAXIMUM_INCLUDE_FILE_NESTING = 5

schemaFile: str | None = None
"""No schema file: mavwire checks definitions itself, without lxml."""

supportedLanguages = [
    "Ada",
    "C",
    "CS",
    "JavaScript",
    "JavaScript_Stable",
    "JavaScript_NextGen",
    "TypeScript",
    "Python3",
    "Python",
    "Lua",
    "WLua",
    "ObjC",
    "Spin2",
    "Swift",
    "Java",
    "C++11",
]
"""Language names ``--lang`` accepts. mavwire itself writes Python and Python3."""

_PYTHON = ("python", "python3")
_DIALECT_PACKAGES = {mavparse.PROTOCOL_1_0: "v10", mavparse.PROTOCOL_2_0: "v20"}


_Path: TypeAlias = str | os.PathLike[str]


class _Options(Protocol):
    output: _Path
    wire_protocol: str
    language: str
    validate: bool
    strict_units: bool


class Opts:
    """Options of :func:`mavgen` for callers without a command line."""

    def __init__(
        self,
        output: _Path,
        wire_protocol: str = DEFAULT_WIRE_PROTOCOL,
        language: str = DEFAULT_LANGUAGE,
        validate: bool = DEFAULT_VALIDATE,
        strict_units: bool = DEFAULT_STRICT_UNITS,
    ) -> None:
        self.wire_protocol = wire_protocol
        self.language = language
        self.output = output
        self.validate = validate
        self.strict_units = strict_units


def mavgen(opts: _Options, args: Sequence[_Path]) -> bool:
    """Generate ``opts.output`` from the definition files ``args``; says on stdout what it does.

    False where the files contradict themselves or the language is not Python. Schema violations end
    in SystemExit, as command lines expect; a missing file is a FileNotFoundError, an unreadable one
    a :class:`MAVParseError`.
    """
    opts.language = opts.language.lower()
    filenames = [os.fspath(path) for path in args]
    xml, built_in = _read_files(opts, filenames)
    if mavparse.check_duplicates(xml) or mavparse.missing_enum(xml, _enum_names(built_in)):
        return False
    print(f"Found {mavparse.total_msgs(xml)} MAVLink message types in {len(xml)} XML files")
    if opts.language not in _PYTHON:
        _point_upstream(opts, filenames)
        return False
    problems = [problem for file in xml for problem in module_problems(file)]
    problems += _name_problems(opts.output)
    for problem in problems:
        print(f"ERROR: {problem}")
    if problems:
        return False

    from mavwire.generator import mavgen_python

    mavgen_python.generate(opts.output, xml)
    return True


def _name_problems(output: _Path) -> list[str]:
    """Why no program could import the module, by its name."""
    name = os.path.basename(output).removesuffix(".py")
    if not keyword.iskeyword(name):
        return []
    return [f"{output}: {name!r} is a keyword of Python, so nothing can import it; name another"]


def mavgen_python_dialect(dialect: str, wire_protocol: str) -> bool:
    """Make ``mavwire.dialects.v10|v20.<dialect>`` importable, from XML where it is not built in.

    The XML is ``<dialect>.xml`` in ``$MDEF/v1.0`` or beside the built-in dialects. No file is
    written: the module exists in this process. Raises FileNotFoundError where there is no such XML.
    """
    if wire_protocol not in _DIALECT_PACKAGES:
        raise MAVParseError(f"Unknown MAVLink wire protocol version {wire_protocol}")
    package_name = f"mavwire.dialects.{_DIALECT_PACKAGES[wire_protocol]}"
    package = importlib.import_module(package_name)
    module_name = f"{package_name}.{dialect}"
    if module_name in sys.modules or importlib.util.find_spec(module_name) is not None:
        return True

    from mavwire.dialects import load

    path = _find_definition(dialect, list(package.__path__))
    module = load(path, wire_protocol=wire_protocol, name=dialect)
    sys.modules[module_name] = module
    setattr(package, dialect, module)
    return True


def _find_definition(dialect: str, package_folders: list[str]) -> str:
    folders = list(package_folders)
    if mdef := os.environ.get("MDEF"):
        folders.insert(0, os.path.join(mdef, "v1.0"))
    candidates = [os.path.join(folder, dialect + ".xml") for folder in folders]
    for path in candidates:
        if os.path.isfile(path):
            return path
    raise FileNotFoundError(
        errno.ENOENT, "No definitions of this dialect; looked for", ", ".join(candidates)
    )


def _read_files(opts: _Options, args: Sequence[str]) -> tuple[list[mavparse.MAVXML], set[str]]:
    """The files and their includes, breadth first, each once; and the built-in dialects among the
    includes.
    """
    xml = [_read_file(opts, filename) for filename in args]
    if not xml:
        sys.exit("ERROR: no definition files given")
    known = {os.path.abspath(file.filename) for file in xml}
    built_in: set[str] = set()
    level = list(xml)
    for depth in range(MAXIMUM_INCLUDE_FILE_NESTING + 1):
        wanted = [(path, file) for file in level for path in included_paths(file)]
        level = []
        for path, file in wanted:
            if path in known:
                continue
            if depth == MAXIMUM_INCLUDE_FILE_NESTING:
                sys.exit(f"ERROR: {file.filename}: includes are nested deeper than {depth} levels")
            known.add(path)
            if _is_built_in(path):
                built_in.add(base_name(path))
            else:
                level.append(_read_file(opts, path, included_by=file.filename))
        xml += level
    return xml, built_in


def _is_built_in(path: str) -> bool:
    """Whether an include names a dialect that mavwire has, and no file of the user's."""
    from mavwire.dialects import names

    return not os.path.isfile(path) and base_name(path) in names()


def _read_file(opts: _Options, filename: str, included_by: str | None = None) -> mavparse.MAVXML:
    if not os.path.isfile(filename):
        raise _no_file(filename, f"; {included_by} includes it" if included_by else "")
    if opts.validate:
        print(f"Validating {filename}")
        _validate(filename, opts.strict_units)
    else:
        print(f"Validation skipped for {filename}.")
    print(f"Parsing {filename}")
    return mavparse.MAVXML(filename, opts.wire_protocol)


def _no_file(filename: str, included: str) -> OSError | MAVParseError:
    """What to say of a definition file that is none."""
    try:
        mode = os.stat(filename).st_mode
    except (FileNotFoundError, ValueError):  # the latter for names that no file can have
        return FileNotFoundError(errno.ENOENT, f"No such file{included}", filename)
    except OSError as error:  # such as symbolic links that lead round
        return OSError(error.errno, f"{error.strerror}{included}", filename)
    if stat.S_ISDIR(mode):
        return IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), filename)
    return MAVParseError(f"{filename}: not a regular file{included}")


def _enum_names(dialects: set[str]) -> set[str]:
    modules = [importlib.import_module(f"mavwire.dialects.v20.{name}") for name in dialects]
    return {name for module in modules for name in module.enums}


def _validate(filename: str, strict_units: bool) -> None:
    root = read_xml(filename)
    problems = schema_problems(root, filename, strict_units=strict_units)
    problems = problems or reserved_word_problems(root, filename)
    if problems:
        sys.exit("\n".join(f"ERROR: {problem}" for problem in problems))


def _point_upstream(opts: _Options, args: Sequence[str]) -> None:
    language = next((n for n in supportedLanguages if n.lower() == opts.language), opts.language)
    print(
        f"Unsupported language {language}: mavwire writes Python. "
        "For other languages use the upstream generator:"
    )
    print(
        f"  pip install pymavlink && mavgen.py --lang={language} "
        f"--wire-protocol={opts.wire_protocol} --output={opts.output} {' '.join(args)}"
    )


@guarded_output()
def _main() -> int:
    from mavwire._arguments import PlainParser
    from mavwire.cli import gen

    parser = PlainParser(prog="mavgen", description=gen.__doc__)
    gen.add_arguments(parser)
    return gen.main(parser.parse_args())


if __name__ == "__main__":
    sys.exit(_main())
