"""What is asked of tables and is not there is named; names and times come in several forms."""

from __future__ import annotations

import contextlib
import datetime as dt
import importlib.util
import inspect
import os
import pickle
import signal
import sys
import time
from functools import partial
from pathlib import Path

import mavwire
import numpy as np
import pytest
from dataflash_writer import Log, sample
from mavwire import cli, traffic
from mavwire.fleet import decode
from mavwire.logs import LogFormatError, dataflash
from mavwire.logs.align import align
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
        with pytest.raises(LogFormatError, match=r"no telemetry record found; .*: .*notes\.txt"):
            look(text)


def test_paths_may_be_bytes(flight):
    path = str(flight).encode()
    assert len(mavwire.read(path, "ATTITUDE")["ATTITUDE"]) > 0
    assert sum(map(len, mavwire.scan(path, "ATTITUDE"))) == len(mavwire.open_log(path)["ATTITUDE"])


@pytest.mark.parametrize("field", ["rol", "roll_", "seq_", "UNKNOWN"])
def test_a_field_that_is_not_there_is_named(flight, field):
    for look in (mavwire.read, mavwire.scan):
        for fields in ([field], iter([field])):
            with pytest.raises(ValueError, match=repr(field)):
                look(flight, "ATTITUDE", fields=fields)


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


def test_columns_of_a_set_come_by_the_alphabet(flight):
    """In each process in the same order: else a conversion that goes on would convert all anew."""
    names = {"yaw", "roll", "pitch", "rollspeed"}
    tables = mavwire.read(flight, "ATTITUDE", fields=names)
    assert tables["ATTITUDE"].columns == [*HEADER, *sorted(names)]
    keys = dict.fromkeys(["yaw", "roll"]).keys()
    assert mavwire.read(flight, "ATTITUDE", fields=keys)["ATTITUDE"].columns[-2:] == [*keys]


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
    never = np.datetime64("NaT")
    for wrong in ("yesterday", "1.5", b"1", [1.0], object(), float("nan"), never):
        with pytest.raises(ValueError, match="a time is seconds since 1970, a datetime"):
            mavwire.read(flight, "ATTITUDE", start=wrong)


