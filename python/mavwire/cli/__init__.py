"""The ``mavwire`` command: one table of subcommands, each imported only when it is chosen.

A subcommand is a module of its name in one of five folders. ``logs`` reads, converts and repairs logs,
``plots`` draws them, ``vehicle`` is about one vehicle, ``bridge`` forwards frames, ``dev`` is for
developers. The module has ``add_arguments(parser)`` and ``main(args) -> int``. ``PASS_THROUGH = True``
marks a command that passes its arguments to another program: ``main`` gets them as a list.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from io import TextIOWrapper
from types import ModuleType
from typing import Any

from mavwire._text import guarded_output
from mavwire.cli import _parsers
from mavwire.cli._errors import CommandError, describe_os_error, tell

COMMANDS = {
    "info": ("logs", "", "what is in a log: types, rates, systems, losses"),
    "dump": ("logs", "mavlogdump", "print the messages of a log as text, JSON or CSV"),
    "convert": ("logs", "", "logs to Parquet, CSV, JSON lines, Arrow or MCAP files"),
    "sql": ("logs", "", "ask logs in SQL: each message type is a table"),
    "ingest": ("logs", "", "many logs to one Delta Lake table for each message type"),
    "cut": ("logs", "", "some records of a telemetry log as a log of their own"),
    "repair": ("logs", "", "the good records of a damaged telemetry log"),
    "anonymize": ("logs", "", "a telemetry log without places and identifiers"),
    "plot": ("plots", "", "fields and formulas over time, as an image or a page"),
    "map": ("plots", "", "where a vehicle was, as a page, KML or GPX"),
    "parms": ("vehicle", "mavparms", "the parameters in logs, or how they changed"),
    "flightmodes": ("logs", "mavflightmodes", "flight modes and the time in each"),
    "mission": ("vehicle", "mavmission", "the mission in a log as a waypoint file"),
    "flighttime": ("logs", "mavflighttime", "how long a vehicle was in the air"),
    "loss": ("logs", "mavloss", "messages lost, by sender and by type"),
    "summarize": (
        "logs",
        "mavsummarize",
        "show start time, place, distance and duration of each flight",
    ),
    "togpx": ("plots", "mavtogpx", "the way of a vehicle as a GPX track"),
    "parmdiff": ("vehicle", "mavparmdiff", "how two parameter files differ"),
    "search": ("logs", "mavsearch", "messages at which a condition holds"),
    "extract": ("logs", "mavextract", "the stretches of a log in flight modes"),
    "msgstats": ("logs", "mavmsgstats", "which message types fill logs"),
    "merge": ("logs", "mavmerge", "two telemetry logs as one"),
    "tomfile": ("logs", "mavtomfile", "a log as a MATLAB script"),
    "bitmask_decoder": ("dev", "mavlink_bitmask_decoder", "the names of the bits in a value"),
    "bitmask_change": ("logs", "mavbitmask_change", "when the bits of a field changed"),
    "sensor_status_change": (
        "logs",
        "mavsensor_status_change",
        "when sensors came, went or failed",
    ),
    "graph": ("plots", "mavgraph", "fields and formulas in a window or an image"),
    "kml": ("plots", "mavkml", "the way of a vehicle in a PX4 log as KML"),
    "playback": ("vehicle", "mavplayback", "a log as if the vehicle flew again"),
    "fft": ("plots", "mavfft", "spectra of the inertial sensors in dataflash logs"),
    "fft_int": ("plots", "mavfft_int", "spectra of stretches selected with the mouse"),
    "fft_isb": ("plots", "mavfft_isb", "spectra of batches of fast samples"),
    "fft_pid": ("plots", "mavfft_pid", "spectra of the terms of PID controllers"),
    "magfit": ("vehicle", "magfit", "compass offsets from what a compass measured"),
    "magfit_WMM": (
        "vehicle",
        "magfit_WMM",
        "compass calibration by the field of the Earth at the place",
    ),
    "gpslock": ("logs", "mavgpslock", "when GPS got and lost its fix"),
    "sigloss": ("logs", "mavsigloss", "when nothing was received for some time"),
    "gps_CEP": ("logs", "mavgps_CEP", "how far the positions of still receivers scatter"),
    "ftpdecode": ("logs", "mavftpdecode", "the files that were sent by FTP"),
    "split_sysid": ("logs", "mavsplit_sysid", "a log as one log for each system"),
    "isb_extract": ("logs", "isb_extract", "batches of fast samples as CSV"),
    "extract_batch_imu": (
        "logs",
        "extract_batch_imu",
        "batches of fast samples as a dataflash log",
    ),
    "extract_parms": ("vehicle", "extract_parms", "parameters that are not at their defaults"),
    "tools": ("dev", "", "give these the names of pymavlink's scripts"),
    "events": ("vehicle", "", "the events of PX4 vehicles in words"),
    "sim": ("vehicle", "", "fly simulated vehicles for a ground station or a test"),
    "bridge": ("bridge", "", "route MAVLink between serial ports, UDP and TCP; record it"),
    "replay": ("bridge", "", "send the frames of a log again, at their pace or faster"),
    "gen": ("dev", "mavgen", "generate a Python dialect module from XML definitions"),
    "definitions": ("dev", "", "show, compare and update message definitions"),
    "run": ("dev", "", "run a program that imports pymavlink on mavwire"),
    "alias": ("dev", "", "let mavwire answer 'import pymavlink' in this environment"),
}
"""Name -> its folder, the pymavlink script that it replaces if there is one, and a line of help."""

EXIT_USAGE = 2
EXIT_INTERRUPTED = 130


def module_of(name: str) -> ModuleType:
    """The module of a command."""
    return import_module(f"{__name__}.{COMMANDS[name][0]}.{name}")


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line, that of the process if it is None; the exit code of the process."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    name = arguments.pop(0) if arguments else ""
    if name == "help":
        name = arguments.pop(0) if arguments else "--help"
        arguments = ["--help"] if name in COMMANDS else []
    try:
        command: Any = module_of(name) if name in COMMANDS else None
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED
    if getattr(command, "PASS_THROUGH", False) and arguments[:1] not in (["-h"], ["--help"]):
        return int(command.main(arguments))
    _prepare_streams()
    with guarded_output(), warnings.catch_warnings():
        warnings.showwarning = _tell_warning
        code = _guarded_main(name, command, arguments)
        _end_output()
        return code


def _tell_warning(message: Warning | str, *_place: object, **_options: object) -> None:
    tell(f"mavwire: {message}")


def _guarded_main(name: str, command: Any, arguments: list[str]) -> int:
    prefix = f"mavwire {name}" if command else "mavwire"
    try:
        code = _run(name, command, arguments)
        sys.stdout.flush()  # so that a full disk is told of here
        return code
    except CommandError as error:
        tell(f"{prefix}: error: {error}")
        return error.exit_code
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED
    except BrokenPipeError:  # the reader (head, less) has gone
        return 0
    except MemoryError:
        hint = "ask for fewer types or a shorter time, or allow the process more"
        tell(f"{prefix}: error: there is not enough memory: {hint}")
        return 1
    except OSError as error:
        tell(f"{prefix}: error: {describe_os_error(error)}")
        return 1


def _run(name: str, command: Any, arguments: list[str]) -> int:
    if command is not None:
        return int(command.main(_parsers.parse(name, command, arguments)))
    if name in ("-h", "--help", ""):
        print(_overview())
        return 0 if name else EXIT_USAGE
    if name in ("-V", "--version"):
        print(_version())
        return 0
    tell(_unknown(name))
    return EXIT_USAGE


def _prepare_streams() -> None:
    """Replace streams that were closed before Python started (`>&-`), and let file names that are not
    UTF-8 be printed.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))
    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="surrogateescape")


