"""The parameters of a file that are not at their defaults, which another file has (extract_parms.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from mavwire._parameter_file import read_parameter_file
from mavwire.cli._errors import refused


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("defaults", help="file with the defaults")
    parser.add_argument("params", help="file with parameters; those without a default are left out")


def main(args: Namespace) -> int:
    with refused(ValueError):
        files = [read_parameter_file(path) for path in (args.defaults, args.params)]
        for file in files:
            file.check_any()
    for file in files:
        file.show_loaded()
    defaults, params = (dict(file.values) for file in files)
    for name, value in params.items():
        if name in defaults and value != defaults[name]:
            print(f"{name:<16} {repr(float(value)).removesuffix('.0')}")
    return 0