@pytest.mark.parametrize("zone", [None, "UTC", "Asia/Tokyo"])
def test_times_as_pandas_has_them(flight, zone):
    pandas = pytest.importorskip("pandas")
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    middle = table["timestamp"][len(table) // 2]
    start = pandas.Timestamp(middle, tz="UTC").tz_convert(zone)
    rest = mavwire.read(flight, "ATTITUDE", start=start)["ATTITUDE"]
    assert rest["timestamp"].tolist() == table["timestamp"][table["timestamp"] >= middle].tolist()


@pytest.mark.filterwarnings("ignore::mavwire.logs.unknown.UnknownMessageWarning")
def test_a_dialect_may_be_a_path(flight, tmp_path):
    path = tmp_path / "own.xml"
    path.write_text("<mavlink><include>minimal.xml</include></mavlink>")
    assert list(mavwire.read(flight, dialect=path)) == ["HEARTBEAT"]
    log = pickle.loads(pickle.dumps(mavwire.open_log(flight, dialect=path)))
    assert list(log.read()) == ["HEARTBEAT"]
    (row,) = mavwire.logs.conversion.convert([flight], tmp_path / "out", dialect=path)
    assert (row.error, list(row.files)) == (None, ["HEARTBEAT/flight.parquet"])


@pytest.mark.parametrize("dialect", [None, 5, b"common"])
def test_what_is_no_dialect_is_said(flight, dialect):
    for look in (mavwire.open_log, mavwire.read, mavwire.scan):
        with pytest.raises(ValueError, match="a dialect is a name, the path of an XML file"):
            look(flight, dialect=dialect)


@pytest.mark.parametrize("wrong", [5, ["ATTITUDE"], b"ATTITUDE"])
def test_a_clock_is_the_name_of_a_type(flight, wrong):
    log = mavwire.open_log(flight)
    for look in (partial(log.align, "ATTITUDE"), partial(align, log.read("ATTITUDE"))):
        with pytest.raises(ValueError, match="on is the name of a message type, not"):
            look(on=wrong)


@pytest.mark.parametrize("wrong", [5, [1], [None], b"roll"])
def test_names_are_texts(flight, wrong):
    log = mavwire.open_log(flight)
    for look in (
        lambda: mavwire.read(flight, fields=wrong),
        lambda: log.align(wrong, rate="1s"),
        lambda: decode(flight, None, "ATTITUDE", wrong),
    ):
        with pytest.raises(ValueError, match="a name is a text, not"):
            look()


@pytest.mark.parametrize("argument", ["types", "systems", "fields"])
def test_the_first_wrong_one_of_many_is_refused(flight, argument):
    def values():
        yield from (None, None)
        raise AssertionError("the others were taken, too")

    log = mavwire.open_log(flight)
    for look in (log.read, partial(mavwire.read, flight), partial(mavwire.scan, flight)):
        with pytest.raises(ValueError, match="is a .*, not None"):
            look(**{argument: values()})


def test_rows_of_a_batch_are_a_number(flight):
    for wrong in ("a", 0, -1, 1.5, None):
        with pytest.raises(ValueError, match="batch_rows must be at least 1, not"):
            mavwire.scan(flight, "ATTITUDE", batch_rows=wrong)
    expected = len(mavwire.open_log(flight)["ATTITUDE"])
    for rows in (2**70, np.int64(10)):
        batches = mavwire.scan(flight, "ATTITUDE", batch_rows=rows)
        assert sum(map(len, batches)) == expected


@pytest.mark.parametrize("wrong", [5, (1,), (1, "2"), "12", {}])
def test_a_range_of_a_log_is_two_numbers(flight, wrong):
    with pytest.raises(ValueError, match="a range is the first byte and the end, not"):
        decode(flight, wrong)


def test_a_date_is_no_span_of_time(flight):
    log = mavwire.open_log(flight)
    for how in ({"rate": np.datetime64("2015")}, {"rate": 1, "tolerance": np.datetime64("2015")}):
        with pytest.raises(ValueError, match="is a span of time such as"):
            log.align("ATTITUDE", **how)


def test_folders_are_named_with_what_to_do(flight, tmp_path, capsys):
    for look in (mavwire.open_log, mavwire.read, lambda path: list(mavwire.scan(path))):
        with pytest.raises(IsADirectoryError, match="name the logs in it") as caught:
            look(tmp_path)
        assert caught.value.filename == str(tmp_path)
    assert cli.main(["cut", str(tmp_path), "-o", str(tmp_path / "x.tlog")]) == 1
    assert "is a folder: name the logs in it" in capsys.readouterr().err


def test_an_open_log_stands_for_its_path_and_one_log_is_read(flight, tmp_path):
    from mavwire import plots

    wanted = len(mavwire.read(flight, "ATTITUDE")["ATTITUDE"])
    log = mavwire.open_log(flight)
    assert plots.plot(log, "ATTITUDE.roll", tmp_path / "x.html").points
    assert sum(map(len, mavwire.scan(log, "ATTITUDE"))) == wanted
    assert len(mavwire.read(log, "ATTITUDE")["ATTITUDE"]) == wanted
    with pytest.raises(TypeError, match="read takes one log: use mavwire.scan for several"):
        mavwire.read([flight, flight])


@pytest.mark.parametrize("name", ["IMU", "ATTITUDE"])
def test_a_scan_names_the_log_that_cannot_be_read(flight, tmp_path, name):
    missing, pattern = str(tmp_path / "nope.BIN"), str(tmp_path / "*.tlog")
    looks = [mavwire.scan]
    if importlib.util.find_spec("polars") is not None:
        looks.append(mavwire.scan_polars)
    for look in looks:
        for paths, error in [
            (missing, FileNotFoundError),
            ([missing], FileNotFoundError),
            (pattern, FileNotFoundError),
            (str(tmp_path), IsADirectoryError),
        ]:
            with pytest.raises(error) as caught:
                look(paths, name)
            assert caught.value.filename == (paths if isinstance(paths, str) else paths[0])
        with pytest.raises(ValueError, match="no logs given"):
            look([], name)
        with pytest.raises(FileNotFoundError, match="nope"):
            list(look([flight, missing], name))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_pipes_are_refused_and_not_waited_for(tmp_path, capsys):
    pipe = tmp_path / "pipe.tlog"
    os.mkfifo(pipe)
    scan, frame = mavwire.scan, mavwire.scan_polars
    looks = [mavwire.open_log, mavwire.read, lambda path: list(scan(path, "ATTITUDE"))]
    if importlib.util.find_spec("polars") is not None:
        looks.append(lambda path: frame(path, "ATTITUDE").collect())
    for look in looks:
        with pytest.raises(OSError, match="save what comes out of it in a file"):
            look(pipe)
    writing = [[name, "-o", str(tmp_path / f"{name}.html")] for name in ("convert", "cut", "map")]
    plot = ["plot", "ATTITUDE.roll", "-o", str(tmp_path / "plot.html")]
    for command, *rest in (*writing, plot, ["info"], ["dump"]):
        assert cli.main([command, str(pipe), *rest]) != 0
        assert "a pipe or a socket" in capsys.readouterr().err


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="needs a device without end")
def test_devices_are_refused_and_not_read_for_ever(tmp_path):
    looks = [mavwire.open_log, mavwire.read, lambda path: list(mavwire.scan(path, "ATTITUDE"))]
    for look in looks:
        with pytest.raises(OSError, match="a device is no log"):
            look("/dev/zero")
    assert cli.main(["convert", "/dev/zero", "-o", str(tmp_path / "out"), "--types", "IMU"]) == 1


