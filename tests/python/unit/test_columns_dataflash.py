"""Tables of dataflash logs hold exactly what DFReader's messages say."""

from __future__ import annotations

import gzip
import math
import os
from array import array
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import mavwire
import numpy as np
import pytest
from dataflash_writer import FMT, Log, fmt, record, sample
from mavwire.DFReader import DFReader_binary, DFReader_text
from mavwire.logs import DataflashLog, LogFormatError
from mavwire.logs.conversion import convert
from mavwire.logs.formats import TABLE_FORMATS

ROOT = Path(__file__).parents[3]
LOGS = Path(os.environ.get("MAVWIRE_LOGS", ROOT.parent / "shared" / "logs"))
REAL = sorted([*LOGS.glob("*.BIN"), *LOGS.glob("*.log")]) if LOGS.is_dir() else []
T0 = 315_964_800 - 18 + 2200 * 7 * 86_400 + 100


def every_format() -> Log:
    """A log with a field of every format character and random values in it."""
    random, log = Random(3), Log()
    log.define("NUM1", "QbBhHiIqQ", "TimeUS,b,B,h,H,i,I,q,Q")
    log.define("NUM2", "QgfdcCeEL", "TimeUS,g,f,d,c,C,e,E,L")
    log.define("TEXT", "QnNZMa", "TimeUS,n,N,Z,M,a")
    for n in range(50):
        time = 1000 * n

        def bits(size: int, signed: bool) -> int:
            low = -(1 << size - 1) if signed else 0
            return random.choice([low, low + (1 << size) - 1, low + random.getrandbits(size)])

        log.add("NUM1", time, bits(8, True), bits(8, False), bits(16, True), bits(16, False),
                bits(32, True), bits(32, False), bits(64, True), bits(64, False))  # fmt: skip
        half = random.choice([math.inf, math.nan, 6.1e-5, random.uniform(-9, 9)])
        log.add("NUM2", time, half, random.uniform(-9, 9), random.uniform(-9, 9), bits(16, True),
                bits(16, False), bits(32, True), bits(32, False), bits(32, True))  # fmt: skip
        text = random.choice([b"abc", "µ".encode(), b"\xb5\xff", b"a\0b"])
        log.add("TEXT", time, text[:4], text, text * 9, random.randrange(-128, 128),
                random.randbytes(64))  # fmt: skip
    return log


def same(found: Any, value: Any) -> bool:
    """Whether a value of a table is that of a message."""
    if isinstance(value, float):
        return bool(found == value) or (math.isnan(found) and math.isnan(value))
    if isinstance(value, array):
        return bool(found.tolist() == value.tolist())
    return bool(found == value)


def compare(path: Path | str, text: bool = False) -> int:
    """Assert that tables hold what DFReader says; how many records that were."""
    tables = mavwire.read(path)
    arrays = {name: table.to_numpy() for name, table in tables.items()}
    rows = dict.fromkeys(arrays, 0)
    with (DFReader_text if text else DFReader_binary)(str(path)) as reader:
        while (msg := reader.recv_msg()) is not None:
            kind = msg.get_type()
            columns, row = arrays[kind], rows[kind]
            rows[kind] += 1
            stamp = columns["timestamp"][row]
            assert round(msg._timestamp * 1e6) == stamp.astype("int64"), (kind, row)
            for name in msg.get_fieldnames():
                found, value = columns[name][row], getattr(msg, name)
                assert same(found, value), (kind, name, row, found, value)
    assert rows == {name: len(table) for name, table in tables.items()}
    return sum(rows.values())


def test_every_format_character(tmp_path):
    assert compare(every_format().write(tmp_path / "all.BIN")) == 150 + 4


def test_a_flight(tmp_path):
    path = sample().write(tmp_path / "flight.BIN")
    assert compare(path) == 25
    imu = mavwire.open_log(path)["IMU"]
    assert imu["timestamp"].astype("int64").tolist()[0] == (T0 - 5) * 1_000_000 + 4000
    assert imu.metadata["AccX"] == {"field": "AccX", "unit": "m/s/s"}
    assert imu.metadata["Raw"] == {"field": "Raw", "unit": "m/s/s", "multiplier": "60"}
    assert imu.metadata["I"] == {"field": "I", "instance": "true"}
    assert imu.metadata["TimeUS"]["unit"] == "s"
    assert imu["AccX"].dtype == np.float32 and imu["Raw"].dtype == np.int16


