"""Compass offsets, batches of fast samples, and what graphs, spectra and ways refuse."""

from __future__ import annotations

from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import dataflash_writer
import numpy as np
import pytest
from compass_logs import CENTRE, compass_log, sphere
from mavwire import cli
from mavwire.cli._batches import Spectrum, batches
from mavwire.cli._output import open_figures
from mavwire.cli.plots import fft_int
from mavwire.cli.vehicle import magfit
from mavwire.dialects.v20 import ardupilotmega as mavlink
from tool_runs import Log, flight_log


def fails(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """What a subcommand says that fails: one line."""
    assert cli.main([str(one) for one in arguments]) == 1
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith(f"mavwire {arguments[0]}: error: ")
    return error


@pytest.mark.parametrize("radius", [None, 450.0])
def test_outliers_do_not_move_the_centre(radius: float | None) -> None:
    points = np.array([*sphere(Random(1), 300), (9000.0, 9000.0, 0.0), (0.0, 0.0, -30000.0)])
    centre, size, kept = magfit.fit(points, radius)
    assert centre == pytest.approx(CENTRE, abs=0.01)
    assert size == pytest.approx(450.0, abs=0.01)
    assert int(kept.sum()) == 300


def test_offsets_of_a_telemetry_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = Log(tmp_path / "compass.tlog")
    log.add(0, mavlink.MAVLink_sensor_offsets_message(5, -7, 9, 0.0, 0, 0, 0, 0, 0, 0, 0, 0))
    for number, (x, y, z) in enumerate(sphere(Random(2), 200), 1):
        field = round(x) + 5, round(y) - 7, round(z) + 9
        log.add(number / 10, mavlink.MAVLink_raw_imu_message(0, 0, 0, 0, 0, 0, 0, *field))
    assert cli.main(["magfit", str(log.done())]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1:3] == [
        "Extracted 200 data points",
        "Current offsets: Vector3(5.00, -7.00, 9.00)",
    ]
    words = lines[4].removeprefix("New offsets: Vector3(").rstrip(")").split(", ")
    assert [-float(one) for one in words] == pytest.approx(CENTRE, abs=0.3)
    assert lines[5].startswith("Field strength: 45")


def test_offsets_of_a_dataflash_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    log = dataflash_writer.Log()
    for name in ("MAG", "MAG2"):
        log.define(name, "Qhhhhhh", "TimeUS,MagX,MagY,MagZ,OfsX,OfsY,OfsZ")
    for number, place in enumerate(sphere(Random(3), 100)):
        log.add("MAG2", number * 1000, *map(round, place), 1, 2, 3)
    path = log.write(tmp_path / "compass.bin")
    image = tmp_path / "points.png"
    assert cli.main(["magfit", path, "--mag2", "--plot", "--image", str(image)]) == 0
    assert "Current offsets: Vector3(1.00, 2.00, 3.00)" in capsys.readouterr().out
    assert image.read_bytes().startswith(b"\x89PNG")
    assert "0 data points are too few" in fails(capsys, "magfit", path)


def test_points_that_make_no_sphere(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = Log(tmp_path / "still.tlog")
    for number in range(50):
        log.add(number, mavlink.MAVLink_raw_imu_message(0, 0, 0, 0, 0, 0, 0, 100, 200, number))
    assert "turn the vehicle about all axes" in fails(capsys, "magfit", log.done())


def header(number: int, **changed: Any) -> Any:
    """An ISBH record."""
    values = {"N": number, "type": 0, "instance": 0, "mul": 10, "smp_cnt": 64, "smp_rate": 100.0,
              "SampleUS": 5}  # fmt: skip
    return SimpleNamespace(get_type=lambda: "ISBH", **(values | changed))


def part(number: int, seqno: int) -> Any:
    """An ISBD record with 32 samples."""
    rows = {axis: list(range(32)) for axis in "xyz"}
    return SimpleNamespace(get_type=lambda: "ISBD", N=number, seqno=seqno, **rows)


def test_batches_without_a_part_are_passed_over() -> None:
    records = [
        part(0, 1), header(1), part(1, 0), part(1, 1), header(2), part(2, 1), part(2, 0),
        header(3), part(3, 0), part(4, 1), header(5, mul=0), part(5, 0), part(5, 1),
        header(6, smp_cnt=0), part(6, 0), header(7, type=9), part(7, 0), part(7, 1),
        header(8), part(8, 0), part(8, 1),
    ]  # fmt: skip
    assert [batch.number for batch in batches(records)] == [1, 8]


def test_a_sine_has_its_power_at_its_frequency() -> None:
    seconds = np.arange(64) / 100.0
    spectrum = Spectrum("hanning", overlap=False)
    for batch in batches([header(1), part(1, 0), part(1, 1)] * 2):
        batch.values = [list(np.sin(2 * np.pi * 25 * seconds) * 10)] * 3
        spectrum.add(batch)
    density = spectrum.density(0)
    assert spectrum.frequencies()[int(density.argmax())] == pytest.approx(25.0)
    # Its mean square is a half.
    assert density.sum() * 100.0 / 64 == pytest.approx(0.5, rel=0.01)


def test_where_a_notch_belongs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    log = dataflash_writer.Log()
    log.define("ISBH", "QHBBHHQf", "TimeUS,N,type,instance,mul,smp_cnt,SampleUS,smp_rate")
    log.define("ISBD", "QHHaaa", "TimeUS,N,seqno,x,y,z")
    log.add("ISBH", 0, 0, 1, 0, 1000, 256, 0, 1000.0)
    wave = np.round(1000 * np.sin(2 * np.pi * 125 * np.arange(256) / 1000.0)).astype("<i2")
    for seqno in range(8):
        row = wave[32 * seqno :][:32].tobytes()
        log.add("ISBD", 0, 0, seqno, row, row, row)
    path = log.write(tmp_path / "fast.bin")
    image = str(tmp_path / "fast.svg")
    assert cli.main(["fft_isb", path, "--notch-params", "--image", image]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1:3] == ["Sensor: Gyro[0]", "Peak 0: 125.0 Hz, 7.8 Hz wide"]
    assert "INS_HNTCH_FREQ 125.0" in lines
    more = ["--notch-params", "--notch-peak", "9999", "--image", image]
    assert "--notch-peak 9999" in fails(capsys, "fft_isb", path, *more)
    assert "--axis Q" in fails(capsys, "fft_isb", path, "--axis", "Q", "--image", image)


def test_what_graphs_refuse(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.chdir(tmp_path)
    log = flight_log(tmp_path / "flight.tlog")
    out = ("--output", "out.png")
    for wanted, arguments in {
        "No files to process": ("ATTITUDE.roll", *out),
        "name a field, such as ATTITUDE.roll": (log, *out),
        "no such log: none.tlog": (log, "none.tlog", "ATTITUDE.roll", *out),
        "Number of labels (1) must match number of fields (2)": (
            log, "ATTITUDE.roll", "ATTITUDE.yaw", "--labels", "a", *out,
        ),
        "Cannot request flightmode": (
            log, "ATTITUDE.roll", "--flightmode", "apm", "--xaxis", "ATTITUDE.yaw", *out,
        ),
        "Unknown flight controller 'x'": (log, "ATTITUDE.roll", "--flightmode", "x", *out),
        "ATTITUDE.foo": (log, "ATTITUDE.foo", *out),
        "no expression: '1+'": (log, "1+", *out),
        "'a' is not a valid value for loc": (log, "ATTITUDE.roll", "--legend", "a", *out),
        "'b' is not a valid value for loc": (log, "ATTITUDE.roll", "--legend2", "b", *out),
        "marker style 'Q'": (log, "ATTITUDE.roll", "--marker", "Q", *out),
        "'zz' is not a valid value": (log, "ATTITUDE.roll", "--linestyle", "zz", *out),
        "cannot write 'out.nope': use": (log, "ATTITUDE.roll", "--output", "out.nope"),
        "--output flight.tlog is the log itself": (log, "ATTITUDE.roll", "--output", log.name),
    }.items():  # fmt: skip
        assert wanted in fails(capsys, "graph", *arguments)
    assert cli.main(["graph", log.name, "NOPE.x", *out]) == 1
    said = capsys.readouterr()
    assert "Failed to find any values for field NOPE.x" in said.out
    assert said.err == "mavwire graph: NOPE.x: there is no 'NOPE'\n"
    assert cli.main(["graph", log.name, "twice(ATTITUDE.roll)", *out]) == 1
    assert capsys.readouterr().err.endswith(": there is no 'twice'\n")
    assert cli.main(["graph", log.name, "ATTITUDE.roll", "--xaxis", "NOPE.x", *out]) == 1
    assert capsys.readouterr().err == "mavwire graph: ATTITUDE.roll: there is no 'NOPE'\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["flight.tlog"]


def test_windows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    from matplotlib import pyplot

    log = str(flight_log(tmp_path / "flight.tlog"))
    monkeypatch.setattr(matplotlib, "get_backend", lambda: "agg")
    said = "there is no display for a window; {} FILE draws an image"
    assert said.format("--output") in fails(capsys, "graph", log, "ATTITUDE.roll")
    for verb in ("fft", "fft_int", "fft_isb", "fft_pid"):
        assert said.format("--image") in fails(capsys, verb, log)
    shown: list[str] = []

    def show() -> None:
        axes = pyplot.gcf().axes
        shown.extend(line.get_label() for one in axes for line in one.get_lines())

    monkeypatch.setattr(matplotlib, "get_backend", lambda: "windows")
    monkeypatch.setattr(pyplot, "show", show)
    pyplot.switch_backend("agg")
    try:
        assert cli.main(["graph", log, "ATTITUDE.roll", "GPS_RAW_INT.vel:2"]) == 0
    finally:
        pyplot.close("all")
    assert shown == ["ATTITUDE.roll", "GPS_RAW_INT.vel"]


def test_a_way_without_altitude(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    log = dataflash_writer.Log().define("GPS", "QLL", "TimeUS,Lat,Lng").add("GPS", 1, 2, 3)
    path = log.write(tmp_path / "way.bin")
    assert "GPS has no Lat, Lon and Alt" in fails(capsys, "kml", path, "-s", "GPS")
    assert cli.main(["kml", path]) == 0
    assert "no GPOS in the logs; `mavwire map" in capsys.readouterr().err


def test_compass_and_world_model(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = compass_log(tmp_path / "flight.bin", (40.0, -30.0, 70.0), (1.05, 1.0, 0.95))
    options = ["--mag", "2", "--elliptical", "--cmot", "--save-params"]
    assert cli.main(["magfit_WMM", str(path), *options]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1] == "Attitude source XKF1"
    assert lines[3] == "Extracted 150 points"
    before, after = (float(line.split()[-1]) for line in lines[-3:-1])
    assert before > 50.0
    assert after < 1.0
    saved = dict(
        line.split() for line in (tmp_path / "flight-magfit-mag-2.param").read_text().splitlines()
    )
    found = {name: float(value) for name, value in saved.items()}
    wanted = {
        "OFS2_X": 40, "OFS2_Y": -30, "OFS2_Z": 70, "DIA2_X": 1.05, "DIA2_Y": 1, "DIA2_Z": 0.95,
        "ODI2_X": 0, "ODI2_Y": 0, "ODI2_Z": 0, "MOT2_X": 0.5, "MOT2_Y": 0.5, "MOT2_Z": 0.5,
        "SCALE2": 1, "MOTCT": 2,
    }  # fmt: skip
    assert list(found) == [f"COMPASS_{name}" for name in wanted]
    for name, value in wanted.items():
        near = 1.5 if name.startswith("OFS") else 0.02
        assert found[f"COMPASS_{name}"] == pytest.approx(value, abs=near), name


@pytest.mark.parametrize(
    ("verb", "options", "reason"),
    [
        ("magfit_WMM", "--lat 95 --lon 10", "no magnetic field is tabulated for 95.0, 10.0"),
        ("magfit_WMM", "--att-source FOO", "there is no FOO in the log"),
        ("magfit_WMM", "--min-scale 2 --max-scale 1", "--min-scale is above --max-scale"),
        ("magfit_WMM", "--max-diag nan", "--min-diag is above --max-diag"),
        ("magfit", "--noise nan", "--noise is a number of milligauss"),
        ("magfit", "--radius -5", "--radius is a number of milligauss"),
    ],
)
def test_numbers_that_mean_nothing_to_a_fit(
    verb: str, options: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = compass_log(tmp_path / "flight.bin", (40.0, -30.0, 70.0), (1.0, 1.0, 1.0))
    assert reason in fails(capsys, verb, path, *options.split())


def test_compass_of_a_text_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It counts its records by name, not by number."""
    log = tmp_path / "flight.log"
    log.write_text(
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
        "FMT, 10, 31, PARM, QNf, TimeUS,Name,Value\n"
        "FMT, 11, 24, XKF1, QBccC, TimeUS,C,Roll,Pitch,Yaw\n"
        "FMT, 12, 24, NKF1, QBccC, TimeUS,C,Roll,Pitch,Yaw\n"
        "PARM, 1, AHRS_EKF_TYPE, {}\nXKF1, 2, 0, 1.5, 2.5, 3.5\n"
    )
    text = log.read_text()
    for number, source in ((3, "XKF1"), (2, "ATT"), (0, "ATT")):
        log.write_text(text.format(number))
        assert cli.main(["magfit_WMM", str(log)]) == 1
        said = capsys.readouterr()
        assert f"Attitude source {source}" in said.out
        assert "give --lat and --lon" in said.err


def test_limits_of_the_compass_fit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(compass_log(tmp_path / "flight.bin", (40.0, -30.0, 70.0), (1.5, 1.5, 1.5)))
    options = ["--mag", "2", "--no-cmot-change", "--max-scale", "1.2", "--max-offset", "20"]
    assert cli.main(["magfit_WMM", path, *options]) == 0
    new = next(one for one in capsys.readouterr().out.splitlines() if one.startswith("New:"))
    assert new.startswith("New: Vector3(20.00, -20.00, 20.00)")
    assert new.endswith("scale: 1.20")
    assert cli.main(["magfit_WMM", path, "--mag", "2", "--no-offset-change"]) == 0
    assert "New: Vector3(10.00, 0.00, 0.00)" in capsys.readouterr().out
    assert "0 data points are too few" in fails(capsys, "magfit_WMM", path, "--mag", "3")
    assert "turn the vehicle" in fails(capsys, "magfit_WMM", path, "--mag", "1", "--cmot-throttle")
    nowhere = dataflash_writer.Log().write(tmp_path / "nowhere.bin")
    assert "give --lat and --lon" in fails(capsys, "magfit_WMM", nowhere)
    log = flight_log(tmp_path / "flight.tlog")
    assert "for dataflash logs only" in fails(capsys, "magfit_WMM", log)


def test_spectrum_of_a_selection(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    log = dataflash_writer.Log()
    log.define("ACC1", "QQfff", "TimeUS,SampleUS,AccX,AccY,AccZ")
    for number in range(400):  # first 100 Hz, then 200 Hz
        wave = np.sin(2 * np.pi * (100 if number < 200 else 200) * number / 1000)
        log.add("ACC1", number * 1000, number * 1000, wave, 0.0, 1.0)
    path = log.write(tmp_path / "fast.bin")
    image = tmp_path / "out.png"
    figures = open_figures(str(image))
    monkeypatch.setattr(fft_int, "open_figures", lambda name: figures)
    arguments = ["fft_int", path, "--from", "0.2", "--to", "0.4", "--image", str(image)]
    assert cli.main(arguments) == 0
    assert image.stat().st_size > 1000
    line = figures._figures["ACC1"].axes[1].get_lines()[0]
    assert line.get_xdata()[np.argmax(line.get_ydata())] == pytest.approx(200.0, abs=2.0)
    none = dataflash_writer.Log().write(tmp_path / "none.bin")
    assert "nothing to draw" in fails(capsys, "fft_int", none, "--image", image)
    assert "too few samples" in fails(capsys, *arguments[:2], "--from", "7", "--image", image)


@pytest.mark.parametrize("verb", ["fft", "fft_int"])
def test_spectra_of_sensors_that_share_a_type(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As in the logs of newer autopilots."""
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    log = dataflash_writer.Log()
    for kind, axis in (("ACC", "Acc"), ("GYR", "Gyr")):
        log.define(kind, "QBQfff", f"TimeUS,I,SampleUS,{axis}X,{axis}Y,{axis}Z")
    for number in range(100):
        for kind, sensor in (("ACC", 0), ("ACC", 1), ("GYR", 0), ("GYR", 3)):
            log.add(kind, number * 1000, sensor, number * 1000, number % 3, 0.0, sensor)
    path = log.write(tmp_path / "fast.bin")
    assert cli.main([verb, path, "--image", str(tmp_path / "out.png")]) == 0
    images = sorted(one.name for one in tmp_path.glob("*.png"))
    assert images == ["out-ACC1.png", "out-ACC2.png", "out-GYR1.png"]
    assert verb == "fft_int" or "Extracted 200 data points" in capsys.readouterr().out