@pytest.mark.parametrize("types", [30, [30], ["ATTITUDE", None], np.array([30]), np.array(30)])
def test_types_are_names_or_classes(flight, types):
    log = mavwire.open_log(flight)
    for look in (log.read, log.messages, lambda types: mavwire.scan(flight, types)):
        with pytest.raises(ValueError, match="a type is a name or a message class, not"):
            look(types)


@pytest.mark.parametrize("systems", [np.array([1]), np.array(1), np.uint8(1)])
def test_systems_may_be_of_numpy(flight, systems):
    found = mavwire.read(flight, "ATTITUDE", systems=systems)["ATTITUDE"]
    assert len(found) == len(mavwire.read(flight, "ATTITUDE", systems=1)["ATTITUDE"]) > 0


def test_a_time_that_is_none_is_said(flight):
    times = [np.datetime64("NaT")]
    if importlib.util.find_spec("pandas") is not None:
        times.append(importlib.import_module("pandas").NaT)
    for one in times:
        with pytest.raises(ValueError, match="a time is .*, not NaT"):
            mavwire.read(flight, start=one)
    with pytest.raises(ValueError, match="a time is .*, not 1000"):
        mavwire.read(flight, start=10**400)


@pytest.mark.parametrize("kind", [str, dt.datetime.fromisoformat])
def test_a_time_that_utc_has_no_year_for(flight, kind):
    first, last = kind("0001-01-01T00:00:00+14:00"), kind("9999-12-31T23:00:00-14:00")
    every = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    assert len(mavwire.read(flight, "ATTITUDE", start=first, end=last)["ATTITUDE"]) == len(every)
    assert len(mavwire.read(flight, "ATTITUDE", start=last)["ATTITUDE"]) == 0


@pytest.mark.skipif(not hasattr(time, "tzset"), reason="the zone cannot be changed")
def test_a_local_time_that_has_no_year_in_utc(flight, monkeypatch):
    every = len(mavwire.read(flight, "ATTITUDE")["ATTITUDE"])
    for zone in ("XXX12", "XXX-12"):  # hours behind UTC, and ahead
        try:
            with monkeypatch.context() as changed:
                changed.setenv("TZ", zone)
                time.tzset()
                first, last = dt.datetime.min, dt.datetime.max
                assert (
                    len(mavwire.read(flight, "ATTITUDE", start=first, end=last)["ATTITUDE"])
                    == every
                )
                assert len(mavwire.read(flight, "ATTITUDE", start=last)["ATTITUDE"]) == 0
        finally:
            time.tzset()


def test_one_type_is_aligned_by_its_name(flight):
    log = mavwire.open_log(flight)
    expected = log.align(["ATTITUDE"], rate="1s")
    assert "ATTITUDE.roll" in expected.columns
    for table in (
        log.align("ATTITUDE", rate="1s"),
        align(log.read("ATTITUDE"), "ATTITUDE", rate="1s"),
    ):
        assert table.name == "ATTITUDE" and table.columns == expected.columns


def test_times_as_texts_are_utc_where_they_name_no_zone(flight):
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    start, end = table["timestamp"][3], table["timestamp"][7]
    for texts in ((f"{start}", f"{end}"), (f"{start}Z", f"{end}+00:00")):
        found = mavwire.read(flight, "ATTITUDE", start=texts[0], end=texts[1])["ATTITUDE"]
        assert found["timestamp"].tolist() == table["timestamp"][3:7].tolist()