@pytest.mark.parametrize("path", REAL, ids=lambda path: path.name)
def test_real_logs(path):
    assert compare(path, text=path.suffix == ".log") > 100


@pytest.mark.skipif(bool(REAL), reason="there are real logs")
def test_there_are_real_logs():
    pytest.skip(f"no logs in {LOGS}: set MAVWIRE_LOGS to a directory of .BIN and .log files")


def test_arrow_is_valid(tmp_path):
    pa = pytest.importorskip("pyarrow")
    for table in mavwire.read(every_format().write(tmp_path / "all.BIN")).values():
        pa.table(table).validate(full=True)


def test_units(tmp_path):
    path = sample().write(tmp_path / "flight.BIN")
    imu = mavwire.read(path, "IMU", units="si")["IMU"]
    assert imu["AccX"].tolist()[:2] == [1.5, 2.5]
    assert imu["Raw"].tolist() == [420.0, -420.0, 60.0]
    assert imu["TimeUS"][0] == 0.004
    assert imu.metadata["Raw"] == {"field": "Raw", "unit": "m/s/s"}
    latitude = mavwire.read(path, "GPS", units="si")["GPS"]["Lat"]
    assert latitude.tolist() == [-35.363262]


def test_multipliers_in_single_precision_scale_as_written(tmp_path):
    """ArduPilot 4.7 writes a factor of 0.001 as the double of the float32 that is next to it."""
    written = float(np.float32(0.001))
    binary = sample().add("MULT", 1, ord("C"), written).add("UNIT", 1, ord("s"), "s")
    binary.add("FMTU", 2, 160, "--ssss", "F--C--").add("GPS", 6_000_000, 0, 3, 385_101_600, 1, 1)
    lines = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 6, 20, UNIT, QbZ, TimeUS,Id,Label",
        "FMT, 7, 20, MULT, Qbd, TimeUS,Id,Mult",
        "FMT, 8, 20, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds",
        "FMT, 9, 20, GPS, QI, TimeUS,GMS",
        f"UNIT, 1, {ord('s')}, s",
        f"MULT, 1, {ord('C')}, {written!r}",
        "FMTU, 1, 9, ss, -C",
        "GPS, 6000000, 385101600",
    ]
    text = tmp_path / "text.log"
    text.write_text("\n".join(lines) + "\n")
    assert written == 0.0010000000474974513
    for path in (binary.write(tmp_path / "binary.BIN"), str(text)):
        assert mavwire.read(path, "GPS", units="si")["GPS"]["GMS"][-1] == 385101.6
        assert mavwire.read(path, "GPS")["GPS"].metadata["GMS"]["multiplier"] == "0.001"
        reader = DFReader_text if path.endswith(".log") else DFReader_binary
        with reader(path) as log:
            assert log.mult_lookup["C"] == 0.001
            assert log.messages["GPS"].fmt.get_unit("GMS") == "ms"


def test_selection(tmp_path):
    log = mavwire.open_log(sample().write(tmp_path / "flight.BIN"))
    assert isinstance(log, DataflashLog)
    assert len(log) == 25
    assert log["IMU"].columns == ["timestamp", "TimeUS", "I", "AccX", "Raw"]
    table = log.read("IMU", fields="Raw")["IMU"]
    assert table.columns == ["timestamp", "Raw"]
    assert table["Raw"].tolist() == [7, -7, 1]
    late = log.read(["IMU", "MODE"], start=T0)
    assert {name: len(table) for name, table in late.items()} == {"IMU": 1, "MODE": 1}
    assert [msg.get_type() for msg in log.messages(["IMU", "MODE"], start=T0)] == ["IMU", "MODE"]
    assert len(log.read("FMTU")["FMTU"]) == 1
    with pytest.raises(KeyError, match="NOPE"):
        log["NOPE"]
    with pytest.raises(ValueError, match="NOPE"):
        log.read("NOPE")
    with pytest.raises(ValueError, match="Axx"):
        log.read("IMU", fields="Axx")
    for read in (log.read, log.messages, partial(mavwire.read, log.path)):
        with pytest.raises(ValueError, match="systems"):
            read("IMU", systems=1)
    log.close()
    with pytest.raises(ValueError, match="closed"):
        log["IMU"]


