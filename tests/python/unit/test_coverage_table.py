"""docs/coverage.md is what `make coverage-table` writes now, and what that compares is noticed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import api_compare
import coverage_table
import pytest

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


def test_a_page_is_current_or_not() -> None:
    page = "# A\n| a | 1 |\n| dialects.v10.b | 2 |\n| **all** | 3 |\nend\n"
    quick = "# A\n| a | 1 |\n| **all** | 1 |\nend\n"
    assert coverage_table.is_current(page, page, [])
    assert not coverage_table.is_current(page, page.replace("3", "4"), [])
    assert coverage_table.is_current(page, quick, ["dialects.v10.b"])
    assert not coverage_table.is_current(page, quick, ["dialects.v10.b", "dialects.v10.c"])
    assert not coverage_table.is_current(
        page, quick.replace("| a | 1", "| a | 2"), ["dialects.v10.b"]
    )
    assert not coverage_table.is_current("", quick, ["dialects.v10.b"])


@pytest.mark.usefixtures("oracle")
def test_the_page_is_up_to_date_and_has_all_reasons(tmp_path: Path) -> None:
    """In a process of its own, as tests change what modules hold; without the user's own files."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("MAVLINK", "MDEF"))}
    run = subprocess.run(
        [sys.executable, coverage_table.__file__, "--quick"],
        capture_output=True, text=True, env={**clean, "HOME": str(tmp_path)}, check=False,
    )  # fmt: skip
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