def test_seconds_are_microseconds_as_records_have_them(flight):
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    micros = table["timestamp"].astype("int64")
    # Some of these floats are above the time that they stand for, and some below.
    for row in range(1, len(table)):
        time = float(micros[row]) / 1e6
        assert len(mavwire.read(flight, "ATTITUDE", end=time)["ATTITUDE"]) == row
        assert len(mavwire.read(flight, "ATTITUDE", start=time)["ATTITUDE"]) == len(table) - row


@pytest.mark.parametrize(
    "end", [5, 4.5, "1970-01-01T00:00:05", dt.datetime.fromtimestamp(1, dt.UTC)]
)
def test_a_span_that_holds_nothing_is_an_error(flight, tmp_path, end, capsys):
    for look in (
        mavwire.read,
        mavwire.scan,
        lambda *a, **how: mavwire.open_log(flight).messages(**how),
    ):
        with pytest.raises(ValueError, match="start is a time before end"):
            look(flight, start=5, end=end)
    words = ["cut", str(flight), "-o", str(tmp_path / "x"), "--start", "5", "--end", "1970-01-01"]
    assert cli.main(words) == 1
    assert "error: start is a time before end" in capsys.readouterr().err


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


def test_types_of_both_kinds_of_logs_at_once(flight, tmp_path):
    onboard = sample().write(tmp_path / "onboard.BIN")
    for number, logs in enumerate(([flight, onboard], [onboard, flight])):
        found = mavwire.scan(logs, ["ATTITUDE", "IMU"], fields=["roll", "Raw"])
        assert {(one.name, str(one.path)) for one in found} == {
            ("ATTITUDE", str(flight)),
            ("IMU", str(onboard)),
        }  # fmt: skip
        assert sum(map(len, mavwire.scan(logs, "IMU"))) == 3
        with pytest.raises(ValueError, match="has no message 'IMX'"):
            list(mavwire.scan(logs, ["ATTITUDE", "IMX"]))
        with pytest.raises(ValueError, match="field 'Typo'"):
            list(mavwire.scan(logs, ["ATTITUDE", "IMU"], fields=["roll", "Raw", "Typo"]))
        out = tmp_path / f"out{number}"
        words = ["convert", *map(str, logs), "-o", str(out), "--types", "ATTITUDE,IMU", "--quiet"]
        assert cli.main(words) == 0
        assert sorted(one.name for one in out.glob("*/*")) == ["flight.parquet", "onboard.parquet"]
    with pytest.raises(ValueError, match="has no message 'IMU'"):
        mavwire.scan([flight, flight], "IMU")
    pytest.importorskip("polars")
    assert len(mavwire.scan_polars([flight, onboard], "IMU").collect()) == 3
    pytest.importorskip("dask.dataframe")
    from mavwire.fleet import dask_frame

    assert len(dask_frame([flight, onboard], "IMU")) == 3


def test_a_list_of_logs_is_opened_log_by_log(tmp_path):
    path = sample().write(tmp_path / "flight.BIN")
    found = mavwire.scan([path, tmp_path / "not there yet"], "IMU")
    assert len(next(found)) == 3
    with pytest.raises(FileNotFoundError):
        next(found)


def test_what_is_in_a_log(flight, tmp_path):
    log, onboard = mavwire.open_log(flight), mavwire.open_log(sample().write(tmp_path / "f.BIN"))
    assert "ATTITUDE" in log and "IMU" in onboard
    for name in ("PING", "NOPE", "IMU", "attitude", ""):
        assert name not in log
    assert "ATTITUDE" not in onboard and "NOPE" not in onboard
    described = Log().define("ABC", "Q", "TimeUS").define("DEF", "Q", "TimeUS").add("ABC", 1)
    other = mavwire.open_log(described.write(tmp_path / "other.BIN"))
    assert "ABC" in other and "DEF" not in other and "DEF" in other.types


def test_parts_of_a_table(flight):
    table = mavwire.open_log(flight)["ATTITUDE"]
    rolls, count = table["roll"].tolist(), len(table)
    assert table.slice(-5, 3)["roll"].tolist() == rolls[-5:-2]
    assert table.slice(-count - 9, 2)["roll"].tolist() == rolls[:2]
    for rows in (slice(10, 20), slice(-3, None), slice(None, 4), slice(9, 2), slice(count, None)):
        assert table[rows]["roll"].tolist() == rolls[rows]
    assert table.slice(10**400, 2).columns == table.columns
    assert len(table.slice(10**400, 2)) == len(table.slice(count, 1)) == 0
    assert table.slice(3, 10**400)["roll"].tolist() == rolls[3:]
    with pytest.raises(ValueError, match="steps of 1"):
        table[::2]
    with pytest.raises(ValueError, match="rows must be"):
        table.slice(0, -1)
    assert "roll" in table and "rol" not in table