def test_info(tmp_path):
    info = mavwire.open_log(sample().raw(b"junk").write(tmp_path / "flight.BIN")).info()
    assert (info.messages, info.bad, info.bad_bytes) == (25, [(1383, 4)], 4)
    assert info.types["IMU"].messages == 3
    assert info.types["IMU"].last == T0 + 1
    assert not info.senders and info.stamped


def test_rows_of_a_dataflash_log_have_no_sender(tmp_path):
    table = mavwire.read(sample().write(tmp_path / "flight.BIN"))["IMU"]
    for who in ((1,), (1, 1)):
        with pytest.raises(ValueError, match="'sysid': a dataflash log is of one system"):
            table.sender(*who)


def test_align_and_wide(tmp_path):
    path = sample().write(tmp_path / "flight.BIN")
    wide = mavwire.read(path, "IMU", wide=True)["IMU"]
    assert wide.name == "IMU"
    assert wide.columns[:2] == ["timestamp", "IMU[0].TimeUS"]
    assert str(wide["IMU[0].AccX"].tolist()) == "[1.5, nan, nan]"
    assert str(wide["IMU[1].Raw"].tolist()) == "[nan, -7.0, nan]"
    filled = mavwire.open_log(path)["IMU"].wide(tolerance="10s")
    assert str(filled["IMU[1].Raw"].tolist()) == "[nan, -7.0, -7.0]"
    with pytest.raises(ValueError, match="has a field 'Message_raw'"):
        mavwire.open_log(path).align("MSG", rate="1s", fields="Message_raw")
    aligned = mavwire.open_log(path).align(["IMU", "GPS"], on="MODE")
    assert aligned["IMU[0].Raw"].tolist()[1] == 1


def test_instances_of_telemetry(tmp_path):
    from mavwire import traffic

    path = tmp_path / "flight.tlog"
    traffic.generate(path, 3000, systems=1)
    table = mavwire.open_log(path)["BATTERY_STATUS"]
    parts = table.instances()
    assert sum(map(len, parts.values())) == len(table)
    assert set(parts) == {f"BATTERY_STATUS[{n}]" for n in np.unique(table["id"])}
    wide = table.wide()
    assert len(wide) == len(np.unique(table["timestamp"]))
    assert "BATTERY_STATUS[0].voltages" in wide.columns
    traffic.generate(path, 3000, systems=2)
    with pytest.raises(ValueError, match="systems"):
        mavwire.read(path, wide=True)
    assert len(mavwire.read(path, "ATTITUDE", wide=True)["ATTITUDE"])


def test_a_column_of_many_values_is_no_instance(tmp_path):
    log = Log().define("X", "QI", "TimeUS,I", 9)
    for n in range(5000):
        log.add("X", n, n)
    table = mavwire.read(log.write(tmp_path / "x.BIN"))["X"]
    with pytest.raises(ValueError, match="4096"):
        table._batches.split("I")


def test_a_type_that_is_described_anew(tmp_path):
    log = Log().define("X", "QB", "TimeUS,A", 9).add("X", 1, 5)
    log.define("X", "QfB", "TimeUS,A,B", 9).add("X", 2, 1.5, 6)
    log.define("X", "QB", "TimeUS,A", 10).add("X", 3, 7)
    path = log.write(tmp_path / "x.BIN")
    table = mavwire.read(path)["X"]
    assert table.columns == ["timestamp", "TimeUS", "A", "A_", "B"]
    assert table["TimeUS"].tolist() == [1, 2, 3]
    assert str(table["A"].tolist()) == "[5.0, nan, 7.0]"
    assert str(table["A_"].tolist()) == "[nan, 1.5, nan]"
    assert str(table["B"].tolist()) == "[nan, 6.0, nan]"


def test_names_that_are_not_for_folders(tmp_path):
    log = Log().define("../X", "Q", "TimeUS", 9).add("../X", 1)
    log.define(".", "Q", "TimeUS", 10).add(".", 2)
    path = log.write(tmp_path / "x.BIN")
    out = tmp_path / "a" / "out"
    (row,) = convert([path], out)
    assert row.error is None
    assert sorted(row.files) == ["%2E%2E%2FX/x.parquet", "%2E/x.parquet", "FMT/x.parquet"]
    assert sorted(os.listdir(tmp_path / "a")) == ["out"]


