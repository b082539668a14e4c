"""`mavwire graph` draws what mavgraph.py draws: the same lines, colours, legends and shades."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from dump_logs import environment
from tool_runs import SCRIPTS, flight_log, in_folder, random_log

pytest.importorskip("matplotlib", reason="matplotlib is not installed")

RECORDER = str(Path(__file__).with_name("figure_record.py"))
CASES = (
    "ATTITUDE.roll GPS_RAW_INT.vel:2 VFR_HUD.alt 'degrees(ATTITUDE.pitch)' HEARTBEAT.type:2",
    "ATTITUDE.roll+HEARTBEAT.type HEARTBEAT.get_srcSystem() --labels a,b --legend center",
    "ATTITUDE.roll GPS_RAW_INT.vel --xaxis GPS_RAW_INT.lat",
    "ATTITUDE.time_boot_ms --flightmode apm --timeshift 10 --condition HEARTBEAT.type==2",
    "ATTITUDE.time_boot_ms --flightmode px4 --marker + --linestyle=: --legend 'lower left'",
    "GPS_RAW_INT.lat:2 HEARTBEAT.type:2 'GPS_RAW_INT.vel{HEARTBEAT.custom_mode==5}'",
)


def figure(program: list[str], options: str, folder: Path, *logs: Path) -> tuple[list[str], Any]:
    """What a program prints and what it draws."""
    in_folder(folder, logs)
    names = [log.name for log in logs]
    result = subprocess.run(
        [sys.executable, RECORDER, *program, *names, *shlex.split(options), "--output", "out.png"],
        capture_output=True, check=True, cwd=folder, env=environment(), timeout=250,
    )  # fmt: skip
    return result.stdout.decode().splitlines(), json.loads((folder / "out.png").read_text())


def assert_same_axes(ours: Any, theirs: Any) -> None:
    """Lines, shades, limits and the legend's texts and colours."""
    assert [one["label"].removesuffix(":2") for one in theirs["lines"]] == [
        one["label"] for one in ours["lines"]
    ]
    for our, their in zip(ours["lines"], theirs["lines"], strict=True):
        assert (our["colour"], our["style"]) == (their["colour"], their["style"])
        assert our["x"] == pytest.approx(their["x"], abs=1e-9)
        assert our["y"] == pytest.approx(their["y"], nan_ok=True)
    assert [one["colour"] for one in ours["spans"]] == [one["colour"] for one in theirs["spans"]]
    for our, their in zip(ours["spans"], theirs["spans"], strict=True):
        assert our["x"] == pytest.approx(their["x"], abs=1e-9)
    for name in ("scales", "title", "labels"):
        assert ours[name] == theirs[name]
    if theirs["lines"]:
        texts = [text.removesuffix(":2") for text in theirs["legend"]["texts"]]
        assert ours["legend"]["texts"] == texts
        assert ours["legend"]["colours"] == theirs["legend"]["colours"]


@pytest.mark.parametrize("options", CASES)
def test_one_log(options: str, tmp_path: Path, oracle: str) -> None:
    log = flight_log(tmp_path / "flight.tlog")
    printed, theirs = figure([str(SCRIPTS / "mavgraph.py")], options, tmp_path / "theirs", log)
    ours_printed, ours = figure(["-m", "mavwire", "graph"], options, tmp_path / "ours", log)
    assert ours_printed == printed
    assert len(ours["axes"]) == len(theirs["axes"])
    for our, their in zip(ours["axes"], theirs["axes"], strict=True):
        assert_same_axes(our, their)


def test_legends_are_where_they_are_wanted(tmp_path: Path) -> None:
    """With --output mavgraph.py puts the last one into the upper left corner all the same."""
    log = flight_log(tmp_path / "flight.tlog")
    options = "ATTITUDE.roll GPS_RAW_INT.vel:2 --legend center --legend2 'lower right'"
    _, drawn = figure(["-m", "mavwire", "graph"], options, tmp_path / "ours", log)
    places = [axes["legend"]["place"] for axes in drawn["axes"]]
    assert places == [10, 4]


@pytest.mark.parametrize("options", ["--multi", "--labels a,b,c,d --timeshift 5"])
def test_two_logs(options: str, tmp_path: Path, oracle: str) -> None:
    logs = flight_log(tmp_path / "flight.tlog"), random_log(tmp_path / "random.tlog", 1)
    options = f"ATTITUDE.pitch HEARTBEAT.custom_mode {options}"
    printed, theirs = figure([str(SCRIPTS / "mavgraph.py")], options, tmp_path / "theirs", *logs)
    ours_printed, ours = figure(["-m", "mavwire", "graph"], options, tmp_path / "ours", *logs)
    assert ours_printed == printed
    assert_same_axes(ours["axes"][0], theirs["axes"][0])
