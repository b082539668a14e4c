"""Generate a Python dialect module from MAVLink XML definitions.

The files, and those they include, are checked first; the module carries the definitions and needs
mavwire to run. To use a dialect without writing a file, see mavwire.dialects.load.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from mavwire.cli._errors import tell
from mavwire.generator import mavgen
from mavwire.generator.mavparse import PROTOCOL_1_0, PROTOCOL_2_0, MAVParseError


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("definitions", metavar="XML", nargs="+", help="MAVLink definition files")
    parser.add_argument(
        "-o", "--output", default="mavlink", help="module to write [default: %(default)s]"
    )
    parser.add_argument(
        "--lang",
        dest="language",
        choices=mavgen.supportedLanguages,
        default=mavgen.DEFAULT_LANGUAGE,
        help="language of the generated code; all but Python need pymavlink [default: %(default)s]",
    )
    parser.add_argument(
        "--wire-protocol",
        choices=[PROTOCOL_1_0, PROTOCOL_2_0],
        default=mavgen.DEFAULT_WIRE_PROTOCOL,
        help="MAVLink protocol version [default: %(default)s]",
    )
    parser.add_argument(
        "--no-validate",
        action="store_false",
        dest="validate",
        default=mavgen.DEFAULT_VALIDATE,
        help="do not check the files against the MAVLink schema",
    )
    parser.add_argument(
        "--strict-units",
        action="store_true",
        default=mavgen.DEFAULT_STRICT_UNITS,
        help="accept only units of the MAVLink schema",
    )


def main(args: Namespace) -> int:
    """0 when the module was written, 1 when the definitions are wrong; the reason is on stdout or
    stderr.
    """
    try:
        return 0 if mavgen.mavgen(args, args.definitions) else 1
    except MAVParseError as error:
        tell(f"ERROR: {error}")
    except OSError as error:
        tell(f"ERROR: {error.filename}: {error.strerror}")
    return 1
