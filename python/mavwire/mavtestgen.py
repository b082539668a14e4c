"""Writes a Python module that sends every message of a dialect, with values that tell the fields
apart: pymavlink's `mavtestgen`.

`python -m mavwire.mavtestgen my.xml -o mavtest.py` makes a module with one function,
`generate_outputs(mav)`. The receiver of its messages can check another parser, field by field.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ._arguments import PlainParser
from ._atomic_file import replace_text
from ._text import guarded_output
from .generator import mavparse
from .generator._sources import module_problems

_RANGES = {
    f"{sign}int{bits}_t": (0 if sign else -(1 << bits - 1), 1 << bits)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
_HEAD = '''"""Sends every message once."""


def generate_outputs(mav):
    """Send every message through `mav`, a MAVLink of the dialect."""
'''


def generate(definitions: Sequence[str], output: str, wire_protocol: str = "2.0") -> int:
    """Write the module `output` for the messages of XML files; how many there are.

    Messages of files that these include are not among them. Raises MAVParseError for a file that is
    none, or whose names are no identifiers: they become code. A module that was there is replaced by
    a complete one alone.
    """
    files = [mavparse.MAVXML(name, wire_protocol) for name in definitions]
    if problems := module_problems(files):
        raise mavparse.MAVParseError("\n".join(problems))
    lines = [
        f"    mav.{message.name_lower}_send({_arguments(message)})\n"
        for file in files
        for message in file.message
    ]
    replace_text(output, _HEAD + "".join(lines or ["    pass\n"]))
    return len(lines)


def _arguments(message: Any) -> str:
    """Keyword arguments for all fields but those that a message sets itself."""
    fields = (field for field in message.fields if not field.omit_arg)
    return ", ".join(f"{field.name}={_value(field)!r}" for field in fields)


def _value(field: Any) -> Any:
    """The test value of a field as the field can hold it."""
    value = field.test_value
    if field.type == "char":
        return str(value).encode()
    if isinstance(value, list):
        return [_fitting(field.type, one) for one in value]
    return _fitting(field.type, value)


def _fitting(kind: str, value: Any) -> Any:
    if kind not in _RANGES:
        return value
    lowest, size = _RANGES[kind]
    return (int(value) - lowest) % size + lowest


@guarded_output()
def main(arguments: Sequence[str] | None = None) -> None:
    """The command: XML files and `-o`."""
    parser = PlainParser(description="Write a module that sends every message.")
    parser.add_argument("definitions", nargs="+", metavar="XML", help="message definitions")
    parser.add_argument("-o", "--output", default="mavtest.py", help="default %(default)s")
    parser.add_argument("--wire-protocol", choices=("1.0", "2.0"), default="2.0")
    options = parser.parse_args(arguments)
    try:
        count = generate(options.definitions, options.output, options.wire_protocol)
    except (OSError, mavparse.MAVParseError) as error:
        raise SystemExit(f"mavtestgen: {error}") from error
    print(f"{options.output}: {count} messages")


if __name__ == "__main__":
    main()
