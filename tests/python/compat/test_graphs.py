"""What `mavwire graph` and the spectra draw: the lines, colours, legends and shades of the scripts."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path
from random import Random
from struct import pack
from typing import Any

import dataflash_writer
import pytest
from dump_logs import environment
from mavwire.dialects.v20 import ardupilotmega as mavlink
from tool_runs import Log, compare_files, flight_log, in_folder, program, random_log

pytest.importorskip("matplotlib", reason="matplotlib is not installed")

ALIASED = ("-m", "mavwire", "run")
RECORDER = str(Path(__file__).with_name("figure_record.py"))
CASES = (
    "ATTITUDE.roll GPS_RAW_INT.vel:2 VFR_HUD.alt 'degrees(ATTITUDE.pitch)' HEARTBEAT.type:2",
    "ATTITUDE.roll+HEARTBEAT.type HEARTBEAT.get_srcSystem() --labels a,b --legend center",
    "ATTITUDE.roll 'GPS_RAW_INT.vel{HEARTBEAT.custom_mode==5}' --xaxis GPS_RAW_INT.lat",
    "ATTITUDE.time_boot_ms --flightmode apm --timeshift 10 --condition HEARTBEAT.type==2",
    "ATTITUDE.time_boot_ms --flightmode px4 --marker + --linestyle=: --legend 'lower left'",
)


def draw(command: list[str], folder: Path, run: tuple[str, ...] = ()) -> list[str]:
    """The output of a program that draws in a folder; `run` is how Python runs it."""
    result = subprocess.run(
        [sys.executable, *run, RECORDER, *command],
        capture_output=True, check=True, cwd=folder, env=environment(), timeout=250,
    )  # fmt: skip
    return result.stdout.decode().splitlines()


def figure(
    command: list[str], options: str, folder: Path, *logs: Path, run: tuple[str, ...] = ()
) -> tuple[list[str], Any]:
    """What a program prints and what it draws."""
    in_folder(folder, logs)
    names = [log.name for log in logs]
    printed = draw([*command, *names, *shlex.split(options), "--output", "out.png"], folder, run)
    return printed, json.loads((folder / "out.png").read_text())


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
    printed, theirs = figure(program("mavgraph"), options, tmp_path / "theirs", log)
    aliased = figure(program("mavgraph"), options, tmp_path / "aliased", log, run=ALIASED)
    assert aliased == (printed, theirs)
    ours_printed, ours = figure(["-m", "mavwire", "graph"], options, tmp_path / "ours", log)
    assert ours_printed == printed
    assert len(ours["axes"]) == len(theirs["axes"])
    for our, their in zip(ours["axes"], theirs["axes"], strict=True):
        assert_same_axes(our, their)


def test_arrays_have_a_line_for_each_element(tmp_path: Path, oracle: str) -> None:
    log = Log(tmp_path / "motors.tlog")
    for number in range(5):
        rpm = [number, 10 * number, 200 - number, 7]
        message = mavlink.MAVLink_esc_telemetry_1_to_4_message(
            bytes(4), [0] * 4, [0] * 4, [0] * 4, rpm, [0] * 4
        )
        log.add(number, message)
    path, options = log.done(), "ESC_TELEMETRY_1_TO_4.rpm"
    _, theirs = figure(program("mavgraph"), options, tmp_path / "theirs", path)
    _, ours = figure(["-m", "mavwire", "graph"], options, tmp_path / "ours", path)
    assert_same_axes(ours["axes"][0], theirs["axes"][0])
    assert len(ours["axes"][0]["lines"]) == 4


def test_texts_alone_are_in_view(tmp_path: Path) -> None:
    """Without a line nothing else would set the limits of time."""
    log = Log(tmp_path / "said.tlog")
    for number in range(3):
        log.add(number, mavlink.MAVLink_statustext_message(6, b"text %d" % number))
    options = "STATUSTEXT.text"
    _, drawn = figure(["-m", "mavwire", "graph"], options, tmp_path / "ours", log.done())
    left, right = drawn["axes"][0]["limits"][:2]
    places = [text["at"][0] for text in drawn["axes"][0]["texts"]]
    assert len(places) == 3
    assert all(left < place < right for place in places)


def spectra_log(path: Path) -> Path:
    """Batches of fast samples and single ones, of two sensors. Behind the last whole batch another
    one begins: mavfft_isb.py waits for that.
    """
    log = dataflash_writer.Log()
    log.define("ISBH", "QHBBHHQf", "TimeUS,N,type,instance,mul,smp_cnt,SampleUS,smp_rate")
    log.define("ISBD", "QHHaaa", "TimeUS,N,seqno,x,y,z")
    for name, axis in (("ACC1", "Acc"), ("GYR1", "Gyr")):
        log.define(name, "QQfff", f"TimeUS,SampleUS,{axis}X,{axis}Y,{axis}Z")
    for name in ("PIDR", "PIDY"):
        log.define(name, "Qffffff", "TimeUS,Tar,Act,Err,P,I,D")
    random = Random(1)
    for number in range(7):
        kind, instance = number % 2, number % 2
        log.add("ISBH", 1000 * number, number, kind, instance, 1000, 128, 0, 1000.0)
        for part in range(4 if number < 6 else 0):
            rows = [[random.randrange(-999, 999) for _ in range(32)] for _ in range(3)]
            log.add("ISBD", 0, number, part, *(pack("<32h", *row) for row in rows))
    for number in range(300):
        for name in ("ACC1", "GYR1"):
            values = [random.gauss(number % 7, 0.1) for _ in range(3)]
            log.add(name, 10_000 + number * 1000, number * 1000, *values)
        for name in ("PIDR", "PIDY"):
            log.add(name, number * 10_000, *(random.gauss(1, 1) for _ in range(6)))
    log.write(path)
    return path


def without_speed(lines: list[str]) -> list[str]:
    """How fast a script was is no output to compare."""
    return [line for line in lines if "messages/second" not in line]


SPECTRA = (
    ("mavfft_isb", "fft_isb", "--overlap --window blackman --output lsd --axis XZ"),
    ("mavfft_isb", "fft_isb", "--scale linear --max-freq 300"),
    ("mavfft", "fft", "--sample-length 128"),
    ("mavfft_pid", "fft_pid", "--sample-rate 100"),
)


@pytest.mark.parametrize(("script", "verb", "options"), SPECTRA)
def test_spectra(script: str, verb: str, options: str, tmp_path: Path, oracle: str) -> None:
    if script == "mavfft_isb":
        pytest.importorskip("scipy", reason="mavfft_isb.py needs scipy")
    log = spectra_log(tmp_path / "fast.bin")
    folders = [in_folder(tmp_path / name, (log,)) for name in ("theirs", "ours", "aliased")]
    theirs = draw([*program(script), log.name, *options.split()], folders[0])
    if program(script)[0] != "-m":
        aliased = draw([*program(script), log.name, *options.split()], folders[2], ALIASED)
        assert without_speed(aliased) == without_speed(theirs)
        compare_files(folders[2], folders[0])
    command = ["-m", "mavwire", verb, log.name, *options.split(), "--image", "out.png"]
    ours = draw(command, folders[1])
    assert ours == without_speed(theirs)
    drawn = [json.loads(path.read_text()) for path in sorted(folders[0].glob("*.json"))]
    drawn = [one for one in drawn if one["axes"][0]["lines"]]
    images = sorted(folders[1].glob("out*.png"))
    assert len(images) == len(drawn) == 2
    for image, their in zip(images, drawn, strict=True):
        our = json.loads(image.read_text())
        assert our["axes"][0]["limits"] == pytest.approx(their["axes"][0]["limits"])
        assert_same_axes(our["axes"][0], their["axes"][0])
        assert our["axes"][0]["labels"] == their["axes"][0]["labels"]


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
    printed, theirs = figure(program("mavgraph"), options, tmp_path / "theirs", *logs)
    aliased = figure(program("mavgraph"), options, tmp_path / "aliased", *logs, run=ALIASED)
    assert aliased == (printed, theirs)
    ours_printed, ours = figure(["-m", "mavwire", "graph"], options, tmp_path / "ours", *logs)
    assert ours_printed == printed
    assert_same_axes(ours["axes"][0], theirs["axes"][0])