@pytest.mark.parametrize("format", TABLE_FORMATS)
def test_convert(tmp_path, format):
    path = sample().write(tmp_path / "flight.BIN")
    (row,) = convert([path], tmp_path / "out", format=format, types=["IMU", "GPS"])
    assert row.error is None
    assert row.rows == 4 and len(row.files) == 2
    if format == "parquet":
        pq = pytest.importorskip("pyarrow.parquet")
        found = pq.read_table(tmp_path / "out" / "IMU" / "flight.parquet")
        assert found["Raw"].to_pylist() == [7, -7, 1]


def test_scan_of_several_kinds(tmp_path):
    from mavwire import traffic

    path = sample().write(tmp_path / "flight.BIN")
    telemetry = tmp_path / "flight.tlog"
    traffic.generate(telemetry, 500)
    names = {table.name for table in mavwire.scan([path, telemetry])}
    assert {"IMU", "ATTITUDE"} <= names
    assert [len(table) for table in mavwire.scan(path, "IMU", batch_rows=1)] == [1, 1, 1]
    with pytest.raises(ValueError, match="NOPE"):
        mavwire.read(telemetry, "NOPE")


def test_scan_polars(tmp_path):
    pl = pytest.importorskip("polars")
    path = sample().write(tmp_path / "flight.BIN")
    other = Log().define("IMU", "QBd", "TimeUS,I,AccX", 7).add("IMU", 5, 1, 2.5)
    other = other.write(tmp_path / "other.BIN")
    lazy = mavwire.scan_polars([path, other], "IMU")
    frame = lazy.filter(pl.col("I") == 1).select("AccX", "Raw").collect()
    assert frame.rows() == [(2.5, -7), (2.5, None)]
    with pytest.raises(ValueError, match="NOPE"):
        mavwire.scan_polars(path, "NOPE")


def test_a_log_that_is_replaced_by_one_of_its_size(tmp_path):
    path = tmp_path / "same.BIN"
    Log().define("TST", "Qi", "TimeUS,Count", 1).add("TST", 1, 7).write(path)
    log = mavwire.open_log(path)
    assert log["TST"]["Count"].tolist() == [7]
    before = path.stat()
    Log().define("TST", "Qf", "TimeUS,Volts", 1).add("TST", 1, 1.5).write(path)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns + 1_000_000_000))
    assert path.stat().st_size == before.st_size
    assert log.types["TST"] == ["timestamp", "TimeUS", "Volts"]
    assert log["TST"]["Volts"].tolist() == [1.5]


def test_whether_a_log_has_a_type_is_known_by_its_first_block(tmp_path, monkeypatch):
    """Nothing is cut into batches of one row to look at the first."""
    from mavwire import traffic
    from mavwire.logs import dataflash, reading

    path = sample().write(tmp_path / "flight.BIN")
    asked = []
    run = reading.columns_from

    def noted(tables, source, native, query):
        asked.append(query.batch_rows)
        return run(tables, source, native, query)

    monkeypatch.setattr(reading, "columns_from", noted)
    traffic.generate(tmp_path / "flight.tlog", 300)
    log = mavwire.open_log(tmp_path / "flight.tlog")
    assert "ATTITUDE" in log and "WIND_COV" not in log and "NOPE" not in log
    assert asked == [0, 0]

    class Noting(dataflash.Selection):
        def __init__(self, **how: Any) -> None:
            super().__init__(**how)
            asked.append(self.batch_rows)

    monkeypatch.setattr(dataflash, "Selection", Noting)
    onboard = mavwire.open_log(path)
    assert "IMU" in onboard and "NOPE" not in onboard
    assert asked == [0, 0, 0]


def text_of(path: str) -> str:
    """A log in its text form, by what DFReader says."""
    lines = []
    with DFReader_binary(path) as reader:
        for kind in reader.formats.values():
            values = (kind.type, kind.len, kind.name, kind.format, ",".join(kind.columns))
            lines.append(f"FMT, {', '.join(map(str, values))}")
        while (msg := reader.recv_msg()) is not None:
            if msg.get_type() != "FMT":
                values = [getattr(msg, name) for name in msg.get_fieldnames()]
                lines.append(", ".join([msg.get_type(), *map(str, values)]))
    return "\n".join(lines) + "\n"


