"""How two parameter files differ (mavparmdiff.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from mavwire._parameter_file import EXCLUDED, differences, heading, read_parameter_file
from mavwire.cli._errors import CommandError, refused

if TYPE_CHECKING:
    from mavwire.cli.vehicle._param_docs import ParameterDocs


def add_arguments(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("file1", metavar="FILE1", help="parameter file")
    add("file2", metavar="FILE2", help="parameter file")
    add("-t", dest="tabs", action="store_true", help="tabs between the columns")
    add("--full-diff", action="store_true", help="volatile and similar parameters as well")
    add("--hide-only1", action="store_true", help="not what only FILE1 has")
    add("--hide-only2", action="store_true", help="not what only FILE2 has")
    add("--param-docs", action="store_true", help="what values mean; needs one of these two:")
    add(
        "--vehicle",
        help="MAVProxy's 'param download' for Plane, Copter, Rover, Sub, Blimp, Heli...",
    )
    add("--param-xml", metavar="FILE", help="ArduPilot's apm.pdef.xml")


def _documents(args: Namespace) -> ParameterDocs:
    from mavwire.cli.vehicle._param_docs import ParameterDocs, downloaded

    if args.param_xml is not None:
        print(f"param: using xml_filepath={args.param_xml}")
        return ParameterDocs(args.param_xml)
    if args.vehicle is None:
        raise CommandError("--param-docs needs --vehicle or --param-xml", exit_code=2)
    return ParameterDocs(downloaded(args.vehicle))


def main(args: Namespace) -> int:
    value_info = _documents(args).meaning if args.param_docs else None
    excluded = () if args.full_diff else EXCLUDED
    with refused(ValueError):
        first, second = (
            read_parameter_file(path, excluded=excluded) for path in (args.file1, args.file2)
        )
        first.check_any()
        second.check_any()
    second.show_loaded()
    print(f"FILE1: {args.file1}")
    print(f"FILE2: {args.file2}")
    first.show_loaded()
    print(heading(args.tabs))
    for line in differences(
        dict(first.values),
        dict(second.values),
        tabs=args.tabs,
        only_first=not args.hide_only1,
        only_second=not args.hide_only2,
        value_info=value_info,
    ):
        print(line)
    return 0
