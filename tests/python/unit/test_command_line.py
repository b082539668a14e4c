"""Command lines that are understood without argparse mean what argparse makes of them."""

from __future__ import annotations

import importlib
import subprocess
import sys
from argparse import ArgumentParser
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mavwire import cli, traffic
from mavwire._command_line import understood
from mavwire.cli import _parsers

LINES = (
    "a.tlog",
    "a.tlog b.tlog",
    "-",
    "--dialect common a.tlog",
    "--dialect=common a.tlog",
    "--condition MODE.x==1 a.tlog",
    "--condition=-1<ATTITUDE.roll a.tlog",
    "--types HEARTBEAT a.tlog",
    "--mode auto a.tlog",
    "--stats a.tlog",
    "a.tlog --stats",
    "a.tlog -c --qgc",
    "--output out.txt a.tlog",
    "-o out.txt a.tlog",
    "-oout.txt a.tlog",
    "--format json a.tlog",
    "--format nonsense a.tlog",
    "--every 5 a.tlog",
    "--every x a.tlog",
    "--link 1 --link 2 a.tlog",
    "--no-timestamps --robust a.tlog",
    "a.tlog --stats b.tlog",
    "--dial common a.tlog",
    "--dialect= a.tlog",
    "--stats=1 a.tlog",
    "--nonsense a.tlog",
    "-- a.tlog",
    "a.tlog --dialect",
    "",
)


def by_argparse(name: str, command: Any, words: list[str]) -> dict[str, Any] | None:
    """None where it ends the process."""
    try:
        return vars(_parsers.parse(name, command, words))
    except SystemExit:
        return None


@pytest.mark.parametrize("name", sorted(cli.COMMANDS))
def test_each_command_means_the_same(name: str) -> None:
    command: Any = cli.module_of(name)
    for line in LINES:
        found = understood(command.add_arguments, line.split())
        if found is not None:
            assert vars(found) == by_argparse(name, command, line.split()), line


def declare(parser: ArgumentParser) -> None:
    parser.add_argument("logs", metavar="LOG", nargs="+", help="a log")
    parser.add_argument("-n", "--number-of", type=int, default=3)
    parser.add_argument("--kind", choices=("a", "b"), default="a")
    parser.add_argument("--flag", action="store_true")
    parser.add_argument("--no-flag", action="store_false", dest="other")
    parser.add_argument("--many", action="append")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("x", {}),
        ("x y --flag", {"logs": ["x", "y"], "flag": True}),
        ("-n 5 x", {"number_of": 5}),
        ("--number-of=5 --no-flag x", {"number_of": 5, "other": False}),
        ("--kind b x", {"kind": "b"}),
    ],
)
def test_simple_lines_are_understood(line: str, expected: dict[str, Any]) -> None:
    nothing = {
        "logs": ["x"],
        "number_of": 3,
        "kind": "a",
        "flag": False,
        "other": True,
        "many": None,
    }
    found = understood(declare, line.split())
    assert found is not None
    assert vars(found) == nothing | expected


@pytest.mark.parametrize(
    "line",
    ["", "--flag", "-h", "x -n", "-n x", "-n -5 x", "-n5 x", "-n=5 x", "--kind c x", "--fla x",
     "--many 1 x", "x --flag y", "--flag=1 x", "-- x", "--kind= x", "--unknown x"],
)  # fmt: skip
def test_other_lines_are_left_to_argparse(line: str) -> None:
    assert understood(declare, line.split()) is None


@pytest.mark.parametrize(
    "change",
    [
        lambda parser: parser.add_argument("second"),
        lambda parser: parser.add_argument("--size", type=int, default="7"),
        lambda parser: parser.add_argument("--must", required=True),
        lambda parser: parser.add_mutually_exclusive_group(),
        lambda parser: parser.set_defaults(x=1),
    ],
)
def test_unknown_declarations_are_left_to_argparse(change: Any) -> None:
    def declare_more(parser: ArgumentParser) -> None:
        declare(parser)
        change(parser)

    assert understood(declare_more, ["x"]) is None


def test_a_tool_runs_without_argparse_and_version_1(tmp_path: Path) -> None:
    """Neither is needed for a log of MAVLink 2, and both would take a good part of a short run."""
    log = tmp_path / "flight.tlog"
    traffic.generate(log, 200)
    unwanted = {"argparse", "re", "enum", "collections", "contextlib", "functools", "mmap",
                "mavwire.dialects.v10.all", "mavwire.dialects.v10.ardupilotmega"}  # fmt: skip
    for verb in ("parms", "flightmodes", "summarize"):
        code = (
            f"import sys; from mavwire import cli; cli.main([{verb!r}, {str(log)!r}]);"
            f"sys.exit(repr(sorted({unwanted!r} & set(sys.modules)) or ''))"
        )
        command = [sys.executable, "-S", "-c", f"import sys; sys.path[:] = {sys.path!r}; {code}"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        assert done.stderr == "''\n", verb


def test_contexts_are_those_of_contextlib() -> None:
    """But for what they are made of."""
    ours, theirs = ([*contexts(module)] for module in ("mavwire._context", "contextlib"))
    assert ours == theirs


def contexts(module: str) -> Iterator[object]:
    told: list[object] = []

    @importlib.import_module(module).contextmanager
    def context(swallowed: type[BaseException]) -> Iterator[str]:
        told.append("begin")
        try:
            yield "value"
        except swallowed:
            told.append("swallowed")
        except KeyError as error:
            raise OSError("another") from error
        finally:
            told.append("end")

    for raised in (None, ValueError("x"), IndexError("y"), KeyError("z"), KeyboardInterrupt()):
        try:
            with context(ValueError) as value:
                told.append(value)
                if raised is not None:
                    raise raised
        except BaseException as error:
            yield repr(error), repr(error.__cause__), error is raised
    decorated = context(ValueError)(lambda number: told.append(number))
    decorated(1)
    decorated(2)
    yield told
