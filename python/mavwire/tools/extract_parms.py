"""The parameters of a file that are not at their defaults, which another file has (extract_parms.py)."""

from __future__ import annotations

from mavwire.cli._errors import CommandError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavwire.mavparm import MAVParmDict


def add_arguments(parser: ArgumentParser) -> None:
    """extract_parms.py's options."""
    parser.add_argument("defaults", help="file with the defaults")
    parser.add_argument("params", help="file with parameters; those without a default are left out")


def main(args: Namespace) -> int:
    """Run the subcommand."""
    defaults, params = _load(args.defaults), _load(args.params)
    for name, value in params.items():
        if name in defaults and value != defaults[name]:
            print(f"{name:<16} {repr(float(value)).removesuffix('.0')}")
    return 0


def _load(path: str) -> MAVParmDict:
    """A parameter file; CommandError for a mistake in it."""
    from mavwire.mavparm import MAVParmDict

    found = MAVParmDict()
    found._must_exist = True
    try:
        found.load(path)
    except ValueError as error:
        raise CommandError(str(error)) from error
    return found


if __name__ == "__main__":
    from mavwire.tools._script import run

    run(__file__)
