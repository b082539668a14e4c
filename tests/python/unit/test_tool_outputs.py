"""What the tools write never costs a file that was there, and what they read is told apart: kinds of
missions, of compasses, of logs.
"""

from __future__ import annotations

import json
import math
import signal
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import dataflash_writer
import pytest
from mavwire import cli
from mavwire.cli.logs import tomfile
from mavwire.cli.plots import kml, togpx
from mavwire.dialects.v20 import ardupilotmega as mavlink
from tool_runs import Log, flight_log, heartbeat, random_log


def run(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> Any:
    """What a subcommand that succeeds prints."""
    assert cli.main([str(one) for one in arguments]) == 0
    return capsys.readouterr()


def fails(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """What a subcommand says that fails: one line."""
    assert cli.main([str(one) for one in arguments]) == 1
    error: str = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


def mission_item(seq: int, command: int = 16, kind: int = 0) -> Any:
    return mavlink.MAVLink_mission_item_int_message(
        1, 1, seq, 3, command, 0, 1, 0, 0, 0, 0, 10, 20, 30, kind
    )


def mission_log(path: Path) -> Path:
    """A mission, and a fence and rally points after it."""
    log = Log(path)
    for seq in range(4):
        log.add(seq, mission_item(seq))
    for seq in range(3):
        log.add(5 + seq, mission_item(seq, 5001, kind=1))
    log.add(9, mission_item(0, 5100, kind=2))
    return log.done()


def test_a_mission_is_not_mixed_with_fences_and_rally_points(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "mission.txt"
    run(capsys, "mission", mission_log(tmp_path / "a.tlog"), "--output", output)
    assert [line.split("\t")[3] for line in output.read_text().splitlines()[1:]] == ["16"] * 4


@pytest.mark.parametrize("verb", ["mission", "togpx"])
def test_outputs_do_not_write_over_a_log(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = mission_log(tmp_path / "a.tlog")
    other = tmp_path / "a.tlog.gpx"
    other.symlink_to(log)
    before = log.read_bytes()
    options = ["--output", other] if verb == "mission" else []
    assert "is the log itself" in fails(capsys, verb, log, *options)
    assert log.read_bytes() == before


def test_a_log_without_a_mission_leaves_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = Log(tmp_path / "empty.tlog")
    log.add(0, heartbeat())
    path, output = log.done(), tmp_path / "mission.txt"
    output.write_text("precious")
    assert "is left as it is" in run(capsys, "mission", path, "--output", output).err
    assert output.read_text() == "precious"


def test_kml_is_opened_when_there_is_something_to_write(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "good.kml"
    output.write_text("precious")
    log = dataflash_writer.Log()
    log.define("GPOS", "QB", "TimeUS,X")
    log.add("GPOS", 1, 2)
    for path in (str(tmp_path / "none.bin"), log.write(tmp_path / "a.bin")):
        fails(capsys, "kml", path, "-o", output)
        assert output.read_text() == "precious"


def test_stretches_of_several_logs_stand_beside_each_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """mavextract.py counts anew for each log, and writes over what it wrote."""
    logs = []
    for number, name in enumerate(("a", "b")):
        log = Log(tmp_path / f"{name}.tlog")
        for second in range(3 + number):
            log.add(second, heartbeat(5))
        logs.append(log.done())
    (tmp_path / "LOITER2.tlog").write_text("precious")
    run(capsys, "extract", "--mode", "loiter", *logs)
    assert (tmp_path / "LOITER1.tlog").read_bytes() == logs[0].read_bytes()
    assert (tmp_path / "LOITER2.tlog").read_text() == "precious"
    assert (tmp_path / "LOITER3.tlog").read_bytes() == logs[1].read_bytes()


def compass_log(path: Path, units: bool) -> str:
    """Three compasses in one type, as instances."""
    log = dataflash_writer.Log()
    log.define("MAG", "QBhhhhhh", "TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ")
    if units:
        log.define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds")
        log.add("FMTU", 0, log.types["MAG"][0], "s#GGGGGG", "F-------")
    random = Random(4)
    centres = ((100, -50, 30), (-200, 150, 80), (300, 300, -300))
    for number in range(300):
        up, turn = random.uniform(-1, 1), random.uniform(0, 2 * math.pi)
        flat = math.sqrt(1 - up * up)
        place = 500 * flat * math.cos(turn), 500 * flat * math.sin(turn), 500 * up
        for instance, centre in enumerate(centres):
            field = [round(one + other) for one, other in zip(place, centre, strict=True)]
            log.add("MAG", number * 1000, instance, *field, 0, 0, 0)
    return str(log.write(path))


@pytest.mark.parametrize("units", [True, False])
@pytest.mark.parametrize(
    ("options", "offsets"), [((), (-100, 50, -30)), (("--mag2",), (200, -150, -80))]
)
def test_compasses_are_fitted_one_by_one(
    units: bool,
    options: tuple[str, ...],
    offsets: tuple[float, ...],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    pytest.importorskip("numpy", reason="NumPy is not installed")
    printed = run(capsys, "magfit", compass_log(tmp_path / "compass.bin", units), *options)
    lines = printed.out.splitlines()
    assert lines[1] == "Extracted 300 data points"
    words = lines[4].removeprefix("New offsets: Vector3(").rstrip(")").split(", ")
    assert [float(one) for one in words] == pytest.approx(offsets, abs=1)
    assert not printed.err


def test_a_fit_that_is_none_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("numpy", reason="NumPy is not installed")
    random = Random(5)
    log = dataflash_writer.Log()
    log.define("MAG", "Qhhhhhh", "TimeUS,MagX,MagY,MagZ,OfsX,OfsY,OfsZ")
    for number in range(300):
        log.add("MAG", number * 1000, *(random.randrange(-500, 500) for _ in range(3)), 0, 0, 0)
    printed = run(capsys, "magfit", log.write(tmp_path / "compass.bin"))
    assert "do not use these offsets" in printed.err


def test_the_time_before_a_log_has_one_is_no_silence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = dataflash_writer.Log()
    log.define("ATT", "Qf", "TimeUS,Roll")
    for second in (265, 266, 268):
        log.add("ATT", second * 1_000_000, 1.0)
    lines = run(capsys, "sigloss", log.write(tmp_path / "a.bin")).out.splitlines()
    assert [line.split(" at ")[0] for line in lines[1:]] == ["Sig lost for 2.0s"]


def test_types_are_known_in_any_letters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = random_log(tmp_path / "random.tlog", 3)
    expected = run(capsys, "bitmask_change", path, "HEARTBEAT.base_mode").out
    assert expected.count("\n") > 2
    assert run(capsys, "bitmask_change", path, "heartbeat.base_mode").out == expected


@pytest.fixture
def csv_log(tmp_path: Path) -> str:
    path = tmp_path / "f.csv"
    path.write_text("T;A;B\n1000;1.5;foo\n2000;2.5;bar\n")
    return f"csv:{path}"


def test_a_csv_log_is_dumped(csv_log: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = run(capsys, "dump", csv_log).out
    assert [line.split(": ", 1)[1] for line in text.splitlines()] == [
        "CSV {T : 1000.0, A : 1.5, B : foo, }",
        "CSV {T : 2000.0, A : 2.5, B : bar, }",
    ]
    assert run(capsys, "dump", csv_log, "--verbose").out == text
    assert run(capsys, "dump", csv_log, "--types", "CSV").out == text
    assert run(capsys, "dump", csv_log, "--show-types").out == "CSV\n"
    lines = run(capsys, "dump", csv_log, "--format", "json").out.splitlines()
    assert [json.loads(line)["data"]["B"] for line in lines] == ["foo", "bar"]
    table = run(capsys, "dump", csv_log, "--format", "csv", "--types", "CSV").out
    assert table == "timestamp,T,A,B\n1000.00000000,1000.0,1.5,foo\n2000.00000000,2000.0,2.5,bar\n"
    printed = run(capsys, "dump", csv_log, "--types", "NOPE")
    assert printed.out == ""
    assert "no message type 'NOPE' in this log" in printed.err


def test_what_a_csv_log_does_not_have(csv_log: str, capsys: pytest.CaptureFixture[str]) -> None:
    for options in (
        ["dump", "--show-loss"], ["dump", "--output", "x"], ["loss"], ["msgstats"],
        ["magfit", "--mag2"], ["magfit_WMM"],
    ):  # fmt: skip
        assert f"{csv_log} is a CSV log" in fails(capsys, options[0], csv_log, *options[1:])
    assert "no message type 'X'" in fails(capsys, "dump", csv_log, "--format=csv", "--types=X")


def test_a_row_without_a_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "f.csv"
    path.write_text("A;B\nfoo;1\n")
    assert "f.csv: a row without a time" in fails(capsys, "dump", f"csv:{path}")


def test_tools_over_a_csv_log(
    csv_log: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(capsys, "search", csv_log, "--condition", "CSV.A>2").out.count("CSV {") == 1
    assert "Sig lost for 1000.0s" in run(capsys, "sigloss", csv_log).out
    for verb in ("parms", "flighttime", "summarize", "gpslock"):
        run(capsys, verb, csv_log)


def test_tomfile_writes_the_numbers_that_each_record_has(
    csv_log: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "out.m"
    run(capsys, "tomfile", csv_log, "--output", output)
    assert output.read_text().splitlines() == [
        "CSV.columns = {'timestamp','T','A'};",
        "CSV.data(1,:) = [1000.000000,1000,1.5];",
        "CSV.data(2,:) = [2000.000000,2000,2.5];",
    ]
    log = dataflash_writer.Log()
    log.define("ABC", "QBf", "TimeUS,A.x,F", 1).add("ABC", 1_000_000, 2, 0.5)
    log.define("ABC", "QBBf", "TimeUS,A,B,F", 1).add("ABC", 2_000_000, 3, 4, 1.5)
    log.define("ABC", "QZ", "TimeUS,A", 1).add("ABC", 3_000_000, b"text")
    run(capsys, "tomfile", log.write(tmp_path / "twice.bin"), "--output", output)
    assert output.read_text().splitlines() == [
        "ABC.columns = {'timestamp','TimeUS','A.x','F'};",
        "ABC.data(1,:) = [1.000000,1000000,2,0.5];",
        "ABC.data(2,:) = [2.000000,2000000,3,4,1.5];",
        "ABC.data(3,:) = [3.000000,3000000];",
    ]


def test_types_that_there_are_not(
    tmp_path: Path,
    csv_log: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A misspelt one would go unnoticed."""
    monkeypatch.chdir(tmp_path)
    log = str(flight_log(tmp_path / "flight.tlog"))
    for verb, option in (
        ("search", "--types"), ("sigloss", "--types"), ("tomfile", "--types"),
        ("split_sysid", "--types"), ("togpx", "--type"),
    ):  # fmt: skip
        assert cli.main([verb, log, option, "HEARTBEET"]) == 0
        said = capsys.readouterr().err
        assert said.startswith(f"mavwire {verb}: no message type 'HEARTBEET' in dialect ")
        assert said.endswith("; did you mean 'HEARTBEAT'?\n")
        assert cli.main([verb, log, option, "HEARTBEAT"]) == 0
        assert capsys.readouterr().err == ""
    assert cli.main(["search", log, "--types", "HEART*"]) == 0
    assert "no message type 'HEART*' in dialect " in capsys.readouterr().err
    assert cli.main(["search", csv_log, "--types", "CSV,NOPE"]) == 0
    assert capsys.readouterr().err == "mavwire search: no message type 'NOPE' in this log\n"


@pytest.mark.parametrize("verb", ["dump", "search", "graph", "extract"])
def test_names_that_a_condition_cannot_know_are_named(tmp_path, monkeypatch, capsys, verb):
    monkeypatch.chdir(tmp_path)
    flight, onboard = (
        str(flight_log(tmp_path / "a.tlog")),
        dataflash_writer.sample().write(tmp_path / "b.BIN"),
    )
    begin = f"mavwire {verb}: --condition: no message type or function"
    for log, field, condition, said in (
        (flight, "HEARTBEAT.type", "HEARTBEET.type>0", "'HEARTBEET' in dialect "),
        (onboard, "IMU.AccX", "IMV.Raw>0", "'IMV' in this log; did you mean 'IMU'?\n"),
        (onboard, "IMU.AccX", "nope(IMU.Raw)>0", "'nope' in this log\n"),
        (flight, "HEARTBEAT.type", "abs(HEARTBEAT.type)>99", None),
        (onboard, "IMU.AccX", "IMU[0].Raw>999 and MAV", None),
    ):
        more = [field, "--output", "x.png"] if verb == "graph" else []
        cli.main([verb, str(log), *more, "--condition", condition])
        told = capsys.readouterr().err
        assert told.count(begin) == (said is not None)
        assert said is None or f"{begin} {said}" in told


@pytest.mark.parametrize("types", ["", ","])
def test_a_replay_of_no_types(
    types: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = flight_log(tmp_path / "flight.tlog")
    assert "--types names nothing" in fails(capsys, "replay", str(log), "--types", types)


@pytest.mark.parametrize("condition", ["GPS_RAW_INT.nope>1", "GPS_RAW_INT.lat.nope"])
def test_a_track_that_cannot_be_completed_leaves_the_file(
    condition: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = flight_log(tmp_path / "flight.tlog")
    track = tmp_path / "flight.tlog.gpx"
    track.write_text("precious")
    fails(capsys, "togpx", log, "--condition", condition)
    assert track.read_text() == "precious"
    assert sorted(one.name for one in tmp_path.iterdir()) == [log.name, track.name]


def test_a_track_that_is_interrupted_leaves_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def told(*_: Any) -> Iterator[str]:
        yield "half"
        signal.raise_signal(signal.SIGTERM)
        raise AssertionError("it would have ended at once")

    monkeypatch.setattr(togpx, "_points", told)
    log = flight_log(tmp_path / "flight.tlog")
    track = tmp_path / "flight.tlog.gpx"
    track.write_text("precious")
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        assert cli.main(["togpx", str(log)]) == cli.EXIT_INTERRUPTED
    finally:
        signal.signal(signal.SIGTERM, before)
    assert track.read_text() == "precious"
    assert sorted(one.name for one in tmp_path.iterdir()) == [log.name, track.name]


def test_a_script_that_cannot_be_completed_leaves_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, script = flight_log(tmp_path / "flight.tlog"), tmp_path / "flight.m"
    script.write_text("precious")
    fails(capsys, "tomfile", log, "--condition", "GPS_RAW_INT.nope>1")
    assert script.read_text() == "precious"
    assert sorted(one.name for one in tmp_path.iterdir()) == [script.name, log.name]


def test_lines_that_do_not_fit_on_the_disk_leave_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    resource = pytest.importorskip("resource")
    log, output = flight_log(tmp_path / "flight.tlog"), tmp_path / "mav.kml"
    output.write_text("precious")
    monkeypatch.setattr(kml, "_lines", lambda *_: [kml.Line("GPOS", 0)])
    monkeypatch.setattr(kml, "document", lambda *_: "x" * 10_000)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5_000, limits[1]))
    try:
        said = fails(capsys, "kml", log, "--output", output)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert f"{output}: File too large" in said
    assert output.read_text() == "precious"
    assert sorted(one.name for one in tmp_path.iterdir()) == [log.name, output.name]


def test_a_layout_of_columns_is_made_once_for_each_format(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A format may be given anew within a log; a row of a CSV file has its own cells that are numbers."""
    made: list[Any] = []

    class Layout(tomfile.Layout):
        def __init__(self, msg: Any) -> None:
            made.append(msg.get_type())
            super().__init__(msg)

    monkeypatch.setattr(tomfile, "Layout", Layout)
    log, rows = tmp_path / "a.log", tmp_path / "b.csv"
    log.write_text(
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
        "FMT, 130, 20, ABC, QBZ, TimeUS,A,Text\n" + "ABC, 1000, 3, four\n" * 9 +
        "FMT, 130, 20, ABC, QBZf, TimeUS,A,Text,B\n" + "ABC, 2000, 3, four, 5.5\n" * 9
    )  # fmt: skip
    rows.write_text("time;a;b\n1;2;x\n2;y;3\n")
    run(capsys, "tomfile", log)
    assert made == ["ABC", "ABC"]
    lines = (tmp_path / "a.m").read_text().splitlines()
    assert (lines[1], lines[-1]) == (
        "ABC.data(1,:) = [0.001000,1000,3];", "ABC.data(18,:) = [0.002000,2000,3,5.5];",
    )  # fmt: skip
    run(capsys, "tomfile", f"csv:{rows}", "-o", tmp_path / "b.m")
    assert [line.partition("= ")[2] for line in (tmp_path / "b.m").read_text().splitlines()] == [
        "{'timestamp','time','a'};", "[1.000000,1,2];", "[2.000000,2,3];",
    ]  # fmt: skip
