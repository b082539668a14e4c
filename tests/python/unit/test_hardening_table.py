"""The hardening table notices what it is there to notice."""

from __future__ import annotations

from typing import Any

import pytest
from hardening import __main__ as table
from hardening import code, links, logs, recovery, rows, signing, wire
from hardening.rows import Figure, at_least, at_most, exactly


def figure(*goals: Any) -> Figure:
    return Figure("a figure", lambda _package, _short: {}, goals)


def test_answers_are_judged_row_by_row() -> None:
    one = figure(at_least(99, 9), at_most(5))
    found = list(table.rows(one, {"kept of 7": 50, "lost": 6, "torn": 4}, {"kept of 9": 1}))
    assert [(name, theirs) for name, theirs, _, _ in found] == [
        ("kept of 7", "-"), ("lost", "-"), ("torn", "-"),
    ]  # fmt: skip
    assert [table.is_met(value, goal, False) for _, _, value, goal in found] == [False, False, True]
    assert table.is_met(50, one.goal(0), True)


def test_what_was_not_measured_is_not_met() -> None:
    failed = list(table.rows(figure(exactly(0)), {"": "no end in 600 s"}, {"": "exit code 1"}))
    assert failed[0][1] == "exit code 1"
    assert not table.is_met(failed[0][2], failed[0][3], True)
    assert not table.is_met("no end", at_most(3), False)


@pytest.mark.parametrize(
    ("answer", "met"),
    [("MAVParseError, 4 ms", True), ("accepted", False), ("no end in 20 s", False), ("crash", False),
     ("TimeoutError, 3 ms", False), ("MAVParseError, 900 ms", False),
     ("ImportError, 0 ms", False)],
)  # fmt: skip
def test_definitions_are_refused_quickly(answer: str, met: bool) -> None:
    assert rows.quickly(answer) is met


def test_a_package_that_does_nothing_meets_no_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_arguments: object) -> Any:
        raise ImportError("broken")

    for name in ("mavutil_of", "capture_of", "parse_xml"):
        monkeypatch.setattr(code, name, broken)
    for title in ("code that is run", "hostile definitions"):
        one = next(figure for figure in rows.FIGURES if figure.title == title)
        found = list(table.rows(one, one.measure("mavwire", True), {}))
        assert len(found) >= 3
        assert not any(table.is_met(value, goal, True) for _, _, value, goal in found)


def test_what_is_harmless_works() -> None:
    assert code.condition_holds("mavwire")
    assert code.enum_is_read("mavwire")
    assert code.log_is_read("mavwire")
    assert list(links.backlog("mavwire", True).values()) == [9, 0]
    assert links.reflection("mavwire", True) == {"it is": "no"}
    assert logs.secrets("mavwire", True) == {"key": "no", "signatures": "no"}


def test_every_must_case_holds() -> None:
    """R30, R32, R34, R37, R38, R39, R40, R41, R43, R44, R45, R46, R47, R48, R50, R31."""
    assert len(signing.CASES) >= 43
    assert [
        name for name, case in signing.CASES.items() if not signing.holds(case, "mavwire")
    ] == []


def test_damage_is_what_it_says() -> None:
    stream, intact = wire.lossy(wire.telemetry(400))
    assert 200 < intact < 400
    assert wire.found("mavwire", stream) >= intact
    assert set(wire.patterns(80)) == {"all 0xFD", "all 0xFE", "random", "zeros", "minimal headers"}


def test_every_intact_record_of_a_damaged_log_is_found() -> None:
    for measure in (recovery.of_telemetry, recovery.of_dataflash):
        assert set(measure("mavwire", True).values()) == {100.0}


def test_a_log_is_damaged_where_it_says() -> None:
    source = recovery.telemetry(200)
    for damage in recovery.DAMAGE.values():
        damaged = damage(source)
        assert 0 < len(damaged.intact) < 200
        for name, one in source.records:
            assert (one in damaged.data) == (name in damaged.intact)
    assert recovery.percent(set(damaged.intact), damaged) == 100.0
    assert recovery.percent(set(list(damaged.intact)[1:]), damaged) < 100.0
