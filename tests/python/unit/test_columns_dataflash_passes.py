"""Whole tables of dataflash logs come of one pass where that does; either way they are those of two."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import Any

import mavwire
import numpy as np
import pytest
from dataflash_writer import Log, fmt, record, sample
from mavwire._native import DataflashTables
from mavwire.logs import dataflash
from mavwire.logs.selection import Selection
from real_logs import each_log

BLOCK = 4 << 20
"""Bytes of a log that are read at once."""
T0 = 315_964_800 - 18 + 2200 * 7 * 86_400 + 100


def filled(log: Log) -> Log:
    """The log and more than a block behind it."""
    if "PAD" not in log.types:
        log.define("PAD", "QBa", "TimeUS,N,Data", 99)
    start = len(log.data)
    log.add("PAD", 8_000_000, 7, b"\1" * 64)
    record = bytes(log.data[start:])
    return log.raw(record * (BLOCK // len(record)))


def whole(path: Path | str) -> Any:
    """What one pass finds; None in place of the tables if it does not do."""
    opened = DataflashTables.read(str(path), Selection())
    assert opened is not None
    return opened[1]


def shown(tables: dict[str, Any]) -> str:
    return str([(name, one.metadata, one.to_numpy()) for name, one in sorted(tables.items())])


def in_two(path: Path | str) -> dict[str, Any]:
    """The tables by a survey and a pass behind it."""
    log = dataflash.DataflashLog(path)
    assert log.types
    return log.read()


def compare(path: Path | str) -> bool:
    """Assert that one pass gives what two give; whether it did."""
    with np.printoptions(threshold=2000):
        expected = shown(in_two(path))
        for read in (partial(mavwire.read, path), mavwire.open_log(path).read):
            assert shown(read()) == expected
    return whole(path) is not None


def test_late_descriptions_of_new_types(tmp_path):
    log = filled(sample()).define("LATE", "Qf", "TimeUS,X", 170)
    log.add("FMTU", 9, 170, "so", "F-").add("LATE", 9_000_000, 1.5)
    path = filled(log).write(tmp_path / "late.BIN")
    assert compare(path)
    late = mavwire.read(path, "LATE")["LATE"]
    assert late.metadata["X"]["unit"] == "m/s/s"
    assert late["timestamp"].astype("int64").tolist() == [(T0 + 4) * 1_000_000]


def test_a_late_fix(tmp_path):
    """All times change with it, also those of records far in front."""
    log = Log().define("A", "QB", "TimeUS,N", 1).define("GPS", "QIH", "TimeUS,GMS,GWk", 2)
    filled(log.add("A", 1_000_000, 1)).add("GPS", 5_000_000, 100_000, 2200)
    path = log.write(tmp_path / "late.BIN")
    assert not compare(path)
    for read in (mavwire.open_log(path).read, partial(mavwire.read, path)):
        first = read("A", start=T0 - 4, end=T0 - 3)["A"]
        assert first["timestamp"].astype("int64").tolist() == [(T0 - 4) * 1_000_000]


def test_what_is_said_late_about_earlier_rows(tmp_path):
    described = filled(sample()).raw(fmt(162, "IMU", "QBfi", "TimeUS,I,AccX,Raw"))
    for log in (described, filled(sample()).add("FMTU", 9, 162, "s#oo", "F--F")):
        path = filled(log).write(tmp_path / "late.BIN")
        assert not compare(path)
    assert mavwire.read(path, "IMU")["IMU"].metadata["Raw"]["multiplier"] == "0.000001"


def test_damage(tmp_path):
    log = filled(sample().raw(b"junk")).raw(b"junk")
    assert compare(log.write(tmp_path / "x.BIN"))
    path = filled(log.define("LATE", "Qf", "TimeUS,X", 170)).write(tmp_path / "late.BIN")
    assert not compare(path)


@each_log("*.BIN")
def test_real_logs(path):
    compare(path)


def test_a_log_without_a_fix(tmp_path):
    """A short one cannot have a later one."""
    log = Log().define("A", "QB", "TimeUS,N", 1)
    for n in range(50):
        log.add("A", 5 + n, n)
    assert compare(log.write(tmp_path / "short.BIN"))
    assert not compare(filled(log).write(tmp_path / "long.BIN"))


@pytest.mark.parametrize("late", [False, True])
def test_types_and_fields_that_there_are_not(tmp_path, late):
    log = filled(sample())
    if late:
        log.add("FMTU", 9, 162, "s#oo", "F--F")
    path = log.write(tmp_path / "x.BIN")
    opened = mavwire.open_log(path)
    for read in (partial(mavwire.read, path), opened.read, opened.read):
        with pytest.raises(ValueError, match="the log describes no record type 'NOPE'"):
            read(["IMU", "NOPE"])
        with pytest.raises(ValueError, match="no wanted type has a field 'Lat'"):
            read(["IMU", "PAD"], fields=["Raw", "Lat"])
        with pytest.raises(ValueError, match="no wanted type has a field 'Axx'"):
            read(fields="Axx")
        with pytest.raises(ValueError, match="systems"):
            read(systems=1)
        assert read("FMTU", fields="UnitIds")["FMTU"].columns == ["timestamp", "UnitIds"]
    for log in (mavwire.open_log(path), opened):
        for name in ("NOPE", "", None, ["IMU"]):
            with pytest.raises(KeyError, match="describes no record type"):
                log[name]
    described = Log().define("A", "QB", "TimeUS,N", 1).define("B", "QB", "TimeUS,N", 2)
    empty = mavwire.open_log(described.add("A", 1, 1).write(tmp_path / "short.BIN"))["B"]
    assert (len(empty), empty.columns) == (0, ["timestamp", "TimeUS", "N"])


def test_times_of_a_log_that_has_none(tmp_path):
    path = Log().define("A", "B", "N", 1).add("A", 1).write(tmp_path / "x.BIN")
    assert whole(path) is None
    for log in (mavwire.open_log(path), mavwire.open_log(path)):
        with pytest.raises(ValueError, match="NOPE"):  # which is said first
            log.read("NOPE", start=1)
        with pytest.raises(ValueError, match="have no time stamps"):
            log.read("A", start=1)
        assert log.read("A")["A"]["N"].tolist() == [1]


@pytest.mark.parametrize("late", [False, True])
def test_what_a_log_says_is_kept_for_the_next_call(tmp_path, monkeypatch, late):
    log = filled(sample())
    if late:
        log.add("FMTU", 9, 162, "s#oo", "F--F")
    log = mavwire.open_log(log.write(tmp_path / "x.BIN"))
    first = shown({"IMU": log["IMU"]})

    def unwanted(*_: object) -> None:
        raise AssertionError("another look at the whole log")

    for name in ("open_dataflash", "read_dataflash"):
        monkeypatch.setattr(dataflash, name, unwanted)
    assert shown({"IMU": log["IMU"]}) == shown(log.read("IMU")) == first
    assert len(log.read()["PAD"]) > BLOCK // 100
    assert "PAD" in log.types and "IMU" in log and len(log.info().types) > 5


@pytest.mark.parametrize("since", [0, 1, 2])
def test_a_log_that_grows_between_calls(tmp_path, since):
    data = filled(sample())
    path = data.write(tmp_path / "x.BIN")
    log = mavwire.open_log(path)
    for look in (lambda: log["IMU"], lambda: log.types, log.read)[:since]:
        look()
    assert len(log["IMU"]) == 3
    data.add("IMU", 9_000_000, 0, 1.5, 2).define("NEW", "QB", "TimeUS,N", 171).add("NEW", 9, 1)
    data.write(path)
    assert log["IMU"]["Raw"].tolist() == [7, -7, 1, 2]
    assert log["NEW"]["N"].tolist() == [1]
    data.add("GPS", 9_000_000, 0, 3, 100_000, 2200, 0).define("IMU", "Q", "TimeUS", 162)
    data.add("IMU", 9_500_000).write(path)
    assert str(log["IMU"]["Raw"].tolist()) == "[7.0, -7.0, 1.0, 2.0, nan]"


def test_a_log_that_is_gone_or_closed(tmp_path):
    path = sample().write(tmp_path / "x.BIN")
    log = mavwire.open_log(path)
    os.remove(path)
    with pytest.raises(FileNotFoundError):
        log["IMU"]
    Path(path).write_bytes(b"something else, and nothing that a log would hold" * 9)
    with pytest.raises(mavwire.logs.LogFormatError):
        log["IMU"]
    log.close()
    with pytest.raises(ValueError, match="closed"):
        log.read(systems=1)


def test_late_units_that_leave_a_description_no_room(tmp_path):
    """Of five that differ in their units alone the last has no room in a row of the table."""
    log = sample()
    columns = ",".join("abcdefghijklmno")
    for number in range(5):
        log.raw(fmt(40 + number, "MANY", "h" * 15, columns))
        log.raw(record(40 + number, "h" * 15, *range(15)))
    assert len(mavwire.read(log.write(tmp_path / "all.BIN"))["MANY"]) == 5
    filled(log)
    for number in range(5):
        log.add("FMTU", 9, 40 + number, "o" * 15, "-ABCD"[number] * 15)
    path = filled(log).write(tmp_path / "late.BIN")
    assert not compare(path)
    assert len(mavwire.read(path)["MANY"]) == 4
    assert len(mavwire.read(path, units="si")["MANY"]) == 4
