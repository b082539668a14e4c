"""`make soak` comes through, and notices what it is there to notice."""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

SOAK = Path(__file__).parents[3] / "benches" / "soak.py"


def module() -> Any:
    spec = importlib.util.spec_from_file_location("soak", SOAK)
    assert spec is not None and spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs /proc")
def test_a_short_flight_comes_through(tmp_path: Path) -> None:
    """Slowly, beside hostile peers."""
    kept = tmp_path / "soak.json"
    command = [sys.executable, str(SOAK), "--seconds", "2", "--rate", "300",
               "--log-bytes", "10000", "--hostile", "--json", str(kept)]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert "600 frames sent at 300 a second" in done.stdout, done.stderr
    found = json.loads(kept.read_text())
    assert found["end"]["difference"] is None
    # The system may drop datagrams where nobody gets to read them; then that is told.
    is_lost = not found["end"]["received"] == found["end"]["compared"] == 600
    assert any("came and" in one for one in found["problems"]) == is_lost
    assert done.returncode == bool(found["problems"])
    assert len(found["samples"]) > 0
    # The strangers have reached the flight's own port, and the flight went on beside them.
    assert found["samples"][-1]["components"] > 1
    assert found["samples"][-1]["garbage"] > 0


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs /proc")
def test_a_flight_beside_nobody_is_no_hostile_one(monkeypatch: pytest.MonkeyPatch) -> None:
    soak = module()
    started = soak.start

    def start(stack: Any, what: str, *words: object) -> Any:
        if what != "attack":
            return started(stack, what, *words)
        return subprocess.Popen([sys.executable, "-c", ""])

    monkeypatch.setattr(soak, "start", start)
    args = argparse.Namespace(log_bytes=10_000, hostile=True, interval=1.0)
    with pytest.raises(SystemExit, match="a hostile peer has ended"):
        soak.fly(args, 100, 1.0)


def samples(**last: float) -> list[dict[str, Any]]:
    one = {"bridge kB": 1000, "link kB": 1000, "bridge fd": 10, "link fd": 6, "components": 9}
    return [one] * 20 + [one | last] * 20


def test_losses_differences_and_growth_are_told() -> None:
    soak, end = module(), {"received": 9, "compared": 9, "difference": None}
    assert soak.wrong(9, end, samples()) == []
    for few in (0, 1, 9):
        assert "samples show no growth" in soak.wrong(9, end, samples()[:few])[0]
    assert soak.wrong(9, end, samples()[:10]) == []
    assert len(soak.wrong(10, end, samples())) == 1
    assert len(soak.wrong(9, end | {"compared": 8}, samples())) == 1
    assert "frame 3" in soak.wrong(9, end | {"difference": 3}, samples())[0]
    assert "memory of the link" in soak.wrong(9, end, samples(**{"link kB": 9000}))[0]
    assert "bridge has 2.0 more descriptors" in soak.wrong(9, end, samples(**{"bridge fd": 12}))[0]
    assert soak.wrong(9, end, samples(**{"bridge fd": 12}), soak.HOSTILE_PEERS) == []
    # A table that fills is no growth: it is full at last.
    filling = [samples()[0] | {"components": n, "bridge kB": 900 * n} for n in range(9)]
    assert soak.wrong(9, end, filling + [samples()[0] | {"bridge kB": 9000}] * 12) == []


def test_what_hostile_peers_cost_is_judged() -> None:
    soak = module()
    bridge = {"CPU": 1.0, "came": 20_000_000, "components": 65_000}
    assert soak.too_dear(bridge) == []
    assert "105.3 ns CPU a byte" in soak.too_dear(bridge | {"came": 9_500_000})[0]
    assert "66,000 components" in soak.too_dear(bridge | {"components": 66_000})[0]


@pytest.mark.parametrize(
    ("carried", "made", "expected"),
    [(30_000, 10**9, 20_000), (10**9, 7_000, 7_000), (2_500, 10**9, 2_500)],
)
def test_the_rate_is_doubled_until_frames_are_lost_or_no_more_are_made(
    carried: int, made: int, expected: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    soak = module()

    def fly(_args: Any, rate: int, seconds: float) -> Any:
        sent = int(rate * seconds)
        return soak.Flight(
            sent, sent / min(rate, made), {"received": min(sent, int(carried * seconds))}, {}
        )

    monkeypatch.setattr(soak, "fly", fly)
    assert soak.capacity(None) == expected


def test_a_capacity_must_hold_for_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    soak = module()

    def fly(_args: Any, rate: int, seconds: float) -> Any:
        sent, carried = int(rate * seconds), 70_000 if seconds <= soak.TRIAL else 30_000
        return soak.Flight(sent, seconds, {"received": min(sent, int(carried * seconds))}, {})

    monkeypatch.setattr(soak, "fly", fly)
    assert soak.capacity(None) == 25_600


def test_a_capacity_of_nothing_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    soak = module()
    monkeypatch.setattr(soak, "fly", lambda *_: soak.Flight(10, 1.0, {"received": 9}, {}))
    with pytest.raises(SystemExit, match="not even 2,500"):
        soak.capacity(None)