def _end_output() -> None:
    """Flush standard output before the process ends. An error was reported before: the interpreter must
    not fail again.
    """
    try:
        sys.stdout.flush()
    except (OSError, ValueError):  # the latter of one that is closed
        _discard_output()


def _discard_output() -> None:
    """Send buffered text nowhere."""
    try:
        descriptor = sys.stdout.fileno()
    except (OSError, ValueError):  # a buffer in memory in its place
        return
    os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)


def _overview() -> str:
    width = max(map(len, COMMANDS))
    lines = [f"  {name:<{width}}  {text}" for name, (_, _, text) in COMMANDS.items()]
    return "\n".join(
        [
            "usage: mavwire COMMAND ...",
            "",
            "MAVLink for Python at wire speed.",
            "",
            *lines,
            "",
            "mavwire help COMMAND says more about one; mavwire --version prints the version.",
        ]
    )


def _unknown(name: str) -> str:
    from mavwire._text import did_you_mean

    hint = did_you_mean(name, COMMANDS) or "; see: mavwire help"
    return f"mavwire: unknown command '{name}'{hint}"


def _version() -> str:
    import mavwire
    from mavwire._alias import COMPATIBLE_VERSION

    return f"mavwire {mavwire.__version__} (compatible with pymavlink {COMPATIBLE_VERSION})"
