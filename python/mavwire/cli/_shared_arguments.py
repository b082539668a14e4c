"""Options that several tools share, with the names that pymavlink's scripts give them."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any


def add_logs(parser: ArgumentParser) -> None:
    """The logs to read, one or several."""
    parser.add_argument("logs", metavar="LOG", nargs="+", help="telemetry or dataflash log")


def add_condition(parser: ArgumentParser) -> None:
    """Only messages at which an expression holds."""
    parser.add_argument("--condition", help="only while this holds, such as 'VFR_HUD.alt>100'")
    add_user_functions(parser)


def add_user_functions(parser: Any) -> None:
    """Functions of one's own for expressions."""
    parser.add_argument(
        "--user-functions", metavar="FILE", type=_load_functions,
        help="run this Python file; expressions may call its functions",
    )  # fmt: skip


def _load_functions(path: str) -> str:
    from mavwire.cli._errors import CommandError
    from mavwire.expression import load_user_functions

    try:
        load_user_functions(path)
    except OSError as error:
        raise CommandError(f"--user-functions {path}: {error.strerror}") from error
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise CommandError(f"--user-functions {path}: {reason}") from error
    return path


def add_no_timestamps(parser: ArgumentParser) -> None:
    """A raw stream in place of a log."""
    parser.add_argument(
        "--no-timestamps", action="store_true", help="a raw stream without record timestamps"
    )


def add_robust(parser: ArgumentParser) -> None:
    """What pymavlink needs to read damaged raw streams."""
    parser.add_argument("--robust", action="store_true", help="accepted; damage is always skipped")


def add_planner(parser: ArgumentParser) -> None:
    """A format that no program writes any more."""
    parser.add_argument(
        "--planner", action="store_true", help="the planner's old log format (not supported)"
    )


def add_dialect(parser: ArgumentParser) -> None:
    """Which messages there are."""
    parser.add_argument(
        "--dialect", default="ardupilotmega", help="message definitions (default: %(default)s)"
    )
