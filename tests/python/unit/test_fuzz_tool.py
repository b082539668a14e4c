"""`make fuzz` does not pass where nothing was fuzzed, and the workflows run it with nightly Rust."""

from __future__ import annotations

from pathlib import Path

import fuzz as tool
import pytest

WORKFLOWS = Path(__file__).parents[3] / ".github" / "workflows"


def test_without_nightly_it_fails_unless_told_to_go_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(tool, "has_nightly", lambda: False)
    monkeypatch.setenv("CI", "true")
    assert tool.main([]) == 2
    assert "fuzzing needs nightly Rust" in capsys.readouterr().err
    assert tool.main(["--without-nightly", "skip"]) == 0
    assert "NOTHING WAS FUZZED" in capsys.readouterr().err


def test_a_target_that_fails_fails_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tool, "has_nightly", lambda: True)
    monkeypatch.setattr(tool, "build", Path)
    ran = []

    def run(_programs: Path, name: str, seconds: int, _keep: bool, _seed: int) -> bool:
        ran.append((name, seconds))
        return name != "xml"

    monkeypatch.setattr(tool, "run", run)
    assert tool.main(["--seconds", "3"]) == 1
    assert ran == [(name, 3) for name in tool.targets()]
    assert tool.main(["scanner"]) == 0


def test_a_target_that_does_not_exist_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        tool.main(["scanner", "scaner"])
    assert "no target scaner; there are: anonymize, " in capsys.readouterr().err


@pytest.mark.parametrize("wrong", ["0", "-1", "ever"])
def test_targets_are_run_for_some_time(
    wrong: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(tool, "has_nightly", lambda: False)
    with pytest.raises(SystemExit):
        tool.main(["--seconds", wrong])
    assert "argument --seconds: " in capsys.readouterr().err


@pytest.mark.parametrize(("executions", "held"), [(0, False), (7, True)])
def test_a_program_that_tries_nothing_does_not_hold(
    executions: int, held: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tool, "FUZZ", tmp_path)
    program = tmp_path / "scanner"
    program.write_text(f"#!/bin/sh\necho stat::number_of_executed_units: {executions} >&2\n")
    program.chmod(0o755)
    assert tool.run(tmp_path, "scanner", 1, keep=False, seed=1) is held


@pytest.mark.parametrize("name", ["ci", "release"])
def test_workflows_fuzz_with_nightly(name: str) -> None:
    text = (WORKFLOWS / f"{name}.yml").read_text(encoding="utf-8")
    job = text.partition("\n  fuzz:\n")[2].partition("\n\n")[0]
    assert job.index("rustup toolchain install nightly") < job.index("make fuzz SECONDS=")
    assert "continue-on-error" not in job
    assert "without-nightly" not in job
