"""docs/coverage.md is what `make coverage-table` writes now, and what that compares is noticed."""

from __future__ import annotations

import sys
from pathlib import Path

import api_compare
import coverage_table
import pytest

# Dialect modules take half a minute, and `compat/test_dialect_modules.py` compares them; one stands
# for all of them here.
A_DIALECT = "dialects.v20.minimal"

THEIRS = """
import math
from enum import Enum
NUMBER, TEXT, TABLE, SAME = 1, "a", {1: [2.0]}, {"b": float("nan"), "a": ()}
_private = 1
class Wrong(ValueError): pass
class Thing:
    colour = "red"
    def __init__(self, size=1): pass
    def __add__(self, other): return self
    def grow(self, by, at_most=3): pass
    def shrink(self): pass
    @staticmethod
    def make(kind): pass
    @property
    def weight(self): return 1
    def _inner(self): pass
def call(a, b=2): pass
def gone(): pass
"""
OURS = """
NUMBER, TEXT, TABLE, SAME = 2, b"a", {1: [3.0]}, {"a": (), "b": float("nan")}
class Wrong(KeyError): pass
class Thing:
    colour = "blue"
    weight = 3
    def __init__(self, size=2): pass
    def grow(self, by, at_most=3, quickly=False): pass
    @staticmethod
    def make(sort): pass
def call(a, *, b=2): pass
"""
FOUND = {
    "": "",
    "NUMBER": "`2` for `1`",
    "TEXT": "a bytes for a str",
    "TABLE": "another dict",
    "SAME": "",
    "Wrong": "is no ValueError",
    "Thing": "`(size=2)` for `(size=1)`",
    "Thing.colour": "another str",
    "Thing.__add__": "missing",
    "Thing.grow": "`(by, at_most=3, quickly=False)` for `(by, at_most=3)`",
    "Thing.shrink": "missing",
    "Thing.make": "`(sort)` for `(kind)`",
    "Thing.weight": "",
    "call": "`(a, *, b=2)` for `(a, b=2)`",
    "gone": "missing",
}


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two packages with a module of the same name."""
    for package, source in (("their_package", THEIRS), ("our_package", OURS)):
        (tmp_path / package / "inner").mkdir(parents=True)
        (tmp_path / package / "__init__.py").touch()
        (tmp_path / package / "inner" / "__init__.py").touch()
        (tmp_path / package / "things.py").write_text(source)
    (tmp_path / "their_package" / "inner" / "lacking.py").write_text("print('noise')")
    monkeypatch.syspath_prepend(tmp_path)
    yield
    for name in [name for name in sys.modules if name.startswith(("their_pack", "our_pack"))]:
        del sys.modules[name]


@pytest.mark.usefixtures("packages")
def test_every_kind_of_difference_is_found(capsys: pytest.CaptureFixture[str]) -> None:
    names = api_compare.modules("their_package")
    assert names == ["inner", "inner.lacking", "things"]
    assert api_compare.modules("their_package", frozenset(["inner"])) == ["things"]
    rows = list(api_compare.compare_modules("things", "our_package", "their_package"))
    assert {row.name: row.problem for row in rows} == FOUND
    (lacking,) = api_compare.compare_modules("inner.lacking", "our_package", "their_package")
    assert lacking.missing
    assert capsys.readouterr() == ("", "")


@pytest.mark.usefixtures("packages")
def test_a_package_equals_itself() -> None:
    rows = list(api_compare.compare_modules("things", "their_package", "their_package"))
    assert len(rows) == len(FOUND) and not any(row.problem for row in rows)


def test_reasons_are_needed_and_must_be_true() -> None:
    rows = [
        api_compare.Row("mavutil", "a", "function", "missing"),
        api_compare.Row("mavutil", "b", "function", "missing"),
        api_compare.Row("mavutil", "c", "function"),
    ]
    reasons = [coverage_table.Reason(["mavutil.a", "mavutil.c"], "r", "| words of no page |")]
    assert coverage_table.mistakes(rows, reasons) == [
        "no reason: mavutil.b: missing",
        "a reason for no difference: mavutil.c",
        "docs/compatibility.md does not say: | words of no page |",
    ]


@pytest.fixture(scope="module")
def rows(oracle: str) -> list[api_compare.Row]:
    left_out, _ = coverage_table.read_reasons()
    names = api_compare.modules(oracle, frozenset(left_out))
    return coverage_table.find_rows(
        name for name in names if name == A_DIALECT or not name.startswith(coverage_table.DIALECTS)
    )


def test_every_difference_has_a_reason(rows: list[api_compare.Row]) -> None:
    assert coverage_table.mistakes(rows, coverage_table.read_reasons()[1]) == []


def test_the_page_is_up_to_date(rows: list[api_compare.Row], oracle: str) -> None:
    left_out, reasons = coverage_table.read_reasons()
    now = coverage_table.render(rows, reasons, left_out).splitlines()
    page = coverage_table.PAGE.read_text().splitlines()
    others = [
        f"| {name} |"
        for name in api_compare.modules(oracle, frozenset(left_out))
        if name.startswith(coverage_table.DIALECTS) and name != A_DIALECT
    ]
    written = [line for line in page if line.startswith(tuple(others))]
    assert len(written) == len(others), "run: make coverage-table"
    rest = [line for line in page if line not in written and not line.startswith("| **all**")]
    assert rest == [line for line in now if not line.startswith("| **all**")], (
        "run: make coverage-table"
    )
