"""When sensors came, went, were switched or failed, by SYS_STATUS (mavsensor_status_change.py)."""

from __future__ import annotations

from mavwire.cli.logs.bitmask_change import show_changes

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

FIELDS = ("present", "enabled", "health")


def add_arguments(parser: ArgumentParser) -> None:
    """mavsensor_status_change.py's argument."""
    parser.add_argument("log", metavar="LOG", help="telemetry log")


def main(args: Namespace) -> int:
    """Run the subcommand."""
    fields = [f"SYS_STATUS.onboard_control_sensors_{name}" for name in FIELDS]
    return show_changes("sensor_status_change", args.log, fields)
