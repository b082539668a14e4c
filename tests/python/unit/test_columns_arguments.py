"""What is asked of tables and is not there is named; names and times come in several forms."""

from __future__ import annotations

from pathlib import Path

import mavwire
import pytest
from dataflash_writer import Log, sample
from mavwire import traffic
from mavwire.logs import LogFormatError
from unit.column_tools import HEADER, log_of_every_type


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 2_000)
    return path


def test_what_is_no_log_is_said(tmp_path):
    text = tmp_path / "notes.txt"
    text.write_text("no telemetry in here, only words\n" * 100)
    for look in (mavwire.read, lambda path: list(mavwire.scan(path))):
        with pytest.raises(LogFormatError, match=r"no record in it: .*notes\.txt"):
            look(text)


def test_paths_may_be_bytes(flight):
    path = str(flight).encode()
    assert len(mavwire.read(path, "ATTITUDE")["ATTITUDE"]) > 0
    assert sum(map(len, mavwire.scan(path, "ATTITUDE"))) == len(mavwire.open_log(path)["ATTITUDE"])


@pytest.mark.parametrize("field", ["rol", "roll_", "seq_", "UNKNOWN"])
def test_a_field_that_is_not_there_is_named(flight, field):
    for look in (mavwire.read, mavwire.scan):
        with pytest.raises(ValueError, match=repr(field)):
            look(flight, "ATTITUDE", fields=[field])


def test_fields_by_the_names_of_their_columns(tmp_path):
    path = tmp_path / "all.tlog"
    log_of_every_type(path, each=1)
    tables = mavwire.read(path, ["PING", "STATUSTEXT"], fields=["seq", "text_raw", "severity"])
    assert tables["PING"].columns == [*HEADER, "seq_"]
    assert {"severity", "text_raw"} <= set(tables["STATUSTEXT"].columns)


def test_columns_come_in_the_order_that_is_asked_for(flight):
    wanted = ["yaw", "roll", "yaw"]
    table = mavwire.read(flight, "ATTITUDE", fields=wanted)["ATTITUDE"]
    assert table.columns == [*HEADER, "yaw", "roll"]
    for batch in mavwire.scan(flight, "ATTITUDE", fields=wanted):
        assert batch.columns == table.columns
    none = mavwire.read(flight, "PING", fields=["target_system", "seq"])["PING"]
    assert none.columns == [*HEADER, "target_system", "seq_"]


@pytest.mark.parametrize("name", ["UNKNOWN", "UNKNOWN_54321"])
def test_unknown_ids_are_in_no_table(flight, tmp_path, name):
    for look in (mavwire.read, mavwire.scan):
        with pytest.raises(ValueError, match="in no table"):
            look(flight, ["ATTITUDE", name])


def test_times_as_numpy_has_them(flight):
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    middle = table["timestamp"][len(table) // 2]
    rest = mavwire.read(flight, "ATTITUDE", start=middle)["ATTITUDE"]
    assert rest["timestamp"].tolist() == table["timestamp"][table["timestamp"] >= middle].tolist()
    for wrong in ("2024-01-31", b"1", [1.0], object()):
        with pytest.raises(ValueError, match="a time is seconds since 1970, a datetime"):
            mavwire.read(flight, "ATTITUDE", start=wrong)


@pytest.mark.parametrize(
    ("types", "fields", "said"),
    [("IMU", "Typo", "'Typo'"), ("NOPE", None, "'NOPE'"), (None, "Typo", "'Typo'")],
)
def test_what_no_log_describes_is_named(tmp_path, types, fields, said):
    from mavwire.fleet import decode

    path = sample().write(tmp_path / "flight.BIN")
    with pytest.raises(ValueError, match=said):
        mavwire.read(path, types, fields=fields)
    with pytest.raises(ValueError, match=said):
        list(mavwire.scan([path, path], types, fields=fields))
    with pytest.raises(ValueError, match=said):
        decode(path, None, types, fields)


def test_what_one_of_the_logs_describes_is_found(tmp_path):
    path = sample().write(tmp_path / "flight.BIN")
    other = Log().define("ABC", "Q", "TimeUS").add("ABC", 1).write(tmp_path / "other.BIN")
    assert [len(one) for one in mavwire.scan([path, other], "IMU", fields="Raw")] == [3]
    with pytest.raises(ValueError, match="'IMU'"):
        mavwire.read(other, "IMU")


def test_a_list_of_logs_is_opened_log_by_log(tmp_path):
    path = sample().write(tmp_path / "flight.BIN")
    found = mavwire.scan([path, tmp_path / "not there yet"], "IMU")
    assert len(next(found)) == 3
    with pytest.raises(FileNotFoundError):
        next(found)
