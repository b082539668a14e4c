"""Options that several commands share."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from mavwire.cli._errors import CommandError
from mavwire.dialects import UPSTREAM

if TYPE_CHECKING:
    from mavwire.events import EventDefinitions


def _load_functions(path: str) -> str:
    from mavwire.expression import load_user_functions

    try:
        load_user_functions(path)
    except OSError as error:
        raise CommandError(f"--user-functions {path}: {error.strerror}") from error
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise CommandError(f"--user-functions {path}: {reason}") from error
    return path


def _load_events(path: str) -> EventDefinitions:
    from mavwire.events import EventDefinitions

    try:
        return EventDefinitions.read(path)
    except OSError as error:
        raise CommandError(f"--event-definitions {path}: {error.strerror}") from error
    except ValueError as error:
        raise CommandError(f"--event-definitions {error}") from error


class _Several(argparse.Action):
    """The values of an option that may be repeated, in place of its default."""

    def __call__(self, parser: Any, namespace: Any, value: Any, flag: Any = None) -> None:
        before = getattr(namespace, self.dest)
        setattr(namespace, self.dest, [value] if before is self.default else [*before, value])


def _option(*flags: str, **options: Any) -> tuple[tuple[str, ...], dict[str, Any]]:
    return flags, options


def _dialect(default: str) -> tuple[tuple[str, ...], dict[str, Any]]:
    text = "dialect or XML file, may be repeated: the first that knows an id names it (default: %(default)s)"
    return _option("--dialect", default=default, action=_Several, metavar="NAME", help=text)


_SHARED = {
    "log": _option("log", metavar="LOG", help="telemetry or dataflash log"),
    "logs": _option("logs", metavar="LOG", nargs="+", help="telemetry or dataflash log"),
    "condition": _option("--condition", help="only while this holds, such as 'VFR_HUD.alt>100'"),
    "user_functions": _option(
        "--user-functions", metavar="FILE", type=_load_functions,
        help="run this Python file; expressions may call its functions",
    ),
    "no_timestamps": _option(
        "--no-timestamps", action="store_true", help="a raw stream without record timestamps"
    ),
    "robust": _option("--robust", action="store_true", help="accepted; damage is always skipped"),
    "planner": _option(
        "--planner", action="store_true", help="the planner's old log format (not supported)"
    ),
    "dialect": _dialect("ardupilotmega"),
    "any_dialect": _dialect(UPSTREAM),
    "types": _option("--types", help="message types, separated by commas (default: all)"),
    "systems": _option("--systems", help="system ids, separated by commas (default: all)"),
    "system": _option("--system", type=int, metavar="ID", help="default: the first autopilot"),
    "start": _option("--start", help="first time: seconds since 1970, or 2024-01-31T12:00:00"),
    "end": _option("--end", help="first time that is not wanted any more"),
    "event_definitions": _option(
        "--event-definitions", metavar="FILE", type=_load_events,
        help="the texts of PX4's events: JSON, plain or compressed with xz",
    ),
    "image": _option("--image", metavar="FILE", help="draw images, and no windows"),
}  # fmt: skip


def add_shared(parser: Any, *names: str) -> None:
    """Declare shared options; with a condition come functions for it."""
    for name in names:
        flags, options = _SHARED[name]
        parser.add_argument(*flags, **options)
        if name == "condition":
            add_shared(parser, "user_functions")