def test_text_logs(tmp_path):
    path = tmp_path / "flight.log"
    path.write_text(text_of(sample().write(tmp_path / "flight.BIN")))
    assert compare(path, text=True) > 20
    imu = mavwire.open_log(path)["IMU"]
    assert imu["Raw"].tolist() == [7, -7, 1] and imu["Raw"].dtype == np.int16
    assert imu.metadata["AccX"]["unit"] == "m/s/s"
    assert mavwire.read(path, "MODE")["MODE"]["Mode"].tolist() == ["5", "4"]


def test_values_of_text_logs_that_are_none(tmp_path):
    path = tmp_path / "odd.log"
    lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
             "FMT, 9, 20, X, QBf, TimeUS,A,B", "X, 1, 2, 3.5", "X, 2, word, nan", "X, 3, 300, x",
             "X, 4, 5", "Y, 1", "X, 5, 6, 7.25"]  # fmt: skip
    path.write_text("\n".join([*lines, "x" * 100_000]))
    table = mavwire.read(path)["X"]
    assert table["TimeUS"].tolist() == [1, 2, 3, 5]
    assert str(table["A"].tolist()) == "[2.0, nan, nan, 6.0]"
    assert str(table["B"].tolist()) == "[3.5, nan, nan, 7.25]"
    info = mavwire.open_log(path).info()
    assert info.messages == 6
    assert info.bad_bytes == len("X, 4, 5\nY, 1\n") + 100_000


@pytest.mark.parametrize("damaged", ["nan", "inf", "-inf"])
def test_a_time_that_is_no_number_is_that_of_the_record_in_front(tmp_path, damaged):
    path = tmp_path / "odd.log"
    lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
             "FMT, 9, 20, X, fB, TimeUS,A", "X, 5, 1", f"X, {damaged}, 2", "X, 7, 3"]  # fmt: skip
    path.write_text("\n".join(lines) + "\n")
    table = mavwire.read(path)["X"]
    assert table["timestamp"].astype("int64").tolist() == [5, 5, 7]
    assert table["A"].tolist() == [1, 2, 3]


@pytest.mark.parametrize("kind", ["Q", "f"])
@pytest.mark.parametrize("damaged", ["3E49293", "nan", "inf", "-inf"])
@pytest.mark.parametrize("place", range(3))
def test_a_message_whose_time_is_no_number_is_read_as_its_row(tmp_path, kind, damaged, place):
    """DFReader gives the messages with a time that is in no stretch."""
    path, times = tmp_path / "odd.log", ["5", "6", "8"]
    times[place] = damaged
    lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
             f"FMT, 9, 20, X, {kind}B, TimeUS,A", "FMT, 10, 20, Y, BB, B,A"]  # fmt: skip
    lines += [line for time in times for line in (f"X, {time}, 1", "Y, 1, 2")]
    path.write_text("\n".join(lines) + "\n")
    log = mavwire.open_log(path)
    assert len(list(log)) == log.info().messages == 9
    stretches: list[dict[str, float]] = [{}, {"start": 0}, {"end": 1}, {"start": 5.5e-6}]
    for choice in [*stretches, {"start": 0, "end": 5.5e-6}]:
        rows = log.read(**choice)
        for name in ("X", "Y"):
            stamps = [msg._timestamp for msg in log.messages(**choice) if msg.get_type() == name]
            found = rows[name]["timestamp"].astype("int64") if name in rows else []
            np.testing.assert_array_equal(np.round(np.array(stamps) * 1e6), found)
        only = [msg._timestamp for msg in log.messages("X", **choice)]
        assert len(only) == len(log.read("X", **choice)["X"])


def test_compressed(tmp_path):
    log = sample()
    plain = log.write(tmp_path / "flight.BIN")
    packed = tmp_path / "flight.BIN.gz"
    packed.write_bytes(gzip.compress(log.data))
    found, expected = mavwire.read(packed), mavwire.read(plain)
    assert str([t.to_numpy() for t in found.values()]) == str(
        [t.to_numpy() for t in expected.values()]
    )
    with pytest.raises(ValueError, match="compressed"):
        next(iter(mavwire.open_log(packed)))


