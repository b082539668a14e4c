"""Stretches of logs in one flight mode, beside mavextract.py: dataflash logs, and whose mode it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import dataflash_writer
import pytest
from mavwire import cli, mavutil
from mavwire.dialects.v20 import ardupilotmega as mavlink
from tool_runs import Log, attitude, compare, heartbeat

NO_UNITS = ("", "--mode loiter", "--mode unknown", "--mode manual", "--condition ATT.Roll>3")


def flown(path: Path, units: bool = False) -> Path:
    """A dataflash log of six stretches, with a format that comes late and junk."""
    log = dataflash_writer.Log()
    log.define("ATT", "Qf", "TimeUS,Roll").define("MSG", "QZ", "TimeUS,Message")
    log.define("MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn").define("CMD", "QHf", "TimeUS,CNum,Alt")
    log.define("PARM", "QNf", "TimeUS,Name,Value").define("MULT", "Qbd", "TimeUS,Id,Mult")
    log.define("VER", "QZ", "TimeUS,FWS").add("MULT", 0, ord("F"), 1e-6)
    if units:
        log.define("UNIT", "QbZ", "TimeUS,Id,Label").add("UNIT", 0, ord("d"), "deg")
        log.define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds")
        log.add("FMTU", 1, log.types["ATT"][0], "-d", "F-")
    for text in ("hello", "ArduCopter V4.5", "Ardu", "arducopter"):
        log.add("MSG", 2, text)
    log.add("VER", 3, "x").add("CMD", 3, 1, 5.0)
    for number, mode in enumerate((0, 3, 5, 3, 3, 99)):
        time = number * 1000 + 10
        log.add("MODE", time, mode, mode, 1).add("ATT", time, float(number))
        log.add("PARM", time, f"P{number}", float(number)).add("MSG", time, "on the way")
        if number == 2:
            log.define("LATE", "Qf", "TimeUS,x").raw(b"junk")
        if number >= 2:
            log.add("LATE", time, 1.0).add("CMD", time, number, 5.0)
    return Path(log.write(path))


@pytest.mark.parametrize("options", NO_UNITS)
def test_dataflash_logs(options: str, tmp_path: Path, oracle: str) -> None:
    lines = compare("mavextract", "extract", options, tmp_path, flown(tmp_path / "a.bin"))
    assert len(lines) > (2 if "manual" not in options else 1)


def extracted(log: Path, *options: str) -> list[Path]:
    assert cli.main(["extract", *options, str(log)]) == 0
    return sorted(path for path in log.parent.iterdir() if path != log)


def test_a_stretch_keeps_its_units(tmp_path: Path) -> None:
    """mavextract.py leaves the UNIT messages out."""
    first, second = extracted(flown(tmp_path / "a.bin", units=True))
    for path in (first, second):
        log = mavutil.mavlink_connection(str(path))
        assert log.recv_match(type="ATT").fmt.get_unit("Roll") == "deg"
    assert (first.name, second.name) == ("AUTO1.bin", "AUTO2.bin")


@pytest.mark.parametrize(
    ("name", "options", "reason"),
    [
        ("a.bin", ("--link", "1"), "no links"),
        ("a.log", (), "text log"),
        ("a.csv", (), "CSV log"),
    ],
)
def test_what_has_no_stretches_is_told(
    name: str, options: tuple[str, ...], reason: str, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    path = tmp_path / name
    if name == "a.bin":
        flown(path)
    elif name == "a.log":
        path.write_text("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n")
    else:
        path.write_text("T;A\n1;2\n")
    prefix = "csv:" if name == "a.csv" else ""
    assert cli.main(["extract", *options, prefix + str(path)]) == 1
    assert reason in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [path]


def stations(path: Path) -> Path:
    """A vehicle in LOITER, its camera, a ground station that is there first, and a mode without a name."""
    log = Log(path)
    station = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3)
    camera: Any = mavlink.MAVLink_heartbeat_message(30, 8, 0, 0, 0, 3)
    log.add(0, station, source=(255, 190))
    for second in range(1, 9):
        log.add(second, heartbeat(5 if second < 5 else 77))
        log.add(second, attitude(second))
        log.add(second, station, source=(255, 190))
        if path.name == "camera.tlog":
            log.add(second, camera, source=(1, 100))
    return log.done()


@pytest.mark.parametrize("mode", ["loiter", "unknown", "mode(77)"])
def test_ground_stations_have_no_mode(mode: str, tmp_path: Path, oracle: str) -> None:
    compare("mavextract", "extract", f"--mode '{mode}'", tmp_path, stations(tmp_path / "a.tlog"))


def test_a_camera_ends_no_stretch(tmp_path: Path) -> None:
    """mavextract.py begins anew behind every HEARTBEAT of a camera, a gimbal, another vehicle."""
    (stretch,) = extracted(stations(tmp_path / "camera.tlog"), "--mode", "loiter")
    assert stretch.name == "LOITER1.tlog"
    log = mavutil.mavlink_connection(str(stretch))
    assert len(list(iter(lambda: log.recv_match(type="ATTITUDE"), None))) == 4
