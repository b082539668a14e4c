"""Prints which tests prove each requirement of docs/requirements.md, and fails where none does.

Rust tests name requirements in their names (`r20_r21_rescan_...`), Python tests in their docstrings
("R65: ..."); that of a file proves nothing. With the results of a run, `--junit FILE` of pytest and
`--cargo FILE` of cargo, each test is shown with its outcome, and a requirement fails where one of
its tests failed or was not run, or none passed. Skipped tests are listed at the end.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[1]
REQUIREMENT = re.compile(r"\bR\d+b?\b")
ROW = re.compile(r"^\| (R\d+b?) \| [MSH] \| (.+) \|$", re.MULTILINE)
RUST_TEST = re.compile(r"#\[test\]\s+(?:#\[[^\n]*\]\s+)*fn (\w+)")
# Names begin with numbers: of requirements, and of golden cases.
NUMBER_IN_NAME = re.compile(r"[a-z]\d+b?")
CARGO_LINE = re.compile(r"^test (?:\w+::)*(\w+)(?: - should panic)? \.\.\. (ok|FAILED|ignored)")


@dataclass(frozen=True, order=True)
class Test:
    """A test function; `name` has neither module nor parameters."""

    path: str
    name: str

    def __str__(self) -> str:
        return f"{self.path}::{self.name}"


Coverage = dict[str, list[Test]]
Outcomes = dict[str, set[str]]  # by `str(test)` for Python, by name for Rust


def requirements(text: str) -> dict[str, str]:
    """Number -> what holds, in the order of the table."""
    return dict(ROW.findall(text))


def rust_tests(source: str) -> Iterator[tuple[str, list[str]]]:
    """Name and requirements of each test of a Rust file."""
    for name in RUST_TEST.findall(source):
        numbers = takewhile(NUMBER_IN_NAME.fullmatch, name.split("_"))
        yield name, ["R" + number[1:] for number in numbers if number[0] == "r"]


def python_tests(source: str) -> Iterator[tuple[str, list[str]]]:
    """Name and requirements of each test of a Python file."""
    module = ast.parse(source)
    for node in ast.walk(module):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name.startswith(
            "test_"
        ):
            yield node.name, REQUIREMENT.findall(ast.get_docstring(node) or "")


def collect(root: Path) -> Coverage:
    """Requirement -> the tests that name it."""
    found: defaultdict[str, set[Test]] = defaultdict(set)
    sources = (
        (rust_tests, (root / "rust").rglob("*.rs")),
        (python_tests, (root / "tests" / "python").rglob("test_*.py")),
    )
    for tests_of, paths in sources:
        for path in paths:
            shown = path.relative_to(root).as_posix()
            for name, numbers in tests_of(path.read_text(encoding="utf-8")):
                for number in numbers:
                    found[number].add(Test(shown, name))
    return {number: sorted(tests) for number, tests in found.items()}


def cargo_outcomes(lines: Iterable[str]) -> Outcomes:
    """Outcomes of Rust tests by name, from what `cargo test` prints."""
    found: defaultdict[str, set[str]] = defaultdict(set)
    words = {"ok": "passed", "FAILED": "failed", "ignored": "skipped"}
    for line in lines:
        if match := CARGO_LINE.match(line):
            found[match[1]].add(words[match[2]])
    return found


def junit_outcomes(path: Path) -> Outcomes:
    """Outcomes of Python tests by file and name; none where pytest did not get as far as to write them."""
    found: defaultdict[str, set[str]] = defaultdict(set)
    try:
        results = ElementTree.parse(path)
    except ElementTree.ParseError as error:
        print(f"{path}: no results of pytest: {error}", file=sys.stderr)
        return found
    for case in results.iter("testcase"):
        kinds = {child.tag for child in case}
        outcome = "failed" if kinds & {"failure", "error"} else "passed"
        outcome = "skipped" if "skipped" in kinds else outcome
        name = case.get("name", "").split("[")[0]
        file = case.get("classname", "").replace(".", "/") + ".py"
        found[f"{file}::{name}"].add(outcome)
    return found


def outcome_of(test: Test, outcomes: Outcomes) -> str:
    """`failed` if one of its cases did, `passed` if one passed, else `skipped` or `not run`."""
    key = test.name if test.path.endswith(".rs") else str(test)
    seen = outcomes.get(key, set())
    return next((one for one in ("failed", "passed", "skipped") if one in seen), "not run")


def report(known: dict[str, str], coverage: Coverage, outcomes: Outcomes | None) -> list[str]:
    """Prints the table; what is wrong with it."""
    wrong = [f"{number} is no requirement" for number in sorted(coverage.keys() - known.keys())]
    skipped: set[Test] = set()
    for number, text in known.items():
        tests = coverage.get(number, [])
        print(f"{number}  {text}")
        if not tests:
            wrong.append(f"{number}: no test names it")
        results = {} if outcomes is None else {test: outcome_of(test, outcomes) for test in tests}
        for test in tests:
            print(f"    {results[test] + '  ' if results else ''}{test}")
        wrong += [
            f"{number}: {test} {'failed' if one == 'failed' else 'was not run'}"
            for test, one in results.items()
            if one in ("failed", "not run")
        ]
        skipped |= {test for test, one in results.items() if one == "skipped"}
        if results and "passed" not in results.values():
            wrong.append(f"{number}: none of its tests passed")
    print(f"{len(known)} requirements, {sum(map(len, coverage.values()))} tests of them")
    for test in sorted(skipped):
        print(f"skipped: {test}")
    return wrong


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Which tests prove which requirement.")
    parser.add_argument("--junit", type=Path, help="results of pytest --junitxml")
    parser.add_argument("--cargo", type=Path, help="what cargo test printed")
    options = parser.parse_args(arguments)
    outcomes: Outcomes = {}
    if options.junit:
        outcomes |= junit_outcomes(options.junit)
    if options.cargo:
        with options.cargo.open(encoding="utf-8", errors="replace") as lines:
            outcomes |= cargo_outcomes(lines)
    # None in the results, as of tests that do not even build, are no reason not to look at them.
    has_results = options.junit or options.cargo
    known = requirements((ROOT / "docs" / "requirements.md").read_text(encoding="utf-8"))
    wrong = report(known, collect(ROOT), outcomes if has_results else None)
    for line in wrong:
        print(line, file=sys.stderr)
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
