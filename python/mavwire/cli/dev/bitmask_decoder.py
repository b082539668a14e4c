"""The names of the bits in a field of a message (mavlink_bitmask_decoder.py).

A line for each bit; `!` in front of one says that it is clear.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from mavwire.cli._errors import CommandError
from mavwire.cli._reading import definitions


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("message", help="such as SYS_STATUS")
    parser.add_argument("field", help="such as onboard_control_sensors_health")
    parser.add_argument("value", type=int, help="a decimal number")


def main(args: Namespace) -> int:
    from mavwire import mavutil

    with definitions():
        try:
            bits = mavutil.decode_bitmask(args.message, args.field, args.value)
        except AttributeError as error:
            raise CommandError(f"{args.message}.{args.field}: {error}") from error
    for bit in bits:
        print(f"{' ' if bit.value else '!'} {bit.name or '[UNKNOWN]'}")
    return 0
