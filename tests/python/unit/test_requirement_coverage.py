"""The list of requirements has no gap, and the tool that says so notices one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import requirement_coverage as tool

RUST = """
#[test]
fn r20_r9b_frames() {}
#[test]
#[should_panic]
fn e01_r1_cases() {}
#[test]
fn reads_r7() {}
"""
PYTHON = '''"""R65: all of them."""
def test_one():
    """R6, not r7."""
async def test_more():
    """R7."""
def helper():
    """R8."""
class TestMore:
    def test_two(self): pass
'''


def test_every_requirement_has_a_test(capsys: pytest.CaptureFixture[str]) -> None:
    assert tool.main([]) == 0, capsys.readouterr().err
    assert "R9b  version 1 sends no extension fields" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("tests_of", "source", "expected"),
    [
        (
            tool.rust_tests,
            RUST,
            {"r20_r9b_frames": ["R20", "R9b"], "e01_r1_cases": ["R1"], "reads_r7": []},
        ),
        (tool.python_tests, PYTHON, {"test_one": ["R6"], "test_more": ["R7"], "test_two": []}),
    ],
)
def test_tests_name_requirements(
    tests_of: Callable[[str], Iterator[tuple[str, list[str]]]],
    source: str,
    expected: dict[str, list[str]],
) -> None:
    assert dict(tests_of(source)) == expected


def test_a_gap_and_an_unknown_number_are_told() -> None:
    known = {"R1": "frames", "R2": "others"}
    coverage = {"R1": [tool.Test("a.rs", "r1_x")], "R99": [tool.Test("a.rs", "r99_x")]}
    assert tool.report(known, coverage, None) == [
        "R99 is no requirement",
        "R2: no test names it",
    ]


@pytest.mark.parametrize("option", ["--cargo", "--junit"])
def test_results_without_a_test_are_a_failure(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nothing = tmp_path / "results"
    nothing.touch()
    assert tool.main([option, str(nothing)]) == 1
    assert "R1: none of its tests passed" in capsys.readouterr().err


def test_outcomes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = [
        "test scan::tests::r1_x ... ok\n",
        "test r2_y - should panic ... FAILED\n",
        "test result: ok. 3 passed\n",
    ]
    cargo = tool.cargo_outcomes(lines)
    assert cargo == {"r1_x": {"passed"}, "r2_y": {"failed"}}
    path = tmp_path / "junit.xml"
    path.write_text(
        '<testsuites><testsuite><testcase classname="tests.python.unit.test_a" name="test_b[1]"/>'
        '<testcase classname="tests.python.unit.test_a" name="test_b[2]"><skipped/></testcase>'
        '<testcase classname="tests.python.unit.test_a" name="test_c"><error/></testcase>'
        "</testsuite></testsuites>"
    )
    junit = tool.junit_outcomes(path)
    file = "tests/python/unit/test_a.py"
    assert junit == {f"{file}::test_b": {"passed", "skipped"}, f"{file}::test_c": {"failed"}}
    coverage = {
        "R1": [tool.Test("a.rs", "r1_x"), tool.Test(file, "test_b")],
        "R2": [tool.Test("a.rs", "r2_y")],
        "R3": [tool.Test(file, "test_missing")],
    }
    known = dict.fromkeys(("R1", "R2", "R3"), "text")
    assert tool.report(known, coverage, {**cargo, **junit}) == [
        "R2: a.rs::r2_y failed",
        "R2: none of its tests passed",
        f"R3: {file}::test_missing was not run",
        "R3: none of its tests passed",
    ]
    assert f"    passed  {file}::test_b" in capsys.readouterr().out
    one_more = {"R1": [*coverage["R1"], tool.Test(file, "test_later")]}
    outcomes = {**cargo, **junit, f"{file}::test_later": {"skipped"}}
    assert tool.report({"R1": "text"}, one_more, outcomes) == []
    assert capsys.readouterr().out.endswith(f"skipped: {file}::test_later\n")
    one_more["R1"].append(tool.Test("a.rs", "r1_dropped"))
    assert tool.report({"R1": "text"}, one_more, outcomes) == ["R1: a.rs::r1_dropped was not run"]
