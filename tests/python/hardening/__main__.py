"""`make hardening`: the table. `--short` is what continuous integration runs: fewer inputs, and of times
only what cannot be a busy machine.

Each figure is measured in a process of its own for each package, which may take ten minutes. Fails
if a figure of mavwire's is not what it must be.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from hardening.rows import FIGURES, Figure

PACKAGES = ("mavwire", "pymavlink")
LINE = "{:<29} {:<40} {:>18} {:>18}  {:<16} {}"
SECONDS = 600


def measure(number: int, package: str, short: bool) -> dict[str, Any]:
    """The answers of one figure, by row; why there are none under an empty name."""
    command = [sys.executable, "-m", "hardening", "--one", str(number), "--package", package]
    command += ["--short"] if short else []
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return {"": f"no end in {SECONDS} s"}
    try:
        answers: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        answers = {}
    if done.returncode or (package == "mavwire" and not answers):
        error = done.stderr.strip().splitlines()[-1:]
        return {"": (error or [f"exit code {done.returncode}"])[0]}
    return answers


def rows(figure: Figure, ours: dict[str, Any], theirs: dict[str, Any]) -> Iterator[list[Any]]:
    """Row, pymavlink's answer, mavwire's, goal."""
    for place, (name, value) in enumerate(ours.items()):
        # A row may be named with how much was tried, and be the same for all that.
        same = list(theirs.values())[place] if len(theirs) == len(ours) else theirs.get(name)
        yield [name, theirs.get("", "-") if same is None else same, value, figure.goal(place)]


def is_met(value: Any, goal: Any, short: bool) -> bool:
    check = goal.loose if short and goal.loose else goal.met
    try:
        return bool(check(value))
    except (TypeError, AttributeError, ValueError):
        return False


def table(figures: list[tuple[int, Figure]], packages: list[str], short: bool) -> int:
    """Prints it; how many figures are not met."""
    failed = 0
    print(LINE.format("", "", "pymavlink 2.4.50", "mavwire", "goal", ""))
    # Side by side where no time is told that matters.
    with ThreadPoolExecutor(2 if short else 1) as pool:
        for number, figure in figures:
            jobs = [pool.submit(measure, number, package, short) for package in packages]
            ours, *others = [job.result() for job in jobs]
            for name, theirs, value, goal in rows(figure, ours, *(others or [{}])):
                met = is_met(value, goal, short)
                failed += not met
                answer = "met" if met else "NOT MET"
                cells = (figure.title, name, str(theirs)[:18], str(value)[:60], goal.text, answer)
                print(LINE.format(*cells), flush=True)
    print(f"{failed} figures are not met" if failed else "all figures are met")
    return failed


def main() -> int:
    parser = argparse.ArgumentParser(prog="make hardening", description=__doc__)
    parser.add_argument("--short", action="store_true", help="a minute instead of many")
    parser.add_argument("--only", default="", help="figures whose title has this in it")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--package", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one is not None:
        print("\n" + json.dumps(FIGURES[options.one].measure(options.package, options.short)))
        return 0
    packages = [name for name in PACKAGES if importlib.util.find_spec(name)]
    chosen = [
        (number, figure)
        for number, figure in enumerate(FIGURES)
        if options.only.lower() in figure.title.lower() and (figure.in_short or not options.short)
    ]
    if not chosen:
        titles = ", ".join(figure.title for figure in FIGURES)
        parser.error(f"no figure to measure has {options.only!r} in its title; there are: {titles}")
    return 1 if table(chosen, packages, options.short) else 0


if __name__ == "__main__":
    sys.exit(main())
