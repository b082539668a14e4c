"""When sensors came, went, were switched or failed, by SYS_STATUS (mavsensor_status_change.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from mavwire.cli.logs.bitmask_change import show_changes

FIELDS = ("present", "enabled", "health")


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="telemetry log")


def main(args: Namespace) -> int:
    fields = [f"SYS_STATUS.onboard_control_sensors_{name}" for name in FIELDS]
    return show_changes("sensor_status_change", args.log, fields)