def test_a_dataflash_log_is_surveyed_when_it_is_needed(tmp_path, monkeypatch):
    path = sample().write(tmp_path / "flight.BIN")
    surveys = []
    open_tables, read_tables = dataflash.open_dataflash, dataflash.read_dataflash

    def opening(log, path):
        surveys.append(log)
        return open_tables(log, path)

    def reading(log, path, query):
        surveys.append(log)
        return read_tables(log, path, query)

    monkeypatch.setattr(dataflash, "open_dataflash", opening)
    monkeypatch.setattr(dataflash, "read_dataflash", reading)
    log = mavwire.open_log(path)
    assert surveys == []
    assert len(log["IMU"]) == len(log.read("IMU")["IMU"]) == 3
    assert "IMU" in log.types and surveys == [path]


def test_a_scan_of_one_type_is_a_stream(flight, tmp_path):
    pa = pytest.importorskip("pyarrow")
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"].to_arrow()
    pieces = mavwire.scan([flight, flight], "ATTITUDE", batch_rows=10)
    reader = pa.RecordBatchReader.from_stream(pieces)
    first = reader.read_next_batch()
    assert 0 < len(first) <= len(table) and first.schema == table.schema
    assert len(first) + sum(map(len, reader)) == 2 * len(table)
    assert len(pa.table(pieces)) == 2 * len(table), "a stream begins at the beginning"
    narrow = mavwire.scan(flight, "ATTITUDE", fields=["yaw", "roll"])
    assert pa.table(narrow).column_names == [*HEADER, "yaw", "roll"]
    assert len(pa.table(mavwire.scan(flight, "PING"))) == 0
    named = pa.table(mavwire.scan(flight, "HEARTBEAT", enums="names", batch_rows=1))
    values = mavwire.read(flight, "HEARTBEAT", enums="names")["HEARTBEAT"]["type"]
    assert named["type"].to_pylist() == values.tolist()
    for types in (None, ["ATTITUDE", "HEARTBEAT"]):
        with pytest.raises(TypeError, match="name one type"):
            pa.table(mavwire.scan(flight, types))


def failing_stream(flight, error):
    pa = pytest.importorskip("pyarrow")
    batches = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]._batches

    def tables():
        yield batches
        raise error

    reader = pa.RecordBatchReader._import_from_c_capsule(batches.stream(tables()))
    assert len(reader.read_next_batch()) > 0
    return reader


def test_a_stream_that_fails_says_so_again(flight):
    reader = failing_stream(flight, ValueError("no more of it"))
    for _ in range(2):
        with pytest.raises(Exception, match="no more of it"):
            reader.read_next_batch()


def test_ctrl_c_in_a_stream_reaches_the_program(flight):
    reader = failing_stream(flight, KeyboardInterrupt())
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            with contextlib.suppress(Exception):
                reader.read_next_batch()
            while True:  # what a program does next
                pass
    finally:
        signal.signal(signal.SIGINT, handler)


def test_a_stream_of_logs_that_describe_a_type_in_several_ways(tmp_path):
    pa = pytest.importorskip("pyarrow")
    one = Log().define("ABC", "QBZ", "TimeUS,Count,Text").add("ABC", 1, 2, b"x")
    other = Log().define("ABC", "QI", "TimeUS,Count").add("ABC", 1, 200)
    paths = [one.write(tmp_path / "one.BIN"), other.write(tmp_path / "other.BIN")]
    found = pa.table(mavwire.scan(paths, "ABC"))
    assert found["Count"].to_pylist() == [2, 200]
    assert found["Text"].to_pylist() == ["x", None]


def test_duckdb_reads_a_scan(flight):
    duckdb = pytest.importorskip("duckdb")
    pytest.importorskip("pyarrow")
    pieces = mavwire.scan(flight, "ATTITUDE")
    count = len(mavwire.open_log(flight)["ATTITUDE"])
    with duckdb.connect() as database:
        database.register("pieces", pieces)
        assert database.sql("select count(*) from pieces").fetchall() == [(count,)]