@pytest.mark.parametrize("seed", range(30))
def test_damage(tmp_path, seed):
    random = Random(seed)
    data = bytearray(sample().data + every_format().data + sample().data)
    for _ in range(random.randrange(1, 12)):
        at = random.randrange(len(data))
        match random.randrange(4):
            case 0:
                data[at] ^= 1 << random.randrange(8)
            case 1:
                del data[at : at + random.randrange(1, 40)]
            case 2:
                data[at:at] = random.randbytes(random.randrange(1, 40))
            case _:
                data[at:at] = fmt(random.randrange(1, 170), "X", "Qb", "TimeUS,A")
    path = tmp_path / "damaged.BIN"
    path.write_bytes(data)
    if DFReader_binary(str(path))._last_offset is None:
        return
    rows = {name: len(table) for name, table in mavwire.read(path).items()}
    with DFReader_binary(str(path)) as reader:
        expected: dict[str, int] = {}
        while (msg := reader.recv_msg()) is not None:
            expected[msg.get_type()] = expected.get(msg.get_type(), 0) + 1
    assert rows == expected


def test_cuts(tmp_path):
    data = sample().data
    path = tmp_path / "cut.BIN"
    for cut in range(3, len(data), 37):
        path.write_bytes(data[:cut])
        with DFReader_binary(str(path)) as reader:
            count = sum(1 for _ in iter(reader.recv_msg, None))
        assert sum(map(len, mavwire.read(path).values())) == count, cut
        path.write_bytes(data[cut:])
        if is_recognised(path):
            mavwire.read(path)


def is_recognised(path: Path) -> bool:
    """Whether a log is recognised without its first bytes."""
    try:
        DataflashLog(path)
    except LogFormatError:
        return False
    return True


@pytest.mark.parametrize("text", [False, True])
def test_many_descriptions_of_one_name_cost_no_more_than_those_of_one_type(tmp_path, text):
    """Whoever makes a log names its types: the columns of a table are bounded all the same."""
    path = tmp_path / ("many.log" if text else "many.BIN")
    # The first description, and more while a row of all of them has no more than 512 bytes.
    width, count, kept = (100, 200, 1) if text else (12, 500, 5)
    if text:
        lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns"]
        for n in range(count):
            names = ",".join(f"c{n:x}_{i:x}" for i in range(width))
            lines.append(f"FMT, {n % 120 + 1}, 250, ABCD, {'B' * width}, {names}")
            lines.append("ABCD, " + ", ".join(["7"] * width))
        path.write_text("\n".join(lines) + "\n")
    else:
        log = bytearray(FMT)
        for n in range(count):
            type_id = n % 120 + 1
            names = ",".join(f"{n * width + i:x}" for i in range(width))
            log += fmt(type_id, "ABCD", "B" * width, names)
            log += bytes([0xA3, 0x95, type_id]) + b"\7" * width
        path.write_bytes(log)
    log = mavwire.open_log(path)
    assert len(log.types["ABCD"]) == 1 + kept * width
    table = log["ABCD"]
    assert len(table) == kept
    assert table.columns == log.types["ABCD"]
    assert log.info().types["UNKNOWN"].messages >= 100, "the other records are counted"


def test_a_type_that_is_described_again_and_again_with_its_columns(tmp_path):
    log = bytearray(FMT)
    for n in range(20):
        log += fmt(7, "ABCD", "QBBBBBBBBBBB", "TimeUS,a,b,c,d,e,f,g,h,i,j,k", 22 + n)
        log += record(7, "QBBBBBBBBBBB", n, *range(11)) + bytes(n)
    path = tmp_path / "again.BIN"
    path.write_bytes(log)
    table = mavwire.read(path)["ABCD"]
    assert table["TimeUS"].tolist() == list(range(20))
    assert len(table.columns) == 13


def test_names_with_nul_are_columns_that_arrow_takes(tmp_path):
    path = tmp_path / "odd.log"
    path.write_text(
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
        "FMT, 1, 19, ABC, QII, TimeUS,a\0,b\0c\nABC, 1, 2, 3\n"
    )
    table = mavwire.open_log(path)["ABC"]
    assert table.columns == ["timestamp", "TimeUS", "a\ufffd", "b\ufffdc"]
    assert table.to_arrow().column_names == table.columns
    assert [table[name][0] for name in table.columns[2:]] == [2, 3]
