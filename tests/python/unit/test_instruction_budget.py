"""The gate on instruction counts opens and closes where it says it does."""

from __future__ import annotations

import instruction_budget as gate
import pytest

BUDGET = {"rust/scan": 1000.0, "python/parse": 2000.0}


@pytest.mark.parametrize(
    ("count", "problems"), [(1000.0, 0), (1029.0, 0), (1031.0, 1), (700.0, 0), (5000.0, 1)]
)
def test_three_percent_over_the_budget_fails(count: float, problems: int) -> None:
    assert len(gate.judge({"rust/scan": count}, BUDGET)) == problems


def test_a_path_without_a_budget_fails() -> None:
    assert "rust/new has no budget" in gate.judge({"rust/new": 1.0}, BUDGET)[0]


def test_the_slope_leaves_out_what_is_constant(monkeypatch: pytest.MonkeyPatch) -> None:
    def counted(command: list[str], padding: int) -> int:
        unlucky = 30 if padding else 0
        return 5_000_000 + padding + (300 + unlucky) * int(command[-1])

    monkeypatch.setattr(gate, "instructions", counted)
    assert gate.per_message(["program"], "scan", (1000, 3000), (900, 0, 50)) == 300.0


def test_every_committed_budget_belongs_to_a_path() -> None:
    import json

    kept = json.loads(gate.BUDGET.read_text())["instructions"]
    programs = {
        "rust": gate.RUST,
        "bridge": gate.BRIDGE,
        "python": gate.PYTHON,
        "tables": gate.TABLES,
    }
    paths = {f"{language}/{case}" for language, cases in programs.items() for case in cases}
    assert kept.keys() <= paths
    assert {"rust/scan", "python/parse"} <= kept.keys()


def test_without_valgrind_only_continuous_integration_fails(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(gate.shutil, "which", lambda _: None)
    monkeypatch.setattr(gate.sys, "argv", ["instruction_budget.py"])
    for flag, status in (("true", 1), ("", 0)):
        monkeypatch.setenv("CI", flag)
        assert gate.main() == status
        assert "NOT checked" in capsys.readouterr().err