@pytest.mark.parametrize("systems", ["1", ["1"], [None], 256, -1, np.array("1"), 1.0])
def test_systems_are_numbers(flight, systems):
    with pytest.raises(ValueError, match="a system id is"):
        mavwire.read(flight, systems=systems)


def test_logs_are_pickled_by_path_and_arguments(flight, tmp_path):
    from mavwire.dialects import load
    from mavwire.dialects.v20 import common

    for dialect in ("ardupilotmega", common):
        log = mavwire.open_log(flight, dialect=dialect, resync="skip")
        other = pickle.loads(pickle.dumps(log))
        assert (other.path, other.resync, other.dialect) == (log.path, "skip", log.dialect)
        assert len(other) == len(log)
    log.close()
    with pytest.raises(ValueError, match="closed"):
        pickle.loads(pickle.dumps(log)).read()
    onboard = mavwire.open_log(sample().write(tmp_path / "onboard.BIN"))
    assert onboard.types == pickle.loads(pickle.dumps(onboard)).types
    loaded = load(
        '<mavlink><messages><message id="9" name="A"><field type="char" name="b">x</field></message></messages></mavlink>',
        name="made",
    )
    with pytest.raises(TypeError, match="of this process alone"):
        pickle.dumps(mavwire.open_log(flight, dialect=loaded))


def test_a_scan_is_pickled_by_its_arguments(flight):
    pl = pytest.importorskip("polars")
    scan = mavwire.scan_polars(flight, "ATTITUDE", systems=1, units="si")
    frame = scan.filter(pl.col("seq") > 100).select("timestamp", "pitch")
    other = pickle.loads(pickle.dumps(frame))
    assert len(other.collect()) > 0
    assert other.collect().equals(frame.collect())


def test_the_types_of_a_log(flight, tmp_path):
    tables = mavwire.read(flight)
    path = tmp_path / "log.tlog"
    path.write_bytes(flight.read_bytes())
    log = mavwire.open_log(path)
    columns = {
        name: [one for one in table.columns if not one.endswith("_raw")]
        for name, table in tables.items()
    }
    assert {
        n: [c for c in some if not c.endswith("_raw")] for n, some in log.types.items()
    } == columns
    path.write_bytes(b"")
    assert log.types == {}


def test_what_is_meant_is_guessed(flight):
    with pytest.raises(KeyError, match="did you mean 'ATTITUDE'"):
        mavwire.open_log(flight)["ATITUDE"]
    pytest.importorskip("polars")
    with pytest.raises(ValueError, match="one message type"):
        mavwire.scan_polars(flight, ["ATTITUDE", "VFR_HUD"])


@pytest.mark.parametrize("library", ["numpy", "pandas", "polars", "pyarrow"])
def test_what_is_missing_names_its_extra(flight, monkeypatch, library):
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    monkeypatch.setitem(sys.modules, library, None)
    look = {"pyarrow": "to_arrow"}.get(library, f"to_{library}")
    with pytest.raises(ImportError, match=rf"{library} is needed: pip install 'mavwire\[data\]'"):
        getattr(table, look)()


def test_an_open_file_is_no_list_of_logs(flight):
    with flight.open("rb") as file, pytest.raises(TypeError, match="named by its path"):
        mavwire.scan(file)


@pytest.mark.parametrize(
    ("function", "names"),
    [
        (
            mavwire.read,
            "path types systems fields start end units enums invalid unknown wide dialect",
        ),
        (mavwire.scan_polars, "paths message systems start end units enums invalid dialect"),
        (dataflash.DataflashLog.messages, "self types systems start end"),
    ],
)
def test_arguments_of_a_query_are_in_the_signature(function, names):
    assert [*inspect.signature(function).parameters] == names.split()


def test_an_unknown_argument_is_named_beside_the_known_ones(flight):
    known = "it takes path, types, systems, fields, start, end, units, enums, invalid, unknown, wide, dialect"
    with pytest.raises(TypeError, match=f"has no argument 'unit'; did you mean 'units'.; {known}"):
        mavwire.read(flight, unit="si")
    with pytest.raises(TypeError, match=r"messages\(\) has no argument 'fields'"):
        mavwire.open_log(flight).messages(fields="roll")
    with pytest.raises(TypeError, match=r"read\(\): missing a required argument: 'path'"):
        mavwire.read()
